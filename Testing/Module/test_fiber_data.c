/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fiber surfaces on grids and fields of every kind, what is left out of them, the data they carry
 * and the cells they enclose. */

#include "fiber_surface.h"

/* An image, its tetrahedra as cells, and its cubes as hexahedra. */
static void kinds_of_grids_agree(void)
{
  const chi_grid_view image = image_of(9, 8, 7);
  mesh* const m = tetrahedra_of(&image);
  chi_grid_view list = view_of(m);
  chi_grid_view curvilinear = image;
  curvilinear.kind = CHI_GRID_CURVILINEAR;
  curvilinear.points = list.points;
  fields f = make_fields(&image, mixed_waves);
  f.values[2 * 100] = NAN;
  f.values[2 * 250 + 1] = INFINITY;
  f.values[2 * 251 + 1] = -1e101;
  lines l = make_line(5, fiber_square);
  const chi_fiber_params params = params_of(&f, &l);
  surface a = surface_of(&image, &params), b = surface_of(&list, &params),
          c = surface_of(&curvilinear, &params);
  check_surface(&a, 8 * 7 * 6);
  CHECK(a.sizes.triangles > 100);
  CHECK(a.sizes.triangles == b.sizes.triangles && a.sizes.points == b.sizes.points);
  CHECK(a.sizes.triangles == c.sizes.triangles && a.sizes.points == c.sizes.points);
  CHECK(a.sizes.tetrahedra == b.sizes.tetrahedra && a.sizes.crossed == b.sizes.crossed);
  CHECK_NEAR(area_of(&b), area_of(&a), 1e-12 * area_of(&a)); /* sums in another order */
  CHECK_NEAR(area_of(&c), area_of(&a), 1e-12 * area_of(&a));
  CHECK(a.sizes.non_finite_values == c.sizes.non_finite_values);
  CHECK(a.sizes.non_finite_values >= 8 && a.sizes.non_finite_values <= 20);
  CHECK(b.sizes.non_finite_values > a.sizes.non_finite_values);
  for (int k = 0; k < 2; ++k)
  {
    CHECK(a.sizes.field_ranges[2 * k] < a.sizes.field_ranges[2 * k + 1]);
    CHECK(fabs(a.sizes.field_ranges[2 * k + 1]) < 2);
  }
  size_t touched = 0;
  for (size_t i = 0; i < a.sizes.points; ++i)
  {
    touched += !(fabs(a.points[i][0]) < 1e3);
  }
  CHECK(touched == 0);
  drop_surface(&a);
  drop_surface(&b);
  drop_surface(&c);
  drop_lines(&l);
  free(f.values);
  drop_view(&list);
  free(m);
}

