# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run time against error of histograms: vtkChiContinuousHistogram beside those of VTK that count samples.

The volume's distribution of Marschner & Lobb's signal in 256 bins, from grids of n^3 cells. Error: the sum of |bin -
exact| over all mass, exact from a grid of twice the largest n (its own error is below a quarter of that of the next). A
sample at a point counts as one cell's volume, at the grid's faces too, as these classes count. The PNG that `make bench`
draws shows what each costs for an error. vtkImageHistogram is left out where the VTK at hand has none.
"""
import math
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkFiltersStatistics import vtkExtractHistogram

from chiaroscuro import vtkChiContinuousHistogram

try:
    from vtkmodules.vtkImagingStatistics import vtkImageHistogram
except ImportError:
    vtkImageHistogram = None

RUNS = 5
BINS = 256
RANGE = (0.0, 1.0)


def signal(n):
    x = np.linspace(-1, 1, n + 1)
    r = np.hypot(x[:, None], x[None, :])
    rho = np.cos(12 * math.pi * np.cos(math.pi * r / 2))
    values = (1 - np.sin(math.pi * x / 2)[:, None, None] + 0.25 * (1 + rho)[None]) / 2.5
    image = vtkImageData()
    image.SetDimensions(n + 1, n + 1, n + 1)
    image.SetOrigin(-1, -1, -1)
    image.SetSpacing(2 / n, 2 / n, 2 / n)
    array = numpy_to_vtk(values.ravel(), deep=True)
    array.SetName("signal")
    image.GetPointData().SetScalars(array)
    return image


def ours(image):
    histogram = vtkChiContinuousHistogram()
    histogram.SetInputData(image)
    histogram.SetNumberOfBins(BINS)
    histogram.AutomaticRangeOff()
    histogram.SetRange(*RANGE)
    return histogram, lambda: vtk_to_numpy(histogram.GetOutput().GetColumnByName("Mass"))


def extract(image):
    histogram = vtkExtractHistogram()
    histogram.SetInputData(image)
    histogram.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "signal")
    histogram.SetBinCount(BINS)
    histogram.UseCustomBinRangesOn()
    histogram.SetCustomBinRanges(*RANGE)
    return histogram, lambda: vtk_to_numpy(histogram.GetOutput().GetRowData().GetArray("bin_values"))


def counted(image):
    histogram = vtkImageHistogram()
    histogram.SetInputData(image)
    histogram.AutomaticBinningOff()
    histogram.SetNumberOfBins(BINS)
    histogram.SetBinOrigin((RANGE[1] - RANGE[0]) / BINS / 2)  # of the first bin's middle
    histogram.SetBinSpacing((RANGE[1] - RANGE[0]) / BINS)
    return histogram, lambda: vtk_to_numpy(histogram.GetHistogram())


def main(largest):
    fine, read = ours(signal(2 * largest))
    fine.Update()
    exact = read() / read().sum()
    methods = [("vtkChiContinuousHistogram", ours, 2), ("vtkExtractHistogram", extract, 1)]
    if vtkImageHistogram:
        methods.append(("vtkImageHistogram", counted, 2))
    n = 16
    while n <= largest:
        image = signal(n)
        for name, make, threads in methods:
            best = math.inf
            for _ in range(RUNS):
                histogram, read = make(image)  # a new one, that has kept nothing
                start = time.perf_counter_ns()
                histogram.Update()
                best = min(best, time.perf_counter_ns() - start)
            error = np.abs(read() / read().sum() - exact).sum()
            print(f"histogram,Marschner-Lobb,{name},{n},{6 * n**3},{threads},{best},{error:.3g},volume", flush=True)
        n *= 2


print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
main(int(sys.argv[1]) if len(sys.argv) > 1 else 128)
