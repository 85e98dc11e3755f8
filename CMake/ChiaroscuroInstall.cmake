# find_package(Chiaroscuro) for C users (target `chiaroscuro`) and C++ users (Chiaroscuro::Filters,
# Chiaroscuro::Rendering). The core's targets load without VTK.
include(CMakePackageConfigHelpers)
set(chiaroscuro_cmake_destination "${CMAKE_INSTALL_LIBDIR}/cmake/Chiaroscuro")
install(EXPORT Chiaroscuro FILE ChiaroscuroCore.cmake DESTINATION "${chiaroscuro_cmake_destination}")
# the same for the build tree, whose VTK modules name the core in their own export
export(EXPORT Chiaroscuro
  FILE "${CMAKE_BINARY_DIR}/${chiaroscuro_cmake_destination}/ChiaroscuroCore.cmake")
install(DIRECTORY Module/include/chiaroscuro DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
configure_package_config_file(CMake/ChiaroscuroConfig.cmake.in ChiaroscuroConfig.cmake
  INSTALL_DESTINATION "${chiaroscuro_cmake_destination}")
write_basic_package_version_file(ChiaroscuroConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/ChiaroscuroConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/ChiaroscuroConfigVersion.cmake"
  DESTINATION "${chiaroscuro_cmake_destination}")
