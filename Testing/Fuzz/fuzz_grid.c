/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Grids of any kind, with any types of cells, ids and faces: refused where the header says so, else
 * split into tetrahedra that hold together, the same on every host. */

#include "fuzz.h"

#include <chiaroscuro/chi_grid.h>

static const uint8_t point_counts[256] = { [10] = 4,
  [11] = 8,
  [12] = 8,
  [13] = 6,
  [14] = 5,
  [15] = 10,
  [16] = 12,
  [24] = 10,
  [25] = 20,
  [26] = 15,
  [27] = 13,
  [29] = 27,
  [31] = 12,
  [32] = 18,
  [33] = 24,
  [37] = 19 };

static int64_t any_id(fuzz* f, size_t points)
{
  return fuzz_once_in(f, 255) ? (int64_t)fuzz_bits(f, 8) : (int64_t)fuzz_upto(f, points - 1);
}

/* Faces of any sizes from the cell's points, now and then malformed. */
static size_t add_faces(fuzz* f, int64_t* faces, const int64_t* ids, size_t count)
{
  size_t length = 1;
  const size_t n = fuzz_once_in(f, 64) ? fuzz_upto(f, 3) : 4 + fuzz_upto(f, 5);
  faces[0] = fuzz_once_in(f, 128) ? (int64_t)fuzz_bits(f, 8) : (int64_t)n;
  for (size_t i = 0; i < n; ++i)
  {
    const size_t corners = fuzz_once_in(f, 64) ? fuzz_upto(f, 2) : 3 + fuzz_upto(f, 3);
    faces[length++] = fuzz_once_in(f, 128) ? (int64_t)fuzz_bits(f, 8) : (int64_t)corners;
    for (size_t k = 0; k < corners; ++k)
    {
      faces[length++] = ids[fuzz_upto(f, count - 1)];
    }
  }
  return length;
}

static void add_cells(fuzz* f, chi_grid_view* view)
{
  static const uint8_t types[] = { 10, 12, 10, 13, 14, 11, 15, 16, 24, 25, 26, 27, 29, 31, 32, 33,
    37, 42, 42, 42 };
  const size_t points = view->points.count, cells = points ? fuzz_upto(f, 40) : 0;
  int64_t ids[40 * 27], faces[40 * 64];
  size_t id_count = 0, face_count = 0;
  uint8_t* const type = (uint8_t*)fuzz_new(f, cells);
  int64_t* const offsets = (int64_t*)fuzz_new(f, (cells + 1) * sizeof *offsets);
  int64_t* const face_offsets = (int64_t*)fuzz_new(f, cells * sizeof *face_offsets);
  offsets[0] = 0;
  for (size_t c = 0; c < cells; ++c)
  {
    type[c] = fuzz_once_in(f, 16) ? (uint8_t)fuzz_byte(f) : types[fuzz_upto(f, sizeof types - 1)];
    size_t count = point_counts[type[c]] ? point_counts[type[c]] : 4 + fuzz_upto(f, 6);
    count = fuzz_once_in(f, 200) ? fuzz_upto(f, 27) : count;
    const size_t first = fuzz_upto(f, points - 1), step = fuzz_once_in(f, 3) ? 0 : 1;
    for (size_t k = 0; k < count; ++k)
    {
      ids[id_count + k] = step ? (int64_t)((first + k) % points) : any_id(f, points);
    }
    face_offsets[c] = -1;
    if (type[c] == 42 && count > 0)
    {
      face_offsets[c] = fuzz_once_in(f, 128) ? (int64_t)fuzz_bits(f, 2) : (int64_t)face_count;
      face_count += add_faces(f, faces + face_count, ids + id_count, count);
    }
    id_count += count;
    offsets[c + 1] = fuzz_once_in(f, 255) ? (int64_t)fuzz_bits(f, 8) : (int64_t)id_count;
  }
  int64_t* const own_ids = (int64_t*)fuzz_new(f, id_count * sizeof *ids);
  int64_t* const own_faces = (int64_t*)fuzz_new(f, face_count * sizeof *faces);
  memcpy(own_ids, ids, id_count * sizeof *ids);
  memcpy(own_faces, faces, face_count * sizeof *faces);
  view->cell_types = type;
  view->offsets = offsets;
  view->connectivity = own_ids;
  view->connectivity_count = id_count;
  view->cell_count = cells;
  view->faces = face_count || fuzz_byte(f) & 1 ? own_faces : NULL;
  view->face_offsets = face_offsets;
  view->faces_count = face_count;
}

static chi_grid_view any_grid(fuzz* f)
{
  chi_grid_view view = { .struct_size = fuzz_size(f, sizeof view) };
  view.kind = fuzz_once_in(f, 128) ? (int32_t)fuzz_bits(f, 4) : (int32_t)fuzz_upto(f, 7) % 4;
  size_t points = fuzz_upto(f, 60), cells = 0;
  if (view.kind != CHI_GRID_UNSTRUCTURED)
  {
    points = cells = 1;
    for (int a = 0; a < 3; ++a)
    {
      const size_t n = fuzz_upto(f, 5);
      view.dimensions[a] = n;
      view.axes[a] = fuzz_array(f, n, 1, (chi_type)(1 + fuzz_upto(f, 9)));
      points *= n;
      cells *= n > 1 ? n - 1 : n;
    }
    for (int k = 0; k < 16; ++k)
    {
      view.index_to_world[k] = fuzz_mostly(f, k % 5 == 0);
    }
  }
  const chi_array_view xyz = fuzz_array(f, points, 3, fuzz_byte(f) & 1 ? CHI_F32 : CHI_F64);
  view.points = (chi_vec3_view){ xyz.data, points, xyz.stride, xyz.type };
  if (view.kind == CHI_GRID_UNSTRUCTURED)
  {
    add_cells(f, &view);
    cells = view.cell_count;
  }
  for (int k = 0; k < 2; ++k)
  {
    const size_t count = k ? points : cells;
    uint8_t* const ghosts = (uint8_t*)fuzz_new(f, count);
    const int used = fuzz_once_in(f, 4);
    for (size_t i = 0; i < count; ++i)
    {
      ghosts[i] = used && fuzz_once_in(f, 8) ? (uint8_t)fuzz_byte(f) : 0;
    }
    *(k ? &view.point_ghosts : &view.cell_ghosts) = used ? ghosts : NULL;
  }
  if (fuzz_once_in(f, 64)) /* one thing that is wrong */
  {
    switch (fuzz_upto(f, 4))
    {
      case 0:
        view.points.stride = fuzz_upto(f, 11);
        break;
      case 1:
        view.points.type = (chi_type)fuzz_byte(f);
        view.points.type = view.points.type == CHI_F64 ? CHI_I8 : view.points.type;
        break;
      case 2:
        view.dimensions[fuzz_upto(f, 2)] = (size_t)fuzz_bits(f, 8) | (size_t)1 << 60;
        break;
      case 3:
        view.offsets = NULL;
        break;
      default:
        view.axes[0].count -= view.axes[0].count > 0;
        break;
    }
  }
  return view;
}

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
  fuzz* const f = (fuzz*)calloc(1, sizeof *f);
  FUZZ_CHECK(f);
  f->bytes = bytes;
  f->count = count;
  const chi_grid_view view = any_grid(f);
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
  free(f);
  return 0;
}
