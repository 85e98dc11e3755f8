# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the brain scene of bench_occlusion: 128^3 float extinctions a voxel, x fastest.

    python3 scenes.py ch2bet.nii.gz build/bench/brain128.raw        needs numpy, scipy, nibabel

The head is seen along y, through a soft ramp of opacity; z (slowest) grows away from the eye.
"""

import sys
from pathlib import Path

import nibabel
import numpy as np
from scipy.ndimage import zoom

SIZE = 128


def brain(head):
    values = np.asanyarray(nibabel.load(head).dataobj).astype(np.float32)
    values = values[::-1].transpose(1, 2, 0)
    values = zoom(values, [SIZE / count for count in values.shape], order=1)
    return (0.6 * np.clip((values - 60) / 70, 0, 1) ** 2).astype("<f4")


if __name__ == "__main__":
    target = Path(sys.argv[2])
    target.parent.mkdir(parents=True, exist_ok=True)
    brain(sys.argv[1]).tofile(target)
