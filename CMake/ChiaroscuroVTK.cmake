# The VTK modules, their Python wrapping, and the ParaView plugin that uses them.
if (CHIAROSCURO_BUILD_PARAVIEW)
  find_package(ParaView REQUIRED) # brings its VTK and sets VTK_DIR
endif ()
set(chiaroscuro_vtk_components
  CommonCore CommonDataModel CommonExecutionModel CommonTransforms FiltersCore FiltersGeneral
  FiltersSources ImagingCore ImagingHybrid IOImage InteractionStyle ParallelCore
  RenderingCore RenderingOpenGL2 RenderingVolume RenderingVolumeOpenGL2 TestingCore TestingRendering)
if (CHIAROSCURO_BUILD_PYTHON)
  list(APPEND chiaroscuro_vtk_components WrappingPythonCore Python)
endif ()
find_package(VTK 9.1 REQUIRED COMPONENTS ${chiaroscuro_vtk_components})
message(STATUS "Chiaroscuro: VTK ${VTK_VERSION} in ${VTK_DIR}")

# A bare install tree must find its own libraries whatever prefix it is moved to.
file(RELATIVE_PATH chiaroscuro_relative_lib "/${CMAKE_INSTALL_LIBDIR}/x" "/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_INSTALL_RPATH "$ORIGIN" "$ORIGIN/${chiaroscuro_relative_lib}")

set(chiaroscuro_module_files)
foreach (layer IN ITEMS Filters Rendering)
  list(APPEND chiaroscuro_module_files "${CMAKE_CURRENT_SOURCE_DIR}/${layer}/vtk.module")
endforeach ()
vtk_module_scan(
  MODULE_FILES ${chiaroscuro_module_files}
  WANT_BY_DEFAULT ON
  PROVIDES_MODULES chiaroscuro_modules)
vtk_module_build(
  MODULES ${chiaroscuro_modules}
  PACKAGE Chiaroscuro
  INSTALL_EXPORT ChiaroscuroVTK
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/Chiaroscuro"
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/chiaroscuro-vtk"
  VERSION "${PROJECT_VERSION}"
  SOVERSION "${PROJECT_VERSION_MAJOR}")

if (CHIAROSCURO_BUILD_PYTHON)
  # The interpreter that this VTK was wrapped for, not whichever comes first on PATH.
  if (NOT Python3_EXECUTABLE AND EXISTS "/usr/bin/python3" AND VTK_DIR MATCHES "^/usr/")
    set(Python3_EXECUTABLE "/usr/bin/python3")
  endif ()
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
  vtk_module_python_default_destination(chiaroscuro_python_destination)
  vtk_module_wrap_python(
    MODULES ${chiaroscuro_modules}
    PYTHON_PACKAGE "chiaroscuro"
    MODULE_DESTINATION "${chiaroscuro_python_destination}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/Chiaroscuro"
    BUILD_STATIC OFF
    INSTALL_HEADERS OFF
    INSTALL_EXPORT ChiaroscuroPython
    TARGET Chiaroscuro::Python)
  add_subdirectory(Python)
endif ()

if (CHIAROSCURO_BUILD_PARAVIEW)
  paraview_plugin_scan(
    PLUGIN_FILES "${CMAKE_CURRENT_SOURCE_DIR}/ParaViewPlugin/paraview.plugin"
    PROVIDES_PLUGINS chiaroscuro_plugins
    REQUIRES_MODULES chiaroscuro_plugin_modules
    ENABLE_BY_DEFAULT ON)
  paraview_plugin_build(
    PLUGINS ${chiaroscuro_plugins}
    PLUGINS_FILE_NAME "chiaroscuro.xml"
    RUNTIME_DESTINATION "${CMAKE_INSTALL_BINDIR}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY_SUBDIRECTORY "paraview-5.11/plugins")
endif ()