static void ghosts_and_wild_points_are_left_out(void)
{
  const chi_grid_view image = image_of(9, 8, 7);
  mesh* const m = tetrahedra_of(&image);
  const size_t tetrahedra = m->cells;
  uint8_t* const ghosts = must_alloc(tetrahedra);
  uint8_t* const hidden = must_alloc(9 * 8 * 7);
  memset(ghosts, 0, tetrahedra);
  memset(hidden, 0, 9 * 8 * 7);
  for (size_t c = 0; c < 8 * 7 * 6; ++c) /* a third of the cubes, duplicate or hidden */
  {
    const uint8_t bits = c % 3 ? 0 : c % 2 ? CHI_GRID_DUPLICATE_CELL : CHI_GRID_HIDDEN_CELL;
    memset(ghosts + 6 * c, bits, 6);
  }
  uint8_t* const cube_ghosts = must_alloc(8 * 7 * 6);
  for (size_t c = 0; c < 8 * 7 * 6; ++c)
  {
    cube_ghosts[c] = ghosts[6 * c];
  }
  hidden[200] = CHI_GRID_HIDDEN_POINT;
  fields f = make_fields(&image, mixed_waves);
  lines l = make_line(5, fiber_square);
  const chi_fiber_params params = params_of(&f, &l);
  chi_grid_view cubes = image, list = view_of(m);
  cubes.cell_ghosts = cube_ghosts;
  list.cell_ghosts = ghosts;
  surface a = surface_of(&cubes, &params), b = surface_of(&list, &params);
  CHECK(a.sizes.triangles > 0 && a.sizes.triangles == b.sizes.triangles);
  CHECK(a.sizes.hidden_cells == 112 && b.sizes.hidden_cells == 6 * 112);
  for (size_t t = 0; t < a.sizes.triangles; ++t)
  {
    CHECK(!cube_ghosts[a.cells[t]]);
  }
  drop_surface(&a);
  drop_surface(&b);
  cubes.point_ghosts = hidden;
  a = surface_of(&cubes, &params);
  CHECK(a.sizes.hidden_cells > 112 && a.sizes.hidden_cells <= 120);
  drop_surface(&a);
  drop_view(&list);
  m->x[200][1] = NAN;
  m->x[201][2] = 1e101;
  list = view_of(m);
  surface c = surface_of(&list, &params);
  CHECK(c.sizes.non_finite_cells > 20 && c.sizes.triangles > 0);
  check_surface(&c, tetrahedra);
  drop_surface(&c);
  drop_lines(&l);
  free(f.values);
  free(ghosts);
  free(cube_ghosts);
  free(hidden);
  drop_view(&list);
  free(m);
}

static void data_are_carried(void)
{
  mesh* const m = make_mixed(4, 0.3, 11);
  chi_grid_view grid = view_of(m);
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square);
  const chi_fiber_params params = params_of(&f, &l);
  chi_fiber* fiber = NULL;
  surface s;
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
  CHECK(write_surface(&s, NULL, fiber, &params) == CHI_OK);
  const size_t n = s.sizes.points;
  double* const places = must_alloc(3 * n * sizeof *places);
  double* const values = must_alloc(2 * n * sizeof *values);
  float* const single = must_alloc(2 * n * sizeof *single);
  int32_t* const nearest = must_alloc(n * sizeof *nearest);
  int64_t* const ids = must_alloc(n * sizeof *ids);
  int32_t* const numbers = must_alloc(m->points * sizeof *numbers);
  float* const floats = must_alloc(2 * f.points * sizeof *floats);
  for (size_t i = 0; i < m->points; ++i)
  {
    numbers[i] = (int32_t)(7 * i);
    floats[2 * i] = (float)f.values[2 * i];
    floats[2 * i + 1] = (float)f.values[2 * i + 1];
  }
  const chi_array_view coordinates = { m->x, m->points, 3, 3 * sizeof(double), CHI_F64 };
  const chi_array_view whole = { numbers, m->points, 1, sizeof *numbers, CHI_I32 };
  const chi_array_view in_single = { floats, f.points, 2, 2 * sizeof *floats, CHI_F32 };
  CHECK(chi_fiber_attribute(NULL, fiber, &coordinates, places, 3 * sizeof *places) == CHI_OK);
  CHECK(chi_fiber_attribute(NULL, fiber, &f.view, values, 2 * sizeof *values) == CHI_OK);
  CHECK(chi_fiber_attribute(NULL, fiber, &in_single, single, 2 * sizeof *single) == CHI_OK);
  CHECK(chi_fiber_attribute(NULL, fiber, &whole, nearest, sizeof *nearest) == CHI_OK);
  CHECK(chi_fiber_nearest(NULL, fiber, ids) == CHI_OK);
  double apart = 0, off = 0, rounded = 0;
  size_t wrong = 0;
  for (size_t i = 0; i < n; ++i)
  {
    double best = 1;
    for (int a = 0; a < 3; ++a)
    {
      apart = fmax(apart, fabs(places[3 * i + (size_t)a] - s.points[i][a]));
    }
    /* on the square's outline */
    const double u = values[2 * i], v = values[2 * i + 1];
    for (int k = 0; k < 4; ++k)
    {
      const double* const p = fiber_square[k];
      best = fmin(best, k % 2 ? fabs(u - p[0]) : fabs(v - p[1]));
    }
    off = fmax(off, best);
    off = fmax(off, fmax(fmax(-0.4 - u, u - 0.6), fmax(-0.5 - v, v - 0.4)));
    rounded = fmax(rounded, fabs(single[2 * i] - u));
    wrong += ids[i] < 0 || (size_t)ids[i] >= m->points || nearest[i] != 7 * ids[i];
  }
  CHECK(apart < 1e-14); /* coordinates up to 5 */
  CHECK(off < 1e-14);
  CHECK(rounded < 1.2e-7); /* two roundings to float of values below 1 */
  CHECK(wrong == 0);
  free(places);
  free(values);
  free(single);
  free(nearest);
  free(ids);
  free(numbers);
  free(floats);
  drop_surface(&s);
  chi_fiber_destroy(NULL, fiber);
  drop_lines(&l);
  free(f.values);
  drop_view(&grid);
  free(m);
}

