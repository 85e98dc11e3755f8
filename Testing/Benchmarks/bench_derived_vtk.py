# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiDerivedFields beside vtkImageGradientMagnitude and vtkGradientFilter on the signal of bench_derived.c in
float, in turn, run time against error: of the gradient's magnitude over its range, mean and largest inside (two
samples from the boundary). A copy by numpy of the same image says what memory gives in the same run."""
import math
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter, vtkGradientFilter
from vtkmodules.vtkImagingGeneral import vtkImageGradientMagnitude

from chiaroscuro import vtkChiDerivedFields

RUNS = 5
SIDE = 1.6


def signal(n):
    """Marschner & Lobb 1994 with f_M = 1, alpha = 1/4: values, and magnitudes of the gradient."""
    x = np.linspace(-SIDE / 2, SIDE / 2, n)
    r = np.hypot(x[None, :], x[:, None])
    c, q, a = 2 * math.pi, math.pi / 2, 0.25
    scale = 1 / (2 * (1 + a))
    rho = np.cos(c * np.cos(q * r))
    slope = scale * a * np.sin(c * np.cos(q * r)) * c * q * np.sin(q * r)
    values = scale * (1 - np.sin(q * x)[:, None, None] + a * (1 + rho)[None])
    exact = np.sqrt(slope[None]**2 + (scale * q * np.cos(q * x))[:, None, None]**2)
    return values.astype(np.float32), exact


def image_of(values):
    n = values.shape[0]
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.SetOrigin(-SIDE / 2, -SIDE / 2, -SIDE / 2)
    image.SetSpacing(SIDE / (n - 1), SIDE / (n - 1), SIDE / (n - 1))
    array = numpy_to_vtk(values.ravel(), deep=True)
    array.SetName("f")
    image.GetPointData().SetScalars(array)
    return image


def ours(data, order):
    derived = vtkChiDerivedFields()
    derived.SetInputData(data)
    derived.SetOrder(order)

    def run():
        derived.SetOrder(6 - derived.GetOrder())  # nothing is kept
        derived.SetOrder(order)
        data.GetPointData().GetScalars().Modified()
        data.Modified()
        derived.Update()
        return vtk_to_numpy(derived.GetOutput().GetPointData().GetArray("f_GradientMagnitude"))
    return run


def gradient_filter(data):
    peer = vtkGradientFilter()
    peer.SetInputData(data)
    peer.SetInputScalars(vtkDataObject.FIELD_ASSOCIATION_POINTS, "f")
    peer.SetResultArrayName("g")

    def run():
        peer.Modified()
        peer.Update()
        return vtk_to_numpy(peer.GetOutput().GetPointData().GetArray("g"))
    return run


def gradient_magnitude(data):
    peer = vtkImageGradientMagnitude()
    peer.SetInputData(data)
    peer.SetDimensionality(3)

    def run():
        peer.Modified()
        peer.Update()
        return vtk_to_numpy(peer.GetOutput().GetPointData().GetScalars())
    return run


def copy(values):
    to = np.empty_like(values)

    def run():
        np.copyto(to, values)
        return None
    return run


def measure(case, methods, exact):
    n = exact.shape[0]
    best = {name: math.inf for name in methods}
    found = {}
    for _ in range(RUNS):  # in turn, so that a busy machine is busy for all
        for name, run in methods.items():
            start = time.perf_counter_ns()
            found[name] = run()
            best[name] = min(best[name], time.perf_counter_ns() - start)
    inside = (slice(2, -2), ) * 3
    for name, result in found.items():
        method, _, parameter = name.partition("; ")
        row = f"derived,{case},{method},{parameter},{n**3},{vtkSMPTools.GetEstimatedNumberOfThreads()},{best[name]}"
        if result is None:
            print(f"{row},,", flush=True)
            continue
        if result.ndim == 2:
            result = np.linalg.norm(result, axis=1)
        error = np.abs(result.reshape(exact.shape) - exact) / np.ptp(exact)
        print(f"{row},{error.mean():.3g},mean of |grad f| over its range", flush=True)
        print(f"{row},{error[inside].max():.3g},largest inside", flush=True)


def main():
    vtkSMPTools.SetBackend("STDThread")  # stock VTK starts with one thread
    for n in (64, 128, 256):
        values, exact = signal(n)
        image = image_of(values)
        methods = {
            "vtkChiDerivedFields; order 2": ours(image, 2),
            "vtkChiDerivedFields; order 4": ours(image, 4),
            "vtkImageGradientMagnitude; order 2": gradient_magnitude(image),
            "copy; numpy": copy(values),
        }
        if n <= 128:  # a minute each beyond
            methods["vtkGradientFilter; order 2"] = gradient_filter(image)
        measure("image (VTK)", methods, exact)
    for n in (16, 32):
        values, exact = signal(n)
        split = vtkDataSetTriangleFilter()
        split.SetInputData(image_of(values))
        split.Update()
        mesh = split.GetOutput()
        measure("tetrahedra (VTK)", {
            "vtkChiDerivedFields; fit": ours(mesh, 2),
            "vtkGradientFilter; mean of cells": gradient_filter(mesh),
        }, exact)


print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
main()
