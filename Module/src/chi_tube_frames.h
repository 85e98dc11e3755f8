/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_FRAMES_H
#define CHI_TUBE_FRAMES_H

#include "chi_tube_internal.h"
#include "simd/chi_tube_kernels.h"

/* The rings of one line with their frames, a block at a time. */
typedef struct chi_tube_frames
{
  const chi_tube* tube;
  const chi_tube_kernels* kernels;
  chi_spline_curve curve;
  const chi_tube_ring* ring; /* [rings] */
  size_t rings;
  size_t first, count; /* rings first ... first + count - 1 are slots 1 ... count */
  size_t placed;       /* rings placed so far; one beyond the block where there is one */
  int direct;          /* a polyline with one ring at every point: nothing to evaluate */
  chi_tube_block block;
} chi_tube_frames;

void chi_tube_frames_start(
  chi_tube_frames* frames, const chi_tube_kernels* kernels, const chi_tube* tube, size_t line);

/* Rings of the next block, which become slots 1 ... that many; 0 at the end of the line. x,
 * tangent, normal, radius, stretch and widening hold there; radius and chord also for the
 * neighbours before and after, at the line's ends the ring's own radius and a chord of 0. */
size_t chi_tube_frames_next(chi_tube_frames* frames);

static inline void chi_tube_slot(double field[3][CHI_TUBE_SLOTS], size_t s, double out[3])
{
  for (int a = 0; a < 3; ++a)
  {
    out[a] = field[a][s];
  }
}

#endif
