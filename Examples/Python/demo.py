# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pictures and the table of `make demo`: demo.py DATA FOLDER"""
import sys
import time

from PIL import Image

from brain_with_fibres import scene
from save_picture import save

CAPTION = """Half of a brain (MRI, ch2better) with the left arcuate fasciculus (orange), the forceps major (blue)
and the fornix (purple) of two other people, placed in it by a rigid motion in MNI space: where a fibre
ends against this brain's folds is not anatomy."""


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
    pictures = [Image.open(f"{folder}/{name}.png") for name in ("without_occlusion", "with_occlusion")]
    both = Image.new("RGB", (sum(p.width for p in pictures), pictures[0].height))
    both.paste(pictures[0], (0, 0))
    both.paste(pictures[1], (pictures[0].width, 0))
    both.save(f"{folder}/side_by_side.png")
    print(f"{'stage':28s}{'time/ms':>10s}{'samples taken':>16s}{'samples skipped':>17s}")
    for stage, seconds, taken, skipped in rows:
        print(f"{stage:28s}{1e3 * seconds:10.1f}{taken!s:>16s}{skipped!s:>17s}")
    print(CAPTION)
    print(f"pictures: {folder}/without_occlusion.png, with_occlusion.png, side_by_side.png")


if __name__ == "__main__":
    main()
