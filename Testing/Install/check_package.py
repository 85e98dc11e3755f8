# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Import the package as its users do, tube a line, and see that all of it lies below the prefix named."""
import math
import os
import sys

import chiaroscuro
from chiaroscuro import vtkChiCombinedOcclusionVolumeMapper, vtkChiStreamTubes
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

prefix = os.path.realpath(sys.argv[1]) + os.sep
files = {module.__file__ for name, module in sys.modules.items()
         if name.split(".")[0] == chiaroscuro.__name__}
assert len(files) >= 3, files  # the package and an extension a layer
with open("/proc/self/maps") as maps:
    libraries = {line.split()[-1] for line in maps if "chiaroscuro" in line.lower() or "vtkChi" in line}
assert any("libchiaroscuro" in f for f in libraries), libraries
for file in sorted(files | libraries):
    assert os.path.realpath(file).startswith(prefix), file + " lies outside of " + prefix

points, cells, line = vtkPoints(), vtkCellArray(), vtkPolyData()
for z in (3, 5):
    points.InsertNextPoint(1, 2, z)
cells.InsertNextCell(2, [0, 1])
line.SetPoints(points)
line.SetLines(cells)
tubes = vtkChiStreamTubes()
tubes.SetInputData(line)
tubes.RadiusIsRelativeOff()
tubes.SetRadius(0.25)
tubes.Update()
surface = tubes.GetOutput()
radii = [math.hypot(x - 1, y - 2) for x, y, z in
         (surface.GetPoint(i) for i in range(surface.GetNumberOfPoints()))]
# points are floats near 5: 2^-22 each way
assert radii and max(abs(r - 0.25) for r in radii) < 1e-6, (len(radii), radii[:8])
assert vtkChiCombinedOcclusionVolumeMapper().GetConeAngle() > 0
print("installed package: ok")
