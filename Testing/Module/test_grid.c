/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Grids of every kind and their split: conformity, volumes, invariance, any schedule. */

#include "grid_lattice.h"

static const double eps = 2.220446049250313e-16;

static void an_image_has_the_split_of_kuhn(void)
{
  const chi_grid_view view = image_of(4, 3, 5);
  split s;
  CHECK(make_split(&s, NULL, &view) == CHI_OK);
  check_split(&s);
  CHECK(s.counts.points == 60 && s.counts.cells == 24 && s.counts.tetrahedra == 6 * 24);
  CHECK(s.counts.extra_points == 0 && s.counts.flat_cells == 0 && s.counts.folded_cells == 0);
  CHECK_NEAR(s.counts.volume, 24 * 0.25, 24 * eps);
  const double bounds[6] = { 1, 2.5, 2, 2.5, 3, 11 };
  CHECK(memcmp(bounds, s.counts.bounds, sizeof bounds) == 0); /* binary fractions */
  for (size_t t = 0; t < s.counts.tetrahedra; ++t)
  {
    /* a path of three axes from the cell's first to its last point */
    const size_t c = s.cells[t];
    const uint32_t first = (uint32_t)(c % 3 + 4 * (c / 3 % 2) + 12 * (c / 6));
    id_set path = { .count = 4 };
    for (int k = 0; k < 4; ++k)
    {
      path.id[k] = s.vertices[t][k];
    }
    qsort(path.id, 4, sizeof path.id[0], compare_ids);
    CHECK(path.id[0] == first && path.id[3] == first + 1 + 4 + 12);
    int steps = 0;
    for (int k = 0; k < 3; ++k)
    {
      const int64_t d = path.id[k + 1] - path.id[k];
      steps |= d == 1 ? 1 : d == 4 ? 2 : d == 12 ? 4 : 0;
    }
    CHECK(steps == 7);
  }
  size_t singles;
  id_set* const boundary = boundary_of(&s, &singles);
  CHECK(singles == 2 * 2 * (3 * 2 + 2 * 4 + 3 * 4));
  free(boundary);
  drop_split(&s);
}

/* The same points as a structured grid of each kind, and as hexahedra. */
static void kinds_of_grids_agree(void)
{
  const size_t d[3] = { 5, 4, 3 };
  for (int mirror = 0; mirror < 2; ++mirror)
  {
    chi_grid_view image = image_of(d[0], d[1], d[2]);
    image.index_to_world[5] *= mirror ? -1 : 1;
    split a, b;
    CHECK(make_split(&a, NULL, &image) == CHI_OK);
    check_split(&a);
    double axis[3][5];
    chi_grid_view view = image;
    view.kind = CHI_GRID_RECTILINEAR;
    for (int i = 0; i < 3; ++i)
    {
      for (size_t k = 0; k < d[i]; ++k)
      {
        axis[i][k] = image.index_to_world[5 * i] * (double)k + image.index_to_world[4 * i + 3];
      }
      view.axes[i] = (chi_array_view){ axis[i], d[i], 1, sizeof(double), CHI_F64 };
    }
    for (int kind = 0; kind < 3; ++kind)
    {
      mesh* const m = new_mesh();
      memcpy(m->x, a.points, a.counts.points * sizeof m->x[0]);
      m->points = a.counts.points;
      if (kind == 1)
      {
        view.kind = CHI_GRID_CURVILINEAR;
        view.points = (chi_vec3_view){ m->x, m->points, sizeof m->x[0], CHI_F64 };
      }
      if (kind == 2)
      {
        for (size_t c = 0; c < a.counts.cells; ++c)
        {
          const int64_t q = (int64_t)(c % 4 + 5 * (c / 4 % 3) + 20 * (c / 12));
          add_cell(
            m, 12, 8, (const int64_t[8]){ q, q + 1, q + 6, q + 5, q + 20, q + 21, q + 26, q + 25 });
        }
        view = view_of(m);
      }
      CHECK(make_split(&b, NULL, &view) == CHI_OK);
      CHECK(a.counts.tetrahedra == b.counts.tetrahedra && a.counts.volume == b.counts.volume);
      CHECK(memcmp(a.counts.bounds, b.counts.bounds, sizeof a.counts.bounds) == 0);
      const size_t n = a.counts.tetrahedra;
      CHECK(memcmp(a.vertices, b.vertices, n * sizeof *a.vertices) == 0);
      CHECK(memcmp(a.cells, b.cells, n * sizeof *a.cells) == 0);
      CHECK(memcmp(a.points, b.points, a.counts.points * sizeof *a.points) == 0);
      if (kind == 2)
      {
        drop_view(&view);
      }
      drop_split(&b);
      free(m);
    }
    drop_split(&a);
  }
}

