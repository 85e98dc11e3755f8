# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the brain scenes of the core's benches: scenes.py DATA OUT        needs numpy, scipy, nibabel

OUT/brain128.raw      128^3 float extinctions a voxel, x fastest: the head seen along y, through a soft ramp of
                      opacity; z (slowest) grows away from the eye
OUT/brain_cut128.raw  the same with a quarter cut away, so that fibres can be seen
OUT/fibres128.raw     float x y z of the fibres' points in voxels of that grid; three NaN after each fibre
"""

import sys
import tempfile
import zipfile
from pathlib import Path

import nibabel
import numpy as np
from scipy.ndimage import zoom

SIZE = 128


def brain(image):
    values = np.asanyarray(image.dataobj).astype(np.float32)
    values = values[::-1].transpose(1, 2, 0)
    values = zoom(values, [SIZE / count for count in values.shape], order=1)
    return (0.6 * np.clip((values - 60) / 70, 0, 1) ** 2).astype("<f4")


def to_grid(image, millimetres):
    """Points of the image's space as x y z of brain()'s grid: its zoom maps first to first, last to last voxel."""
    inverse = np.linalg.inv(image.affine)
    i, j, k = (millimetres @ inverse[:3, :3].T + inverse[:3, 3]).T
    n = np.array(image.shape) - 1.0
    return np.stack([(n[0] - i) / n[0], k / n[2], j / n[1]], 1) * (SIZE - 1)


def fibres(image, data):
    """Fibres of three other people, by rigid motions in the image's space."""
    nibabel.imageglobals.logger.setLevel(40)  # one file's header names no voxel order
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(data / "minimal_bundles.zip").extractall(folder)
        parts = (
            (f"{folder}/sub_5/AF_L.trk", (0, 0, 0)),
            (f"{folder}/sub_5/CC_ForcepsMajor.trk", (0, 0, 0)),
            (data / "tracks300.trk", (-90, -114, -67)),
        )
        lines = [to_grid(image, np.asarray(line, float) + move)
                 for path, move in parts for line in nibabel.streamlines.load(path).streamlines]
    end = np.full((1, 3), np.nan)
    return np.concatenate([part for line in lines for part in (line, end)]).astype("<f4")


def main(data, out):
    out.mkdir(parents=True, exist_ok=True)
    image = nibabel.load(data / "ch2bet.nii.gz")
    values = brain(image)
    values.tofile(out / "brain128.raw")
    values[:72, :, 60:] = 0
    values.tofile(out / "brain_cut128.raw")
    fibres(image, data).tofile(out / "fibres128.raw")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