static void fields_of_any_type_and_stride_agree(void)
{
  const chi_grid_view grid = image_of(9, 8, 7);
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square);
  for (size_t i = 0; i < 2 * f.points; ++i)
  {
    f.values[i] = round(f.values[i] * 40);
  }
  for (size_t i = 0; i < 15; ++i)
  {
    l.xyz[i] *= 40;
  }
  chi_fiber_params params = params_of(&f, &l);
  surface first = surface_of(&grid, &params);
  CHECK(first.sizes.triangles > 100);
  float* const u = must_alloc(f.points * sizeof *u);
  int8_t* const v = must_alloc(f.points * 5);
  for (size_t i = 0; i < f.points; ++i)
  {
    u[i] = (float)f.values[2 * i];
    v[5 * i + 3] = (int8_t)f.values[2 * i + 1];
  }
  const chi_array_view single = { u, f.points, 1, sizeof *u, CHI_F32 };
  const chi_array_view bytes = { v, f.points, 4, 5, CHI_I8 };
  params.fields[0] = &single;
  params.fields[1] = &bytes;
  params.components[1] = 3;
  surface s = surface_of(&grid, &params);
  CHECK(same_surface(&first, &s));
  drop_surface(&s);
  params.components[0] = -1; /* |u| */
  s = surface_of(&grid, &params);
  CHECK(s.sizes.field_ranges[0] >= 0 && !same_surface(&first, &s));
  drop_surface(&s);
  drop_surface(&first);
  free(u);
  free(v);
  drop_lines(&l);
  free(f.values);
}

/* Against clipping each cell's image, a union of triangles, by looking at many points of each cell:
 * a point inside is found there in no cell that is 0, and at most few cells that are 1 have none.
 */
