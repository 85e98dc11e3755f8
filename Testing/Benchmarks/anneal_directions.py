# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Is there a better set of directions than the golden spiral of Module/src/chi_directions.c?

A half-plane hides the directions on one side of a line, so what a set makes of its penumbra, for
an edge of any orientation, is the distribution of the directions' projections on the line across.
Simulated annealing moves points of the unit disc (area = solid angle of the cone) so that the
projections of their slopes lie at the quantiles of the exact distribution: the mean square over
orientations, and over cones of 20, 45 and 70 degrees, of the difference of both distributions (a
star discrepancy in the L2 norm).

    python3 anneal_directions.py [count ...]

prints, for both, the discrepancy and the largest steps between neighbouring pixels of a penumbra, of
255, 26, 77 and 256 slices behind its edge. Even projections come at the price of directions that lie
in line for some orientation: with 16 directions the discrepancy falls by 12 %, and the steps grow
from 21, 11 and 5 to 26, 17 and 9. So the spiral stayed (Documentation/theory/occlusion.md, "Steps").
"""

import sys
from math import lgamma

import numpy as np

GOLDEN = np.pi * (3 - np.sqrt(5))
CONES = np.radians([20.0, 45.0, 70.0])
SHARES = np.array([0.25, 0.5, 0.25])
ANGLES = np.pi * (np.arange(36) + 0.5) / 36
LINES = np.stack([np.cos(ANGLES), np.sin(ANGLES)])


def slopes(disc, cone):
    """Points of the unit disc to slopes of directions of equal solid angle."""
    square = np.minimum((disc**2).sum(1), 1 - 1e-9)
    mu = 1 - (1 - np.cos(cone)) * square
    return disc * (np.sqrt(1 - mu * mu) / mu / np.sqrt(np.maximum(square, 1e-12)))[:, None]


def exact(cone, count=400000):
    """Quantiles of a projection of the cone's directions: positions and their probabilities."""
    k = np.arange(count) + 0.5
    r, phi = np.sqrt(k / count), k * GOLDEN
    x = np.sort(slopes(np.stack([r * np.cos(phi), r * np.sin(phi)], 1), cone)[:, 0])
    return x[::400], k[::400] / count


EXACT = [exact(cone) for cone in CONES]


def discrepancy(disc):
    """Mean over orientations and cones of the squared L2 discrepancy of the projections."""
    count = len(disc)
    even = (np.arange(count) + 0.5) / count
    total = 0.0
    for cone, share, (x, p) in zip(CONES, SHARES, EXACT):
        y = np.interp(slopes(disc, cone) @ LINES, x, p)
        y.sort(axis=0)
        total += share * ((y - even[:, None]) ** 2).mean()
    return total + 1 / (12.0 * count**2)


def spiral(count, start=4.8):
    """The golden spiral, where annealing begins and what it is compared with."""
    k = np.arange(count)
    r, phi = np.sqrt((k + 0.5) / count), k * GOLDEN + start
    return np.stack([r * np.cos(phi), r * np.sin(phi)], 1)


def anneal(count, steps, seed):
    """One run of annealing; the best set that it met."""
    random = np.random.default_rng(seed)
    disc = spiral(count)
    now = discrepancy(disc)
    best, least = disc.copy(), now
    for step in range(steps):
        cool = 1 - step / steps
        k = random.integers(count)
        old = disc[k].copy()
        disc[k] += random.normal(size=2) * (0.002 + 0.6 * cool**2 / np.sqrt(count))
        if (disc[k] ** 2).sum() >= 1:
            disc[k] = old
            continue
        then = discrepancy(disc)
        if then < now or random.random() < np.exp((now - then) / (2e-2 * least * cool**2 + 1e-12)):
            now = then
            if now < least:
                best, least = disc.copy(), now
        else:
            disc[k] = old
    return best, least


def draws(count, share):
    """Probabilities of 0 ... count successes."""
    if share < 1e-12:
        return np.eye(1, count + 1)[0]
    k = np.arange(count + 1)
    ways = np.array([lgamma(count + 1) - lgamma(i + 1) - lgamma(count - i + 1) for i in k])
    return np.exp(ways + k * np.log(share) + (count - k) * np.log1p(-share))


def largest_step(disc, slices, bins=32):
    """Of 255, worst of 24 orientations; see Testing/Module/test_occlusion_penumbra.c."""
    reach, worst = int(1.5 * slices) + 8, 0.0
    for angle in np.pi * np.arange(24) / 24:
        across = np.cos(angle), np.sin(angle)
        arrives = np.zeros(2 * reach * bins)
        for x, y in slopes(disc, np.pi / 4):
            i, j = np.floor(x), np.floor(y)
            p, q = draws(slices, x - i), draws(slices, y - j)
            place = (slices * i + np.arange(slices + 1))[:, None] * across[0]
            place = place + (slices * j + np.arange(slices + 1))[None, :] * across[1]
            bin_of = np.clip(np.round((place + reach) * bins), 0, len(arrives) - 1).astype(int)
            arrives += np.bincount(bin_of.ravel(), np.outer(p, q).ravel(), len(arrives))
        profile = np.cumsum(arrives) / len(disc)
        apart = round(max(abs(across[0]), abs(across[1])) * bins)
        worst = max(worst, (profile[apart:] - profile[:-apart]).max())
    return 255 * worst


def main():
    for count in [int(a) for a in sys.argv[1:]] or [4, 8, 16]:
        runs = [anneal(count, 4000 + 400 * count, seed) for seed in range(6)]
        best = min(runs, key=lambda run: run[1])[0]
        for name, disc in (("spiral", spiral(count)), ("annealed", best)):
            steps = " ".join(f"{largest_step(disc, n):.1f}" for n in (26, 77, 256))
            print(f"{count} {name}: {np.sqrt(discrepancy(disc)):.4f}, steps {steps}", flush=True)


if __name__ == "__main__":
    main()
