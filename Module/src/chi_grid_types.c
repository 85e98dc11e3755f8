/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Types of cells as linear polyhedra of their nodes. A quadratic cell's faces are cut alike in all
 * types: a six-node triangle into its middle and its corners, an eight-node quadrilateral into the
 * square of its middles and its corners, a nine-node one into four. So a cell of corners and
 * middles of edges is a tetrahedron (a pyramid) at each corner and, between, its rectification: the
 * polyhedron of the middles.
 */

#include "chi_grid_internal.h"

enum
{
  TETRAHEDRON,
  HEXAHEDRON,
  WEDGE,
  PYRAMID,
  PENTAGONAL_PRISM,
  HEXAGONAL_PRISM,
  MIDDLE_TETRAHEDRON, /* an octahedron; corners: the middles of edges in VTK's order of these */
  MIDDLE_HEXAHEDRON,  /* a cuboctahedron */
  MIDDLE_WEDGE,
  MIDDLE_PYRAMID
};

const chi_shape chi_shapes[] = {
  [TETRAHEDRON] = { 4, 4, { { 3, 0, 2, 1 }, { 3, 0, 1, 3 }, { 3, 1, 2, 3 }, { 3, 2, 0, 3 } } },
  [HEXAHEDRON] = { 8, 6,
    { { 4, 0, 4, 7, 3 }, { 4, 1, 2, 6, 5 }, { 4, 0, 1, 5, 4 }, { 4, 3, 7, 6, 2 }, { 4, 0, 3, 2, 1 },
      { 4, 4, 5, 6, 7 } } },
  [WEDGE] = { 6, 5,
    { { 3, 0, 2, 1 }, { 3, 3, 4, 5 }, { 4, 0, 1, 4, 3 }, { 4, 1, 2, 5, 4 }, { 4, 2, 0, 3, 5 } } },
  [PYRAMID] = { 5, 5,
    { { 4, 0, 3, 2, 1 }, { 3, 0, 1, 4 }, { 3, 1, 2, 4 }, { 3, 2, 3, 4 }, { 3, 3, 0, 4 } } },
  [PENTAGONAL_PRISM] = { 10, 7,
    { { 5, 0, 4, 3, 2, 1 }, { 5, 5, 6, 7, 8, 9 }, { 4, 0, 1, 6, 5 }, { 4, 1, 2, 7, 6 },
      { 4, 2, 3, 8, 7 }, { 4, 3, 4, 9, 8 }, { 4, 4, 0, 5, 9 } } },
  [HEXAGONAL_PRISM] = { 12, 8,
    { { 6, 0, 5, 4, 3, 2, 1 }, { 6, 6, 7, 8, 9, 10, 11 }, { 4, 0, 1, 7, 6 }, { 4, 1, 2, 8, 7 },
      { 4, 2, 3, 9, 8 }, { 4, 3, 4, 10, 9 }, { 4, 4, 5, 11, 10 }, { 4, 5, 0, 6, 11 } } },
  [MIDDLE_TETRAHEDRON] = { 6, 8,
    { { 3, 2, 1, 0 }, { 3, 0, 4, 3 }, { 3, 1, 5, 4 }, { 3, 2, 3, 5 }, { 3, 0, 3, 2 },
      { 3, 0, 1, 4 }, { 3, 1, 2, 5 }, { 3, 3, 4, 5 } } },
  [MIDDLE_HEXAHEDRON] = { 12, 14,
    { { 4, 8, 7, 11, 3 }, { 4, 1, 10, 5, 9 }, { 4, 0, 9, 4, 8 }, { 4, 11, 6, 10, 2 },
      { 4, 3, 2, 1, 0 }, { 4, 4, 5, 6, 7 }, { 3, 0, 8, 3 }, { 3, 0, 1, 9 }, { 3, 1, 2, 10 },
      { 3, 2, 3, 11 }, { 3, 4, 7, 8 }, { 3, 4, 9, 5 }, { 3, 5, 10, 6 }, { 3, 6, 11, 7 } } },
  [MIDDLE_WEDGE] = { 9, 11,
    { { 3, 2, 1, 0 }, { 3, 3, 4, 5 }, { 4, 0, 7, 3, 6 }, { 4, 1, 8, 4, 7 }, { 4, 2, 6, 5, 8 },
      { 3, 0, 6, 2 }, { 3, 0, 1, 7 }, { 3, 1, 2, 8 }, { 3, 3, 5, 6 }, { 3, 3, 7, 4 },
      { 3, 4, 8, 5 } } },
  [MIDDLE_PYRAMID] = { 8, 10,
    { { 4, 3, 2, 1, 0 }, { 3, 0, 5, 4 }, { 3, 1, 6, 5 }, { 3, 2, 7, 6 }, { 3, 3, 4, 7 },
      { 3, 0, 4, 3 }, { 3, 0, 1, 5 }, { 3, 1, 2, 6 }, { 3, 2, 3, 7 }, { 4, 4, 5, 6, 7 } } },
};

