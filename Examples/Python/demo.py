# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pictures and the table of `make demo`: demo.py DATA FOLDER"""
import sys
import time

import numpy as np
from PIL import Image

import brain_scatterplot
import brain_tetrahedra
from brain_with_fibres import scene
from save_picture import save

CAPTION = """Half of a brain (MRI, ch2better) with the left arcuate fasciculus (orange), the forceps major (blue)
and the fornix (purple) of two other people, placed in it by a rigid motion in MNI space: where a fibre
ends against this brain's folds is not anatomy."""


TETRAHEDRA = """The same brain without its skull (ch2bet, smoothed by 1.5 voxels) as {:,} tetrahedra between 30 008 points that lie
where it has detail (left), and the image itself (right), under one transfer function. Left to right the
pictures differ by {:.1f} of 255 on average, which is what so few points leave out: the order of the
tetrahedra has {} violations over all pixels."""


SCATTERPLOT = """T1 intensity of a brain (ch2better, smoothed by 0.75 mm) against the magnitude of its gradient (left): the volume of
{:,} tetrahedra, each spread over the bins exactly. What is brushed there (orange) is, in the brain (right), the walls
of the lateral ventricles: the fiber surface of that polygon, {:,} triangles, beside the half of the brain behind it."""


def join(left, right, path):
    pictures = [Image.open(left), Image.open(right)]
    both = Image.new("RGB", (sum(p.width for p in pictures), pictures[0].height))
    both.paste(pictures[0], (0, 0))
    both.paste(pictures[1], (pictures[0].width, 0))
    both.save(path)


def draw_tetrahedra(data, folder):
    """Rows of the table, and the caption."""
    start = time.perf_counter()
    renderers, mapper = brain_tetrahedra.scene(data, f"{folder}/brain_tetrahedra.vtu")
    rows = [("mesh (kept)", time.perf_counter() - start, "", "")]
    violations = 0
    for renderer, name in zip(renderers, ("tetrahedra", "image")):
        start = time.perf_counter()
        window = save(renderer, f"{folder}/{name}.png")
        rows.append((f"{name}, 2048^2", time.perf_counter() - start, "", ""))
        if name == "tetrahedra":
            for stage in ("Split", "Order", "Tiles", "Draw", "Composite"):
                rows.append(("  " + stage, getattr(mapper, "GetSeconds" + stage)(), "", ""))
            violations = mapper.GetNumberOfOrderViolations()
        window.RemoveRenderer(renderer)
        window.Finalize()
    mapper.SetOcclusionStrength(1.0)
    start = time.perf_counter()
    window = save(renderers[0], f"{folder}/tetrahedra_with_occlusion.png")
    rows.append(("tetrahedra with occlusion", time.perf_counter() - start, "", ""))
    window.RemoveRenderer(renderers[0])
    window.Finalize()
    mapper.SetOcclusionStrength(0.0)
    pictures = [np.asarray(Image.open(f"{folder}/{name}.png"), float) for name in ("tetrahedra", "image")]
    join(f"{folder}/tetrahedra.png", f"{folder}/image.png", f"{folder}/brain_tetrahedra.png")
    difference = np.abs(pictures[0] - pictures[1]).mean()
    return rows, TETRAHEDRA.format(mapper.GetNumberOfTetrahedra(), difference, violations)


def draw_scatterplot(data, folder):
    """The same of the scatterplot and the fiber surface."""
    head = brain_scatterplot.read(data)
    start = time.perf_counter()
    view, scatterplot = brain_scatterplot.plot(head)
    rows = [("scatterplot", time.perf_counter() - start, "", "")]
    brain_scatterplot.save_view(view, f"{folder}/scatterplot.png")
    start = time.perf_counter()
    renderer, fibers = brain_scatterplot.scene(head)
    fibers.Update()
    rows.append(("fiber surface", time.perf_counter() - start, "", ""))
    save(renderer, f"{folder}/ventricles.png")
    join(f"{folder}/scatterplot.png", f"{folder}/ventricles.png", f"{folder}/brain_scatterplot.png")
    return rows, SCATTERPLOT.format(scatterplot.GetNumberOfSimplices(), fibers.GetOutput().GetNumberOfPolys())


def main():
    data, folder = sys.argv[1:3]
    start = time.perf_counter()
    renderer, brain = scene(data)
    rows = [("read and tube", time.perf_counter() - start, "", "")]
    for name, strength in (("without_occlusion", 0.0), ("with_occlusion", 1.0)):
        brain.SetOcclusionStrength(strength)
        start = time.perf_counter()
        window = save(renderer, f"{folder}/{name}.png")
        rows.append((name.replace("_", " "), time.perf_counter() - start,
                     brain.GetNumberOfSamples(), brain.GetNumberOfSkippedSamples()))
        for stage in ("Geometry", "ReadBack", "Bricks", "Classification", "VisibleSet", "Slices", "Composite"):
            rows.append(("  " + stage, getattr(brain, "GetSeconds" + stage)(), "", ""))
        window.RemoveRenderer(renderer)
        window.Finalize()
    join(f"{folder}/without_occlusion.png", f"{folder}/with_occlusion.png", f"{folder}/side_by_side.png")
    more, caption = draw_tetrahedra(data, folder)
    rows += more
    more, plotted = draw_scatterplot(data, folder)
    rows += more
    print(f"{'stage':28s}{'time/ms':>10s}{'samples taken':>16s}{'samples skipped':>17s}")
    for stage, seconds, taken, skipped in rows:
        print(f"{stage:28s}{1e3 * seconds:10.1f}{taken!s:>16s}{skipped!s:>17s}")
    print(CAPTION)
    print(caption)
    print(plotted)
    print(f"pictures: {folder}/without_occlusion.png, with_occlusion.png, side_by_side.png, brain_tetrahedra.png, "
          "tetrahedra_with_occlusion.png, brain_scatterplot.png")


if __name__ == "__main__":
    main()
