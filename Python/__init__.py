# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Occlusion-based depth perception for volumes, fibres, meshes and particles in VTK."""
import importlib as _importlib
import pkgutil as _pkgutil

# One extension module a layer; whichever layers were built are there.
for _module in sorted(m.name for m in _pkgutil.iter_modules(__path__) if m.name.startswith("vtkChi")):
    if _module == "vtkChiRendering":
        # the OpenGL classes register themselves where they are imported
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
        import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
    _layer = _importlib.import_module("." + _module, __name__)
    globals().update({name: getattr(_layer, name) for name in dir(_layer) if name.startswith("vtkChi")})
