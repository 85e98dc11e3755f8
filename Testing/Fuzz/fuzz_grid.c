/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Grids of any kind, with any types of cells, ids and faces: refused where the header says so, else
 * split into tetrahedra that hold together, the same on every host. */

#include "fuzz_grids.h"

static double six_volumes(const double* points, const uint32_t* v)
{
  const double *const a = points + 3 * v[0], *const b = points + 3 * v[1];
  const double *const c = points + 3 * v[2], *const d = points + 3 * v[3];
  const double p[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double q[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
  const double r[3] = { d[0] - a[0], d[1] - a[1], d[2] - a[2] };
  return (p[1] * q[2] - p[2] * q[1]) * r[0] + (p[2] * q[0] - p[0] * q[2]) * r[1] +
    (p[0] * q[1] - p[1] * q[0]) * r[2];
}

/* The size of the coordinates, cubed, times the rounding of a determinant of them. */
static double slack_of(const double* points, const uint32_t* v)
{
  double size = 0;
  for (int k = 0; k < 12; ++k)
  {
    size = fmax(size, fabs(points[3 * v[k / 3] + (uint32_t)(k % 3)]));
  }
  return 1e-14 * size * size * size;
}

static void check_split(
  const chi_grid_view* view, const chi_grid_counts* c, const chi_grid_tetrahedra* t)
{
  const size_t points = c->points + c->extra_points;
  double volume = 0, slack = 0;
  for (size_t i = 0; i < c->tetrahedra; ++i)
  {
    const uint32_t* const v = t->vertices + 4 * i;
    FUZZ_CHECK(t->cells[i] < c->cells && (i == 0 || t->cells[i] >= t->cells[i - 1]));
    FUZZ_CHECK(!view->cell_ghosts || !(view->cell_ghosts[t->cells[i]] & 33));
    for (int k = 0; k < 4; ++k)
    {
      FUZZ_CHECK(v[k] < points);
      FUZZ_CHECK(v[k] >= c->points || !view->point_ghosts || !(view->point_ghosts[v[k]] & 2));
      FUZZ_CHECK(v[k] != v[(k + 1) % 4] && v[k] != v[(k + 2) % 4]);
      for (int a = 0; a < 3; ++a)
      {
        const double x = t->points[3 * v[k] + (uint32_t)a];
        FUZZ_CHECK(v[k] >= c->points || fuzz_is_in(x, c->bounds[2 * a], c->bounds[2 * a + 1]));
      }
    }
    FUZZ_CHECK(six_volumes(t->points, v) >= -slack_of(t->points, v));
    volume += fabs(six_volumes(t->points, v)) / 6;
    slack += slack_of(t->points, v);
  }
  slack += 1e-12 * volume; /* of the sum */
  FUZZ_CHECK(c->volume >= 0 && fuzz_is_in(c->volume, volume - slack, volume + slack));
  for (size_t e = 0; e < c->extra_points; ++e)
  {
    FUZZ_CHECK(t->extra_cells[e] < c->cells);
    FUZZ_CHECK(e == 0 || t->extra_cells[e] > t->extra_cells[e - 1]);
  }
}

static void check_scalars(fuzz* f, const chi_exec* exec, const chi_grid_view* view,
  const chi_grid_counts* c, const uint32_t* extra_cells)
{
  const size_t components = 1 + fuzz_upto(f, 2), count = c->points + c->extra_points;
  const chi_array_view values =
    fuzz_array(f, c->points, components, (chi_type)(1 + fuzz_upto(f, 9)));
  const int32_t component = (int32_t)fuzz_upto(f, components) - 1;
  float* const scalars = (float*)fuzz_new(f, count * sizeof *scalars);
  fuzz_before(f);
  const chi_status status =
    chi_grid_scalars(exec, view, &values, component, extra_cells, c->extra_points, scalars);
  fuzz_after(f, status);
  FUZZ_CHECK(status == CHI_OK || f->cancelled);
}

static void split(
  fuzz* f, const chi_exec* exec, const chi_grid_view* view, const chi_grid_counts* c)
{
  const size_t points = c->points + c->extra_points;
  const chi_grid_tetrahedra out = { .struct_size = sizeof out,
    .vertices = (uint32_t*)fuzz_new(f, 16 * c->tetrahedra),
    .cells = (uint32_t*)fuzz_new(f, 4 * c->tetrahedra),
    .points = (double*)fuzz_new(f, 24 * points),
    .extra_cells = (uint32_t*)fuzz_new(f, 4 * c->extra_points) };
  uint32_t* const again = (uint32_t*)fuzz_new(f, 16 * c->tetrahedra);
  fuzz_before(f);
  const chi_status status = chi_grid_split(exec, view, c, &out);
  fuzz_after(f, status);
  if (status != CHI_OK)
  {
    FUZZ_CHECK(f->refused || f->cancelled);
    return;
  }
  check_split(view, c, &out);
  const chi_grid_tetrahedra few = { .struct_size = sizeof few, .vertices = again };
  FUZZ_CHECK(chi_grid_split(NULL, view, c, &few) == CHI_OK);
  FUZZ_CHECK(memcmp(again, out.vertices, 16 * c->tetrahedra) == 0);
  check_scalars(f, exec, view, c, out.extra_cells);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  const chi_grid_view view = fuzz_grid(f);
  const chi_exec exec = fuzz_host(f, 100000);
  chi_grid_counts counts, plain;
  fuzz_before(f);
  const chi_status status = chi_grid_count(&exec, &view, &counts);
  fuzz_after(f, status);
  FUZZ_CHECK(counts.struct_size == sizeof counts);
  if (status == CHI_OK)
  {
    FUZZ_CHECK(chi_grid_count(NULL, &view, &plain) == CHI_OK);
    FUZZ_CHECK(memcmp(&counts, &plain, sizeof counts) == 0);
    FUZZ_CHECK(counts.first_bad_cell == -1);
    FUZZ_CHECK((counts.first_unsupported_type >= 0) == (counts.unsupported_cells > 0));
    FUZZ_CHECK(counts.ghost_cells + counts.blanked_cells + counts.lower_dimensional_cells +
        counts.unsupported_cells + counts.non_finite_cells + counts.extra_points <=
      counts.cells);
    FUZZ_CHECK(
      counts.flat_cells <= counts.tetrahedra && counts.folded_cells <= counts.extra_points);
    split(f, &exec, &view, &counts);
  }
  else
  {
    FUZZ_CHECK(counts.tetrahedra == 0);
    FUZZ_CHECK(counts.first_bad_cell < (int64_t)view.cell_count);
    FUZZ_CHECK(status == CHI_ERROR_INVALID_ARGUMENT || counts.first_bad_cell == -1);
  }
  fuzz_end(f);
  return 0;
}
