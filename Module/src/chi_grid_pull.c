/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * One cell's tetrahedra. Faces are fans from their lowest point; a cell is the cone of those faces'
 * triangles that do not touch its lowest point (Dompierre et al. 1999), or of all of them from its
 * centre. Corners are indices of a cell's points, of a polyhedron point ids, or CHI_CELL_CENTER.
 */

#include "chi_grid_internal.h"

#include <math.h>

static const int64_t in_order[4] = { 0, 1, 2, 3 }; /* a tetrahedron as it is */

typedef void (*visit_fn)(void* data, const int64_t corner[4]);

static inline int64_t id_of(const chi_grid_cell* cell, int64_t corner)
{
  return cell->type ? cell->ids[corner] : corner;
}

/* The cone of a face, unless the apex is the lowest of its corners; `flip`: the other way round. */
static inline void visit_face(const chi_grid_cell* cell, int64_t apex, const int64_t* face,
  size_t count, int flip, visit_fn visit, void* data)
{
  size_t low = 0;
  int64_t least = id_of(cell, face[0]);
  for (size_t k = 1; k < count; ++k)
  {
    const int64_t id = id_of(cell, face[k]);
    low = id < least ? k : low;
    least = id < least ? id : least;
  }
  if (apex != CHI_CELL_CENTER && id_of(cell, apex) == least)
  {
    return;
  }
  size_t b = low + 1 < count ? low + 1 : 0;
  for (size_t k = 2; k < count; ++k)
  {
    const size_t c = b + 1 < count ? b + 1 : 0;
    const int64_t corner[4] = { apex, face[low], face[flip ? c : b], face[flip ? b : c] };
    visit(data, corner);
    b = c;
  }
}

static inline void visit_part(const chi_grid_cell* cell, const chi_cell_part* part, uint32_t faces,
  int from_center, visit_fn visit, void* data)
{
  const chi_shape* const shape = chi_shapes + part->shape;
  int64_t apex = CHI_CELL_CENTER;
  for (size_t k = 0; k < shape->points && !from_center; ++k)
  {
    const int64_t node = part->node[k];
    apex = k == 0 || cell->ids[node] < cell->ids[apex] ? node : apex;
  }
  for (size_t f = 0; f < shape->faces; ++f)
  {
    const uint8_t* const face = shape->face[f];
    int64_t corner[6] = { part->node[face[1]] };
    for (size_t k = 1; k < face[0]; ++k)
    {
      corner[k] = part->node[face[1 + k]];
    }
    if (faces >> f & 1)
    {
      visit_face(cell, apex, corner, face[0], 0, visit, data);
    }
  }
}

/* `flips`, by bits: faces that go the other way round. */
static inline void visit_polyhedron(
  const chi_grid_cell* cell, int from_center, uint64_t flips, visit_fn visit, void* data)
{
  int64_t apex = from_center ? CHI_CELL_CENTER : INT64_MAX;
  const int64_t* at = cell->faces;
  for (size_t f = 0; f < cell->face_count && !from_center; ++f)
  {
    for (int64_t n = *at++; n > 0; --n, ++at)
    {
      apex = *at < apex ? *at : apex;
    }
  }
  at = cell->faces;
  for (size_t f = 0; f < cell->face_count; ++f)
  {
    const size_t count = (size_t)*at++;
    visit_face(cell, apex, at, count, f < 64 && flips >> f & 1, visit, data);
    at += count;
  }
}

static uint32_t nodes_of(const chi_cell_part* part, size_t f)
{
  const uint8_t* const face = chi_shapes[part->shape].face[f];
  uint32_t nodes = 0;
  for (size_t k = 0; k < face[0]; ++k)
  {
    nodes |= (uint32_t)1 << part->node[face[1 + k]];
  }
  return nodes;
}

/* The faces of a part, by bits, that no other part of the cell has. */
static uint32_t outer_faces(const chi_cell_type* type, size_t part)
{
  uint32_t outer = 0;
  for (size_t f = 0; f < chi_shapes[type->part[part].shape].faces; ++f)
  {
    const uint32_t nodes = nodes_of(type->part + part, f);
    int shared = 0;
    for (size_t p = 0; p < type->parts; ++p)
    {
      for (size_t g = 0; g < chi_shapes[type->part[p].shape].faces && p != part; ++g)
      {
        shared |= nodes_of(type->part + p, g) == nodes;
      }
    }
    outer |= (uint32_t)!shared << f;
  }
  return outer;
}

static inline void visit_cell(
  const chi_grid_cell* cell, int from_center, uint64_t flips, visit_fn visit, void* data)
{
  if (!cell->type)
  {
    visit_polyhedron(cell, from_center, flips, visit, data);
    return;
  }
  for (size_t p = 0; p < cell->type->parts; ++p)
  {
    const uint32_t faces =
      from_center && cell->type->parts > 1 ? outer_faces(cell->type, p) : UINT32_MAX;
    visit_part(cell, cell->type->part + p, faces, from_center, visit, data);
  }
}

static inline int is_collapsed(const chi_grid_cell* cell, const int64_t corner[4])
{
  const int64_t a = corner[0] == CHI_CELL_CENTER ? -1 : id_of(cell, corner[0]);
  const int64_t b = id_of(cell, corner[1]), c = id_of(cell, corner[2]), d = id_of(cell, corner[3]);
  return (a == b) | (a == c) | (a == d) | (b == c) | (b == d) | (c == d);
}