static void flat_structured_grids_have_no_tetrahedra(void)
{
  static const size_t sizes[][4] = { { 4, 5, 1, 12 }, { 1, 5, 6, 20 }, { 7, 1, 1, 6 },
    { 1, 1, 1, 1 }, { 0, 4, 4, 0 } };
  for (int k = 0; k < 5; ++k)
  {
    const chi_grid_view view = image_of(sizes[k][0], sizes[k][1], sizes[k][2]);
    split s;
    CHECK(make_split(&s, NULL, &view) == CHI_OK);
    CHECK(s.counts.cells == sizes[k][3] && s.counts.lower_dimensional_cells == sizes[k][3]);
    CHECK(s.counts.tetrahedra == 0 && s.counts.bounds[0] > s.counts.bounds[1]);
    CHECK(s.counts.volume == 0);
    drop_split(&s);
  }
  const chi_grid_view none = { .struct_size = sizeof none, .points = { NULL, 0, 24, CHI_F64 } };
  split s;
  CHECK(make_split(&s, NULL, &none) == CHI_OK);
  CHECK(s.counts.points == 0 && s.counts.cells == 0 && s.counts.tetrahedra == 0);
  drop_split(&s);
}

static void mixed_meshes_fill_their_box(void)
{
  for (uint32_t seed = 0; seed < 30; ++seed)
  {
    mesh* const m = make_mixed(4, 0.12, seed);
    shuffle(m, seed);
    split s = split_of(m);
    check_split(&s);
    size_t singles;
    id_set* const boundary = boundary_of(&s, &singles);
    size_t wedges = 0;
    for (size_t c = 0; c < m->cells; ++c)
    {
      wedges += m->types[c] == 10;
    }
    /* two triangles a face of the box; a tetrahedron on top hides one and shows three */
    CHECK(singles == 6 * 16 * 2 + 2 * wedges);
    CHECK(s.counts.folded_cells == 0);
    /* faces are warped, but their triangles are shared: only rounding is left, a few eps a
     * tetrahedron of the coordinates' size cubed */
    CHECK_NEAR(s.counts.volume, 64 + volume_on_top(m), 64 * 16 * eps);
    free(boundary);
    drop_split(&s);
    free(m);
  }
}

/* Bent so much that fans from a vertex overlap: the centre takes over, and neighbours still agree.
 */
static void bent_cells_are_split_about_their_centre(void)
{
  size_t extra = 0;
  for (uint32_t seed = 0; seed < 10; ++seed)
  {
    mesh* const m = make_mixed(4, 0.42, seed);
    shuffle(m, seed);
    split s = split_of(m);
    check_split(&s);
    size_t singles;
    id_set* const boundary = boundary_of(&s, &singles);
    extra += s.counts.extra_points;
    if (s.counts.folded_cells == 0)
    {
      CHECK_NEAR(s.counts.volume, 64 + volume_on_top(m), 64 * 16 * eps);
    }
    else
    {
      CHECK(s.counts.volume > 64 + volume_on_top(m));
    }
    for (size_t e = 0; e < s.counts.extra_points; ++e)
    {
      const size_t c = s.extra_cells[e];
      CHECK(e == 0 || c > s.extra_cells[e - 1]);
      for (int a = 0; a < 3; ++a)
      {
        double sum = 0;
        for (int64_t k = m->offsets[c]; k < m->offsets[c + 1]; ++k)
        {
          sum += m->x[m->ids[k]][a];
        }
        CHECK_NEAR(
          s.points[m->points + e][a], sum / (double)(m->offsets[c + 1] - m->offsets[c]), 32 * eps);
      }
    }
    free(boundary);
    drop_split(&s);
    free(m);
  }
  CHECK(extra > 20);
}

