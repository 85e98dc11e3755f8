/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_KERNELS_H
#define CHI_TUBE_KERNELS_H

/* The inner loops of the sweep, once per instruction set; chosen at load. Nothing here fuses
 * multiplications with additions, so that all of them give the same bits. */

#include <stddef.h>

enum
{
  CHI_TUBE_BLOCK = 32,                 /* rings at a time: all of them stay in the first cache */
  CHI_TUBE_SLOTS = CHI_TUBE_BLOCK + 8, /* and their neighbours, to whole vectors */
  CHI_TUBE_PATTERN = 24                /* floats: the least whole number of xyz and of vectors */
};

/* Rings of one line with their frames, coordinate by coordinate. Slot 0 is the ring before those of
 * the block. Normal, binormal and tangent are orthonormal, right-handed. */
typedef struct chi_tube_block
{
  double x[3][CHI_TUBE_SLOTS];
  double before[3][CHI_TUBE_SLOTS], after[3][CHI_TUBE_SLOTS]; /* unit directions there */
  double tangent[3][CHI_TUBE_SLOTS];
  double stretch[3][CHI_TUBE_SLOTS]; /* along it a mitre widens the ring; any length */
  double widening[CHI_TUBE_SLOTS];   /* (1 / cos(half the turn) - 1) / |stretch|^2 */
  double radius[CHI_TUBE_SLOTS];
  double chord[CHI_TUBE_SLOTS];      /* distance from the ring before */
  double turn[9][CHI_TUBE_SLOTS];    /* rotation from the frame of the ring before, row by row */
  double normal[3][CHI_TUBE_SLOTS], binormal[3][CHI_TUBE_SLOTS];
} chi_tube_block;

/* What a ring's vertices are made of: center, cosine and sine axis, and the same for normals. Each
 * three numbers. */
typedef struct chi_tube_ellipse
{
  float center[3], cosine[3], sine[3], normal_center[3], normal_cosine[3], normal_sine[3];
} chi_tube_ellipse;

typedef struct chi_tube_kernels
{
  /* Directions and mitres of slots first ... last from x there, one beyond, and `after` one before.
   */
  void (*place)(chi_tube_block* block, size_t first, size_t last);
  /* `turn` and `chord` of slots first ... last from x and tangent there and one before. */
  void (*turns)(chi_tube_block* block, size_t first, size_t last);
  /* Points (or NULL) and normals (or NULL) of one ring; `circle` is [3 x sides] cosines, each three
   * times, then as many sines. */
  void (*ring)(const chi_tube_ellipse* ellipse, const float* circle, size_t sides, float* points,
    float* normals);
} chi_tube_kernels;

extern const chi_tube_kernels chi_tube_kernels_generic;
#if defined(__x86_64__)
extern const chi_tube_kernels chi_tube_kernels_avx2;
extern const chi_tube_kernels chi_tube_kernels_avx512;
#endif

/* Those of this machine. */
const chi_tube_kernels* chi_tube_get_kernels(void);

#endif