static void the_mask_marks_cells_that_touch_the_inside(void)
{
  const chi_grid_view image = image_of(9, 8, 7);
  mesh* const m = make_mixed(5, 0.2, 23);
  chi_grid_view mixed = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &mixed };
  const size_t cells[2] = { 8 * 7 * 6, m->cells };
  for (int k = 0; k < 2; ++k)
  {
    fields f = make_fields(grids[k], mixed_waves);
    lines l = make_line(5, fiber_square);
    const chi_fiber_params params = params_of(&f, &l);
    chi_fiber* fiber = NULL;
    uint8_t* const mask = must_alloc(cells[k]);
    uint8_t* const seen = must_alloc(cells[k]);
    memset(seen, 0, cells[k]);
    CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
    CHECK(chi_fiber_extract(NULL, fiber, grids[k], &params) == CHI_OK);
    CHECK(chi_fiber_mask(NULL, fiber, mask) == CHI_OK);
    split s;
    CHECK(make_split(&s, NULL, grids[k]) == CHI_OK);
    uint32_t seed = 5;
    for (size_t t = 0; t < s.counts.tetrahedra; ++t)
    {
      for (int j = 0; j < 400; ++j)
      {
        double w[4], sum = 0, u = 0, v = 0;
        int is_known = 1;
        for (int c = 0; c < 4; ++c)
        {
          w[c] = -log(1 - chi_test_random(&seed));
          sum += w[c];
        }
        for (int c = 0; c < 4; ++c)
        {
          is_known &= s.vertices[t][c] < f.points; /* a centre is not */
          u += is_known ? w[c] / sum * f.values[2 * s.vertices[t][c]] : 0;
          v += is_known ? w[c] / sum * f.values[2 * s.vertices[t][c] + 1] : 0;
        }
        seen[s.cells[t]] |= is_known && u > -0.4 && u < 0.6 && v > -0.5 && v < 0.4;
      }
    }
    size_t missed = 0, found = 0, marked = 0;
    for (size_t c = 0; c < cells[k]; ++c)
    {
      missed += seen[c] && !mask[c];
      found += seen[c];
      marked += mask[c] != 0;
    }
    CHECK(missed == 0);
    CHECK(found > 20 && marked >= found && marked < found + found / 4 + 5 && marked < cells[k]);
    drop_split(&s);
    chi_fiber_destroy(NULL, fiber);
    free(mask);
    free(seen);
    drop_lines(&l);
    free(f.values);
  }
  drop_view(&mixed);
  free(m);
}

static void empty_and_flat_grids_have_no_surface(void)
{
  const size_t sizes[3][3] = { { 0, 4, 4 }, { 4, 4, 1 }, { 1, 1, 1 } };
  lines l = make_line(5, fiber_square);
  for (int k = 0; k < 3; ++k)
  {
    const chi_grid_view grid = image_of(sizes[k][0], sizes[k][1], sizes[k][2]);
    fields f = make_fields(&grid, mixed_waves);
    const chi_fiber_params params = params_of(&f, &l);
    surface s = surface_of(&grid, &params);
    CHECK(s.sizes.triangles == 0 && s.sizes.tetrahedra == 0);
    CHECK(s.sizes.other_cells == (k == 0 ? 0 : k == 1 ? 9 : 1));
    drop_surface(&s);
    free(f.values);
  }
  drop_lines(&l);
}

static void places_and_sizes_do_not_matter(void)
{
  const chi_grid_view grid = image_of(9, 8, 7);
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square);
  chi_fiber_params params = params_of(&f, &l);
  surface first = surface_of(&grid, &params);
  const double scales[3] = { 0x1p-40, 1, 0x1p60 };
  for (int k = 0; k < 3; ++k)
  {
    chi_grid_view other = grid;
    for (int i = 0; i < 12; ++i)
    {
      other.index_to_world[i] *= scales[k];
    }
    for (size_t i = 0; i < 2 * f.points; ++i)
    {
      f.values[i] *= scales[k];
    }
    for (size_t i = 0; i < 15; ++i)
    {
      l.xyz[i] *= scales[k];
    }
    surface s = surface_of(&other, &params);
    /* powers of two change no digit */
    CHECK(s.sizes.triangles == first.sizes.triangles);
    CHECK(memcmp(s.normals, first.normals, s.sizes.points * sizeof *s.normals) == 0);
    CHECK(area_of(&s) == area_of(&first) * scales[k] * scales[k]);
    drop_surface(&s);
    for (size_t i = 0; i < 2 * f.points; ++i)
    {
      f.values[i] /= scales[k];
    }
    for (size_t i = 0; i < 15; ++i)
    {
      l.xyz[i] /= scales[k];
    }
  }
  drop_surface(&first);
  drop_lines(&l);
  free(f.values);
}

int main(void)
{
  kinds_of_grids_agree();
  ghosts_and_wild_points_are_left_out();
  data_are_carried();
  fields_of_any_type_and_stride_agree();
  the_mask_marks_cells_that_touch_the_inside();
  empty_and_flat_grids_have_no_surface();
  places_and_sizes_do_not_matter();
  return chi_test_report();
}
