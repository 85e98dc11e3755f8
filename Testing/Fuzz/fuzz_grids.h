/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FUZZ_GRIDS_H
#define CHI_FUZZ_GRIDS_H

/* Grids of any kind, with any types of cells, ids and faces; some are broken. */

#include "fuzz.h"

#include <chiaroscuro/chi_grid.h>

static const uint8_t fuzz_point_counts[256] = { [10] = 4,
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

FUZZ_UNUSED int64_t fuzz_id(fuzz* f, size_t points)
{
  return fuzz_once_in(f, 255) ? (int64_t)fuzz_bits(f, 8) : (int64_t)fuzz_upto(f, points - 1);
}

/* Faces of any sizes from the cell's points, now and then malformed. */
FUZZ_UNUSED size_t fuzz_add_faces(fuzz* f, int64_t* faces, const int64_t* ids, size_t count)
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

FUZZ_UNUSED void fuzz_add_cells(fuzz* f, chi_grid_view* view)
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
    size_t count = fuzz_point_counts[type[c]] ? fuzz_point_counts[type[c]] : 4 + fuzz_upto(f, 6);
    count = fuzz_once_in(f, 200) ? fuzz_upto(f, 27) : count;
    const size_t first = fuzz_upto(f, points - 1), step = fuzz_once_in(f, 3) ? 0 : 1;
    for (size_t k = 0; k < count; ++k)
    {
      ids[id_count + k] = step ? (int64_t)((first + k) % points) : fuzz_id(f, points);
    }
    face_offsets[c] = -1;
    if (type[c] == 42 && count > 0)
    {
      face_offsets[c] = fuzz_once_in(f, 128) ? (int64_t)fuzz_bits(f, 2) : (int64_t)face_count;
      face_count += fuzz_add_faces(f, faces + face_count, ids + id_count, count);
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

FUZZ_UNUSED chi_grid_view fuzz_grid(fuzz* f)
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
    fuzz_add_cells(f, &view);
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

/* Of a grid that may be broken: what fuzzed calls do not read of it they may accept, so that
 * whether counting succeeds says nothing. */
FUZZ_UNUSED chi_grid_counts fuzz_counts(const chi_grid_view* grid)
{
  chi_grid_counts counts = { .struct_size = sizeof counts };
  const chi_status status = chi_grid_count(NULL, grid, &counts);
  (void)status;
  return counts;
}

#endif