static inline const double* place(const chi_grid_cell* cell, int64_t corner, double own[3])
{
  if (corner == CHI_CELL_CENTER)
  {
    return cell->center;
  }
  if (cell->type)
  {
    return cell->x[corner];
  }
  chi_grid_point(cell->grid, (size_t)corner, own);
  return own;
}

/* Six times the volume, positive if right-handed: (b - a) . ((c - a) x (d - a)). Exchanging c and d
 * changes the sign and nothing else, roundings included. */
static inline double six_volumes(const chi_grid_cell* cell, const int64_t corner[4])
{
  double own[4][3];
  const double* const a = place(cell, corner[0], own[0]);
  const double* const b = place(cell, corner[1], own[1]);
  const double* const c = place(cell, corner[2], own[2]);
  const double* const d = place(cell, corner[3], own[3]);
  const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
  const double w[3] = { d[0] - a[0], d[1] - a[1], d[2] - a[2] };
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
    u[2] * (v[0] * w[1] - v[1] * w[0]);
}

typedef struct measure
{
  const chi_grid_cell* cell;
  double total, least, most; /* of six volumes: sum of |V|; extremes of V */
  size_t count, flat, collapsed;
} measure;

static inline void add_to_measure(void* data, const int64_t corner[4])
{
  measure* const m = (measure*)data;
  if (is_collapsed(m->cell, corner))
  {
    ++m->collapsed;
    return;
  }
  const double v = six_volumes(m->cell, corner);
  m->total += fabs(v);
  m->least = v < m->least ? v : m->least;
  m->most = v > m->most ? v : m->most;
  m->flat += v == 0;
  ++m->count;
}

static inline measure measure_split(const chi_grid_cell* cell, int from_center, uint64_t flips)
{
  measure m = { .cell = cell };
  visit_cell(cell, from_center, flips, add_to_measure, &m);
  return m;
}

/* What rounded coordinates do to six volumes of a tetrahedron: a corner moves by up to sqrt(3) u
 * size, they by twice the area of the face opposite, at most sqrt(3) / 2 L^2, times that. So four
 * corners give 6 u size L^2; the arithmetic, of a few u L^3, fits into the rest. */
static double noise_of(const chi_grid_cell* cell)
{
  double square = 0, size = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double d = cell->high[a] - cell->low[a];
    square += d * d;
    size = fmax(size, fmax(fabs(cell->low[a]), fabs(cell->high[a])));
  }
  return 8 * cell->grid->rounding * size * square;
}

/* All of one orientation, but for what rounded coordinates may have turned. */
static int is_one_sided(const measure* m, double noise)
{
  return m->least >= -noise || m->most <= noise;
}

void chi_cell_choose(chi_grid_cell* cell, chi_cell_split* split)
{
  measure used = { .cell = cell };
  uint64_t flips = 0;
  *split = (chi_cell_split){ .way = CHI_SPLIT_POSITIVE };
  if (cell->count == 4 && cell->type)
  {
    add_to_measure(&used, in_order);
  }
  else
  {
    flips = cell->type ? 0 : chi_cell_flips(cell);
    used = measure_split(cell, 0, flips);
  }
  if (flips || (used.least < 0 && used.most > 0))
  {
    const double noise = noise_of(cell);
    split->way = CHI_SPLIT_SIGNED;
    if (!is_one_sided(&used, noise))
    {
      chi_cell_find_center(cell);
      used = measure_split(cell, 1, flips);
      split->way = CHI_SPLIT_CENTER;
      split->folded = !is_one_sided(&used, noise);
    }
  }
  else if (used.least < 0)
  {
    split->way = CHI_SPLIT_NEGATIVE;
  }
  split->tetrahedra = used.count;
  split->flat = used.flat;
  split->collapsed = used.collapsed;
  split->volume = used.total / 6;
}

typedef struct writing
{
  const chi_grid_cell* cell;
  int way;
  uint32_t center_id;
  uint32_t (*vertices)[4];
  size_t count;
} writing;

static inline void write_tetrahedron(void* data, const int64_t corner[4])
{
  writing* const w = (writing*)data;
  if (is_collapsed(w->cell, corner))
  {
    return;
  }
  const int swap = w->way == CHI_SPLIT_NEGATIVE ||
    (w->way != CHI_SPLIT_POSITIVE && six_volumes(w->cell, corner) < 0);
  uint32_t* const v = w->vertices[w->count++];
  v[0] = corner[0] == CHI_CELL_CENTER ? w->center_id : (uint32_t)id_of(w->cell, corner[0]);
  v[1] = (uint32_t)id_of(w->cell, corner[1]);
  v[2] = (uint32_t)id_of(w->cell, corner[2 + swap]);
  v[3] = (uint32_t)id_of(w->cell, corner[3 - swap]);
}

size_t chi_cell_write(
  const chi_grid_cell* cell, int way, uint32_t center_id, uint32_t (*vertices)[4])
{
  writing w = { cell, way, center_id, vertices, 0 };
  if (cell->count == 4 && cell->type)
  {
    write_tetrahedron(&w, in_order);
    return w.count;
  }
  visit_cell(cell, way == CHI_SPLIT_CENTER, 0, write_tetrahedron, &w);
  return w.count;
}