static const chi_cell_part tetrahedron[] = { { TETRAHEDRON, { 0, 1, 2, 3 } } };
static const chi_cell_part voxel[] = { { HEXAHEDRON, { 0, 1, 3, 2, 4, 5, 7, 6 } } };
static const chi_cell_part hexahedron[] = { { HEXAHEDRON, { 0, 1, 2, 3, 4, 5, 6, 7 } } };
static const chi_cell_part wedge[] = { { WEDGE, { 0, 1, 2, 3, 4, 5 } } };
static const chi_cell_part pyramid[] = { { PYRAMID, { 0, 1, 2, 3, 4 } } };
static const chi_cell_part pentagonal_prism[] = { { PENTAGONAL_PRISM,
  { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 } } };
static const chi_cell_part hexagonal_prism[] = { { HEXAGONAL_PRISM,
  { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 } } };
static const chi_cell_part quadratic_tetrahedron[] = { { TETRAHEDRON, { 4, 7, 6, 0 } },
  { TETRAHEDRON, { 4, 5, 8, 1 } }, { TETRAHEDRON, { 5, 6, 9, 2 } }, { TETRAHEDRON, { 7, 8, 9, 3 } },
  { MIDDLE_TETRAHEDRON, { 4, 5, 6, 7, 8, 9 } } };
static const chi_cell_part quadratic_hexahedron[] = { { TETRAHEDRON, { 8, 16, 11, 0 } },
  { TETRAHEDRON, { 8, 9, 17, 1 } }, { TETRAHEDRON, { 9, 10, 18, 2 } },
  { TETRAHEDRON, { 10, 11, 19, 3 } }, { TETRAHEDRON, { 12, 15, 16, 4 } },
  { TETRAHEDRON, { 12, 17, 13, 5 } }, { TETRAHEDRON, { 13, 18, 14, 6 } },
  { TETRAHEDRON, { 14, 19, 15, 7 } },
  { MIDDLE_HEXAHEDRON, { 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19 } } };
static const chi_cell_part quadratic_wedge[] = { { TETRAHEDRON, { 6, 12, 8, 0 } },
  { TETRAHEDRON, { 6, 7, 13, 1 } }, { TETRAHEDRON, { 7, 8, 14, 2 } },
  { TETRAHEDRON, { 9, 11, 12, 3 } }, { TETRAHEDRON, { 9, 13, 10, 4 } },
  { TETRAHEDRON, { 10, 14, 11, 5 } }, { MIDDLE_WEDGE, { 6, 7, 8, 9, 10, 11, 12, 13, 14 } } };
static const chi_cell_part quadratic_pyramid[] = { { TETRAHEDRON, { 5, 9, 8, 0 } },
  { TETRAHEDRON, { 5, 6, 10, 1 } }, { TETRAHEDRON, { 6, 7, 11, 2 } },
  { TETRAHEDRON, { 7, 8, 12, 3 } }, { PYRAMID, { 9, 10, 11, 12, 4 } },
  { MIDDLE_PYRAMID, { 5, 6, 7, 8, 9, 10, 11, 12 } } };
static const chi_cell_part triquadratic_hexahedron[] = {
  { HEXAHEDRON, { 0, 8, 24, 11, 16, 22, 26, 20 } }, { HEXAHEDRON, { 8, 1, 9, 24, 22, 17, 21, 26 } },
  { HEXAHEDRON, { 11, 24, 10, 3, 20, 26, 23, 19 } },
  { HEXAHEDRON, { 24, 9, 2, 10, 26, 21, 18, 23 } },
  { HEXAHEDRON, { 16, 22, 26, 20, 4, 12, 25, 15 } },
  { HEXAHEDRON, { 22, 17, 21, 26, 12, 5, 13, 25 } },
  { HEXAHEDRON, { 20, 26, 23, 19, 15, 25, 14, 7 } },
  { HEXAHEDRON, { 26, 21, 18, 23, 25, 13, 6, 14 } }
};
/* Between two levels of eight-node quadrilaterals: wedges at the corners, a hexahedron of the
 * middles. */
static const chi_cell_part biquadratic_hexahedron[] = { { WEDGE, { 0, 8, 11, 16, 22, 20 } },
  { WEDGE, { 1, 9, 8, 17, 21, 22 } }, { WEDGE, { 2, 10, 9, 18, 23, 21 } },
  { WEDGE, { 3, 11, 10, 19, 20, 23 } }, { HEXAHEDRON, { 8, 9, 10, 11, 22, 21, 23, 20 } },
  { WEDGE, { 16, 22, 20, 4, 12, 15 } }, { WEDGE, { 17, 21, 22, 5, 13, 12 } },
  { WEDGE, { 18, 23, 21, 6, 14, 13 } }, { WEDGE, { 19, 20, 23, 7, 15, 14 } },
  { HEXAHEDRON, { 22, 21, 23, 20, 12, 13, 14, 15 } } };
