/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef TET_TINY_H
#define TET_TINY_H

/* Meshes of cells below a pixel, and what they weigh. All lie in the cube [-1, 1]^3. */
#include "tet_scenes.h"

/** Tetrahedra that do not touch each other, mostly; edges of low to high, log-uniform. Scalars are
 * random, 0 ... 1. */
tet_mesh* tet_tiny_dust(size_t count, double low, double high, uint32_t seed);
/** The cubes of tet_mesh_cubes with random scalars. */
tet_mesh* tet_tiny_noise(size_t n, uint32_t seed);
/** The same, of cubes whose edges grow along each axis, so often over all. */
tet_mesh* tet_tiny_graded(size_t n, double ratio, uint32_t seed);

/** The integral over the window of the optical depth along rays, of an extinction of the scalar
 * times so much: over the cells, of extinction, in perspective times the ray's length a depth over
 * the depth's square. All has to lie within the window. */
double tet_tiny_depth(const tet_mesh* mesh, const chi_camera* camera, double extinction);

#endif
