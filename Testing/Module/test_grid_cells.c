/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Every type of cell: volumes, and neighbours that agree about their common face. */

#include "grid_kinds.h"

/* Coordinates are multiples of 1/8 or so: volumes are exact but for a few roundings a tetrahedron.
 */
static const double exact = 1e-14;

static void every_type_has_its_volume_in_tetrahedra_of_all_its_nodes(void)
{
  mesh* const m = new_mesh();
  for (size_t k = 0; k < KINDS; ++k)
  {
    for (uint32_t seed = 0; seed < 200; ++seed)
    {
      m->points = m->cells = 0;
      place_cell(m, kinds[k].type, 0, 0, 0, 1, 1, seed & 1 ? -1 : 1);
      shuffle(m, seed);
      split s = split_of(m);
      check_split(&s);
      check_conformity(m, &s);
      CHECK(s.counts.extra_points == 0 && s.counts.flat_cells == 0);
      CHECK(kinds[k].tetrahedra == 0 || s.counts.tetrahedra == kinds[k].tetrahedra);
      CHECK_NEAR(s.counts.volume, kinds[k].volume, exact);
      uint32_t used = 0;
      for (size_t t = 0; t < 4 * s.counts.tetrahedra; ++t)
      {
        used |= (uint32_t)1 << s.vertices[t / 4][t % 4];
      }
      CHECK(used == ((uint32_t)1 << kinds[k].points) - 1);
      drop_split(&s);
    }
  }
  free(m);
}

static void check_assembly(mesh* m, double volume)
{
  for (uint32_t seed = 0; seed < 300; ++seed)
  {
    shuffle(m, seed);
    split s = split_of(m);
    check_split(&s);
    check_conformity(m, &s);
    CHECK(s.counts.extra_points == 0 && s.counts.flat_cells == 0);
    CHECK_NEAR(s.counts.volume, volume, exact * volume);
    drop_split(&s);
  }
}

static void linear_neighbours_agree(void)
{
  mesh* const m = new_mesh();
  place_cell(m, 12, 0, 0, 0, 1, 1, 1);
  place_cell(m, 11, 1, 0, 0, 1, 1, 1);
  place_cell(m, 13, 0, 1, 0, 1, 1, 1);  /* at the hexahedron's y = 1 */
  place_cell(m, 13, 1, 1, 0, 1, 1, 1);  /* at the voxel's */
  place_cell(m, 10, 0, 1, 1, 1, 1, 1);  /* on a wedge */
  place_cell(m, 10, 1, 1, 0, 1, 1, -1); /* under the other */
  place_cell(m, 14, 1, 0, 1, 1, 1, 2);  /* on the voxel */
  place_cell(m, 14, 0, 0, 0, 1, 1, -1); /* under the hexahedron */
  place_cell(m, 15, 0, 0, 0, 1, -1, 1); /* a prism's side at its y = 0 */
  place_cell(m, 15, 0, 0, 1, 1, -1, 1); /* another on the prism's pentagon */
  place_cell(m, 16, 2, 0, 0, 1, 1, 1);  /* a hexagonal one at the voxel's x = 2 */
  place_cell(m, 16, 2, 0, -1, 1, 1, 1);
  check_assembly(m, 3 + 2.0 / 6 + 1 + 2 * 1.25 + 2 * 1.5);
  free(m);
}

static void quadratic_neighbours_agree(void)
{
  mesh* const m = new_mesh();
  /* eight-node faces */
  place_cell(m, 25, 0, 0, 0, 1, 1, 1);
  place_cell(m, 25, 1, 0, 0, 1, 1, 1);
  place_cell(m, 26, 0, 1, 0, 1, 1, 1);
  place_cell(m, 24, 0, 1, 1, 1, 1, 1);
  place_cell(m, 27, 0, 0, 1, 1, 1, 1);
  place_cell(m, 31, 0, 1, 0, 1, 1, -1); /* under the wedge */
  place_cell(m, 31, 0, 1, -1, 1, 1, -1);
  /* levels of nine-node faces between eight-node ones */
  place_cell(m, 33, 1, 0, 1, 1, 1, 1);
  place_cell(m, 27, 1, 0, 2, 1, 1, 1);
  place_cell(m, 32, 1, 1, 1, 1, 1, 1);
  place_cell(m, 24, 1, 1, 2, 1, 1, 1);
  place_cell(m, 33, 2, 0, 1, 1, 1, 1);
  place_cell(m, 29, 3, 0, 1, 1, 1, 1);
  place_cell(m, 37, 3, 0, 2, 1, 1, 1);
  check_assembly(m, 6 + 2 * 0.5 + 2 * 0.5 - 1 + 2.0 / 6 + 2.0 / 3 + 1.0 / 6);
  free(m);
}