static void volumes_do_not_depend_on_ids_or_place(void)
{
  mesh* const m = make_mixed(4, 0.1, 5);
  split s = split_of(m);
  const double volume = s.counts.volume;
  drop_split(&s);
  shuffle(m, 17);
  s = split_of(m);
  CHECK_NEAR(s.counts.volume, volume, 64 * 16 * eps);
  drop_split(&s);
  for (size_t i = 0; i < m->points; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      m->x[i][a] += 1e8;
    }
  }
  s = split_of(m);
  check_split(&s);
  /* the box's planes stand on integers: that inner points are rounded to 2^-27 moves no volume but
   * that of the tetrahedra on top */
  CHECK_NEAR(s.counts.volume, 64 + volume_on_top(m), 64 * 16 * eps);
  CHECK(s.counts.folded_cells == 0);
  drop_split(&s);
  free(m);
}

static void float_and_strided_points_agree(void)
{
  mesh* const m = make_mixed(3, 0.1, 3);
  for (size_t i = 0; i < m->points; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      /* volatile: gcc 12.2 vectorises the plain loop without its last point */
      volatile const float rounded = (float)m->x[i][a];
      m->x[i][a] = rounded;
    }
  }
  split a = split_of(m), b;
  for (int wide = 0; wide < 2; ++wide)
  {
    chi_grid_view view = view_of(m);
    const size_t stride = wide ? 29 : 3 * sizeof(float);
    char* const packed = malloc((m->points - 1) * stride + 3 * sizeof(float));
    for (size_t i = 0; i < m->points && packed; ++i)
    {
      const float x[3] = { (float)m->x[i][0], (float)m->x[i][1], (float)m->x[i][2] };
      memcpy(packed + i * stride, x, sizeof x);
    }
    const void* const doubles = view.points.data;
    view.points = (chi_vec3_view){ packed, m->points, stride, CHI_F32 };
    CHECK(make_split(&b, NULL, &view) == CHI_OK);
    CHECK(a.counts.volume == b.counts.volume && a.counts.tetrahedra == b.counts.tetrahedra);
    CHECK(memcmp(a.vertices, b.vertices, a.counts.tetrahedra * sizeof *a.vertices) == 0);
    CHECK(memcmp(a.points, b.points, m->points * sizeof *a.points) == 0);
    free(packed);
    view.points.data = doubles;
    drop_view(&view);
    drop_split(&b);
  }
  drop_split(&a);
  free(m);
}

static void any_schedule_gives_the_same_bits(void)
{
  /* several chunks of cells, of all ways to split */
  mesh* const m = make_mixed(22, 0.3, 7);
  CHECK(m->points <= MESH_POINTS && m->cells <= MESH_CELLS && m->cells > 3 * 4096);
  CHECK(m->offsets[m->cells] <= MESH_IDS);
  shuffle(m, 9);
  chi_grid_view view = view_of(m);
  chi_exec exec = { .struct_size = sizeof exec, .parallel_for = chi_test_backwards };
  split a, b;
  CHECK(make_split(&a, NULL, &view) == CHI_OK && make_split(&b, &exec, &view) == CHI_OK);
  check_split(&a);
  const size_t n = a.counts.tetrahedra, e = a.counts.extra_points;
  CHECK(e > 100 && memcmp(&a.counts, &b.counts, sizeof a.counts) == 0);
  CHECK(memcmp(a.vertices, b.vertices, n * sizeof *a.vertices) == 0);
  CHECK(memcmp(a.cells, b.cells, n * sizeof *a.cells) == 0);
  CHECK(memcmp(a.extra_cells, b.extra_cells, e * sizeof *a.extra_cells) == 0);
  CHECK(memcmp(a.points, b.points, (m->points + e) * sizeof *a.points) == 0);
  float* const x = malloc((m->points + e) * sizeof *x);
  float* const y = malloc((m->points + e) * sizeof *y);
  const chi_array_view values = { view.points.data, m->points, 3, 24, CHI_F64 };
  CHECK(chi_grid_scalars(NULL, &view, &values, -1, a.extra_cells, e, x) == CHI_OK);
  CHECK(chi_grid_scalars(&exec, &view, &values, -1, a.extra_cells, e, y) == CHI_OK);
  CHECK(memcmp(x, y, (m->points + e) * sizeof *x) == 0);
  free(x);
  free(y);
  drop_split(&a);
  drop_split(&b);
  drop_view(&view);
  free(m);
}

int main(void)
{
  an_image_has_the_split_of_kuhn();
  kinds_of_grids_agree();
  flat_structured_grids_have_no_tetrahedra();
  mixed_meshes_fill_their_box();
  bent_cells_are_split_about_their_centre();
  volumes_do_not_depend_on_ids_or_place();
  float_and_strided_points_agree();
  any_schedule_gives_the_same_bits();
  return chi_test_report();
}