static const chi_cell_part biquadratic_wedge[] = { { WEDGE, { 0, 6, 8, 12, 15, 17 } },
  { WEDGE, { 1, 7, 6, 13, 16, 15 } }, { WEDGE, { 2, 8, 7, 14, 17, 16 } },
  { WEDGE, { 6, 7, 8, 15, 16, 17 } }, { WEDGE, { 12, 15, 17, 3, 9, 11 } },
  { WEDGE, { 13, 16, 15, 4, 10, 9 } }, { WEDGE, { 14, 17, 16, 5, 11, 10 } },
  { WEDGE, { 15, 16, 17, 9, 10, 11 } } };
static const chi_cell_part quadratic_linear_wedge[] = { { WEDGE, { 0, 6, 8, 3, 9, 11 } },
  { WEDGE, { 1, 7, 6, 4, 10, 9 } }, { WEDGE, { 2, 8, 7, 5, 11, 10 } },
  { WEDGE, { 6, 7, 8, 9, 10, 11 } } };
/* All from the node in its middle; its seven-node triangles are fans from theirs. */
static const chi_cell_part triquadratic_pyramid[] = { { PYRAMID, { 0, 5, 13, 8, 18 } },
  { PYRAMID, { 1, 6, 13, 5, 18 } }, { PYRAMID, { 2, 7, 13, 6, 18 } },
  { PYRAMID, { 3, 8, 13, 7, 18 } }, { TETRAHEDRON, { 5, 0, 14, 18 } },
  { TETRAHEDRON, { 1, 5, 14, 18 } }, { TETRAHEDRON, { 10, 1, 14, 18 } },
  { TETRAHEDRON, { 4, 10, 14, 18 } }, { TETRAHEDRON, { 9, 4, 14, 18 } },
  { TETRAHEDRON, { 0, 9, 14, 18 } }, { TETRAHEDRON, { 6, 1, 15, 18 } },
  { TETRAHEDRON, { 2, 6, 15, 18 } }, { TETRAHEDRON, { 11, 2, 15, 18 } },
  { TETRAHEDRON, { 4, 11, 15, 18 } }, { TETRAHEDRON, { 10, 4, 15, 18 } },
  { TETRAHEDRON, { 1, 10, 15, 18 } }, { TETRAHEDRON, { 7, 2, 16, 18 } },
  { TETRAHEDRON, { 3, 7, 16, 18 } }, { TETRAHEDRON, { 12, 3, 16, 18 } },
  { TETRAHEDRON, { 4, 12, 16, 18 } }, { TETRAHEDRON, { 11, 4, 16, 18 } },
  { TETRAHEDRON, { 2, 11, 16, 18 } }, { TETRAHEDRON, { 8, 3, 17, 18 } },
  { TETRAHEDRON, { 0, 8, 17, 18 } }, { TETRAHEDRON, { 9, 0, 17, 18 } },
  { TETRAHEDRON, { 4, 9, 17, 18 } }, { TETRAHEDRON, { 12, 4, 17, 18 } },
  { TETRAHEDRON, { 3, 12, 17, 18 } } };

#define OF(parts, points)                                                                          \
  {                                                                                                \
    parts, sizeof parts / sizeof parts[0], points                                                  \
  }
static const chi_cell_type types[] = {
  [10] = OF(tetrahedron, 4),
  [11] = OF(voxel, 8),
  [12] = OF(hexahedron, 8),
  [13] = OF(wedge, 6),
  [14] = OF(pyramid, 5),
  [15] = OF(pentagonal_prism, 10),
  [16] = OF(hexagonal_prism, 12),
  [24] = OF(quadratic_tetrahedron, 10),
  [25] = OF(quadratic_hexahedron, 20),
  [26] = OF(quadratic_wedge, 15),
  [27] = OF(quadratic_pyramid, 13),
  [29] = OF(triquadratic_hexahedron, 27),
  [31] = OF(quadratic_linear_wedge, 12),
  [32] = OF(biquadratic_wedge, 18),
  [33] = OF(biquadratic_hexahedron, 24),
  [37] = OF(triquadratic_pyramid, 19),
};

const chi_cell_type* chi_cell_type_of(int vtk_type)
{
  const size_t count = sizeof types / sizeof types[0];
  return vtk_type >= 0 && (size_t)vtk_type < count && types[vtk_type].part ? types + vtk_type
                                                                           : NULL;
}

/* Empty cells, vertices, lines and faces, those of higher order too. */
int chi_cell_type_is_flat(int vtk_type)
{
  static const uint8_t flat[][2] = { { 0, 9 }, { 21, 23 }, { 28, 28 }, { 30, 30 }, { 34, 36 },
    { 51, 54 }, { 60, 63 }, { 68, 70 }, { 75, 77 } };
  for (size_t i = 0; i < sizeof flat / sizeof flat[0]; ++i)
  {
    if (vtk_type >= flat[i][0] && vtk_type <= flat[i][1])
    {
      return 1;
    }
  }
  return 0;
}