/* Hexahedra that name points twice are the wedges and pyramids that they look like. */
static void collapsed_hexahedra_conform(void)
{
  static const int wedge[8] = { 0, 1, 2, 2, 3, 4, 5, 5 }, pyramid[8] = { 0, 1, 2, 3, 4, 4, 4, 4 };
  mesh* const m = new_mesh();
  place_cell(m, 12, 0, 0, 0, 1, 1, 1);
  place_cell(m, 13, 0, 1, 0, 1, 1, 1);
  place_cell(m, 14, 0, 0, 1, 1, 1, 1);
  for (uint32_t seed = 0; seed < 200; ++seed)
  {
    shuffle(m, seed);
    mesh* const h = new_mesh();
    memcpy(h->x, m->x, m->points * sizeof m->x[0]);
    h->points = m->points;
    for (int c = 0; c < 3; ++c)
    {
      int64_t ids[8];
      for (int k = 0; k < 8; ++k)
      {
        ids[k] = m->ids[m->offsets[c] + (c == 0 ? k : c == 1 ? wedge[k] : pyramid[k])];
      }
      add_cell(h, 12, 8, ids);
    }
    split s = split_of(h);
    check_split(&s);
    check_conformity(m, &s);
    CHECK(s.counts.tetrahedra == 6 + 3 + 2 && s.counts.flat_cells == 0);
    CHECK(s.counts.collapsed_tetrahedra > 0 && s.counts.extra_points == 0);
    CHECK_NEAR(s.counts.volume, 1 + 0.5 + 1.0 / 3, exact);
    drop_split(&s);
    free(h);
  }
  free(m);
}

/* Nodes within a block of cells are moved: a little, and the cells stay as they are cut; much, and
 * some are cut about their centres, parts and all. */
static void bent_quadratic_cells_fill_their_block(void)
{
  static const int types[] = { 25, 29 };
  static const double jitter[] = { 0.03, 0.18 };
  for (int k = 0; k < 4; ++k)
  {
    mesh* const straight = new_mesh();
    mesh* const m = new_mesh();
    size_t extra = 0, whole = 0;
    for (int c = 0; c < 27; ++c)
    {
      place_cell(straight, types[k & 1], c % 3, c / 3 % 3, c / 9, 1, 1, 1);
    }
    for (uint32_t seed = 0; seed < 20; ++seed)
    {
      uint32_t state = seed;
      memcpy(m, straight, sizeof *m);
      for (size_t i = 0; i < m->points; ++i)
      {
        double* const x = m->x[i];
        const int inner = x[0] > 0 && x[0] < 3 && x[1] > 0 && x[1] < 3 && x[2] > 0 && x[2] < 3;
        for (int a = 0; a < 3 && inner; ++a)
        {
          x[a] += jitter[k / 2] * (2 * chi_test_random(&state) - 1);
        }
      }
      shuffle(m, seed);
      split s = split_of(m);
      check_split(&s);
      check_conformity(m, &s);
      CHECK(s.counts.flat_cells == 0);
      extra += s.counts.extra_points;
      if (s.counts.folded_cells == 0)
      {
        /* about a thousand tetrahedra, each of a few eps */
        CHECK_NEAR(s.counts.volume, 27, 27 * exact);
        ++whole;
      }
      drop_split(&s);
    }
    CHECK(k < 2 ? extra == 0 && whole == 20 : extra > 10 && whole > 0);
    free(straight);
    free(m);
  }
}

int main(void)
{
  bent_quadratic_cells_fill_their_block();
  every_type_has_its_volume_in_tetrahedra_of_all_its_nodes();
  linear_neighbours_agree();
  quadratic_neighbours_agree();
  collapsed_hexahedra_conform();
  return chi_test_report();
}
