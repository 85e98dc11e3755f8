/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_GRID_MESH_H
#define CHI_GRID_MESH_H

/* Small unstructured grids, made cell by cell from shared points, and their splits. Arrays that the
 * core sees are copied to blocks of exact size first. */

#include "chi_test.h"

#include <chiaroscuro/chi_grid.h>

enum
{
  MESH_POINTS = 30000,
  MESH_CELLS = 40000,
  MESH_IDS = 300000
};

typedef struct mesh
{
  double x[MESH_POINTS][3];
  uint8_t types[MESH_CELLS];
  int64_t offsets[MESH_CELLS + 1], ids[MESH_IDS], faces[MESH_IDS], face_offsets[MESH_CELLS];
  size_t points, cells, face_count;
} mesh;

typedef struct split
{
  chi_grid_counts counts;
  uint32_t (*vertices)[4];
  uint32_t *cells, *extra_cells;
  double (*points)[3];
} split;

__attribute__((unused)) static mesh* new_mesh(void)
{
  mesh* const m = calloc(1, sizeof *m);
  if (!m)
  {
    exit(1);
  }
  return m;
}

__attribute__((unused)) static int64_t add_point(mesh* m, double x, double y, double z)
{
  m->x[m->points][0] = x;
  m->x[m->points][1] = y;
  m->x[m->points][2] = z;
  return (int64_t)m->points++;
}

/* The point that is there, or a new one. */
__attribute__((unused)) static int64_t share_point(mesh* m, double x, double y, double z)
{
  for (size_t i = 0; i < m->points; ++i)
  {
    if (fabs(m->x[i][0] - x) + fabs(m->x[i][1] - y) + fabs(m->x[i][2] - z) < 1e-9)
    {
      return (int64_t)i;
    }
  }
  return add_point(m, x, y, z);
}

__attribute__((unused)) static void add_cell(mesh* m, int type, size_t count, const int64_t* ids)
{
  memcpy(m->ids + m->offsets[m->cells], ids, count * sizeof *ids);
  m->types[m->cells] = (uint8_t)type;
  m->face_offsets[m->cells] = -1;
  m->offsets[m->cells + 1] = m->offsets[m->cells] + (int64_t)count;
  ++m->cells;
}

/* `faces`: the number of faces, then for each that of its points and these. */
__attribute__((unused)) static void add_polyhedron(
  mesh* m, size_t count, const int64_t* ids, size_t length, const int64_t* faces)
{
  add_cell(m, 42, count, ids);
  m->face_offsets[m->cells - 1] = (int64_t)m->face_count;
  memcpy(m->faces + m->face_count, faces, length * sizeof *faces);
  m->face_count += length;
}

/* Give points other ids, and move them along. */
__attribute__((unused)) static void shuffle(mesh* m, uint32_t seed)
{
  int64_t* const to = malloc((m->points + 1) * sizeof *to);
  double(*const x)[3] = malloc((m->points + 1) * sizeof *x);
  if (!to || !x)
  {
    exit(1);
  }
  for (size_t i = 0; i < m->points; ++i)
  {
    const size_t j = (size_t)(chi_test_random(&seed) * (double)(i + 1));
    to[i] = j == i ? (int64_t)i : to[j];
    to[j] = (int64_t)i;
  }
  memcpy(x, m->x, m->points * sizeof *x);
  for (size_t i = 0; i < m->points; ++i)
  {
    memcpy(m->x[to[i]], x[i], sizeof x[i]);
  }
  for (int64_t k = 0; k < m->offsets[m->cells]; ++k)
  {
    m->ids[k] = to[m->ids[k]];
  }
  for (size_t c = 0; c < m->cells; ++c)
  {
    if (m->face_offsets[c] >= 0)
    {
      int64_t* at = m->faces + m->face_offsets[c];
      for (int64_t f = *at++; f > 0; --f)
      {
        for (int64_t n = *at++; n > 0; --n, ++at)
        {
          *at = to[*at];
        }
      }
    }
  }
  free(to);
  free(x);
}

__attribute__((unused)) static void* exact_copy(const void* from, size_t bytes)
{
  void* const block = malloc(bytes ? bytes : 1);
  if (!block)
  {
    exit(1);
  }
  memcpy(block, from, bytes);
  return block;
}

__attribute__((unused)) static chi_grid_view view_of(const mesh* m)
{
  const size_t ids = (size_t)m->offsets[m->cells];
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { exact_copy(m->x, m->points * sizeof m->x[0]), m->points, sizeof m->x[0], CHI_F64 },
    .cell_types = exact_copy(m->types, m->cells),
    .offsets = exact_copy(m->offsets, (m->cells + 1) * sizeof(int64_t)),
    .connectivity = exact_copy(m->ids, ids * sizeof(int64_t)),
    .cell_count = m->cells,
    .connectivity_count = ids,
    .faces = m->face_count ? exact_copy(m->faces, m->face_count * sizeof(int64_t)) : NULL,
    .face_offsets = m->face_count ? exact_copy(m->face_offsets, m->cells * sizeof(int64_t)) : NULL,
    .faces_count = m->face_count };
}

__attribute__((unused)) static void drop_view(chi_grid_view* v)
{
  free((void*)v->points.data);
  free((void*)v->cell_types);
  free((void*)v->offsets);
  free((void*)v->connectivity);
  free((void*)v->faces);
  free((void*)v->face_offsets);
}

__attribute__((unused)) static chi_status make_split(
  split* s, const chi_exec* exec, const chi_grid_view* view)
{
  memset(s, 0, sizeof *s);
  chi_status status = chi_grid_count(exec, view, &s->counts);
  if (status != CHI_OK)
  {
    return status;
  }
  const size_t n = s->counts.tetrahedra, extra = s->counts.extra_points;
  s->vertices = malloc(n ? n * sizeof *s->vertices : 1);
  s->cells = malloc(n ? n * sizeof *s->cells : 1);
  s->extra_cells = malloc(extra ? extra * sizeof *s->extra_cells : 1);
  s->points = malloc((s->counts.points + extra) * sizeof *s->points + 1);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out,
    .vertices = (uint32_t*)s->vertices,
    .cells = s->cells,
    .points = (double*)s->points,
    .extra_cells = s->extra_cells };
  return chi_grid_split(exec, view, &s->counts, &out);
}

__attribute__((unused)) static void drop_split(split* s)
{
  free(s->vertices);
  free(s->cells);
  free(s->extra_cells);
  free(s->points);
}

/* The split of a mesh, on the default host. */
__attribute__((unused)) static split split_of(const mesh* m)
{
  split s;
  chi_grid_view view = view_of(m);
  CHECK(make_split(&s, NULL, &view) == CHI_OK);
  drop_view(&view);
  return s;
}

__attribute__((unused)) static double volume_of(const split* s, size_t t)
{
  const double* const a = s->points[s->vertices[t][0]];
  double e[3][3];
  for (int k = 0; k < 3; ++k)
  {
    for (int i = 0; i < 3; ++i)
    {
      e[k][i] = s->points[s->vertices[t][k + 1]][i] - a[i];
    }
  }
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
           e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
    6;
}

/* What every split promises: right-handed, ids that are there, cells in order, volumes and flat
 * ones as counted. Tolerance: the sums round in another order, n additions of eps of the sum each.
 */
__attribute__((unused)) static void check_split(const split* s)
{
  double sum = 0;
  size_t flat = 0, left = 0, beyond = 0, unordered = 0;
  for (size_t t = 0; t < s->counts.tetrahedra; ++t)
  {
    for (int k = 0; k < 4; ++k)
    {
      beyond += s->vertices[t][k] >= s->counts.points + s->counts.extra_points;
    }
    const double v = beyond ? 0 : volume_of(s, t);
    left += v < 0;
    flat += v == 0;
    sum += v;
    unordered += t > 0 && s->cells[t] < s->cells[t - 1];
  }
  CHECK(beyond == 0 && left == 0 && unordered == 0);
  CHECK(flat == s->counts.flat_cells);
  CHECK_NEAR(sum, s->counts.volume, 2.3e-16 * (double)(s->counts.tetrahedra + 8) * sum);
}

/* A set of ids in order, as a triangle of the split or a face of the mesh, and whose it is. */
typedef struct id_set
{
  int64_t id[9];
  size_t count;
} id_set;

__attribute__((unused)) static int compare_ids(const void* a, const void* b)
{
  const int64_t x = *(const int64_t*)a, y = *(const int64_t*)b;
  return (x > y) - (x < y);
}

__attribute__((unused)) static int compare_sets(const void* a, const void* b)
{
  const id_set *const x = (const id_set*)a, *const y = (const id_set*)b;
  if (x->count != y->count)
  {
    return x->count < y->count ? -1 : 1;
  }
  for (size_t k = 0; k < x->count; ++k)
  {
    if (x->id[k] != y->id[k])
    {
      return x->id[k] < y->id[k] ? -1 : 1;
    }
  }
  return 0;
}

/* Sort, and keep those that occur once; `more`: those that occur more than twice. */
__attribute__((unused)) static size_t keep_single(id_set* set, size_t count, size_t* more)
{
  size_t kept = 0;
  *more = 0;
  qsort(set, count, sizeof *set, compare_sets);
  for (size_t i = 0, j; i < count; i = j)
  {
    for (j = i + 1; j < count && compare_sets(set + i, set + j) == 0; ++j)
    {
    }
    *more += j - i > 2;
    if (j - i == 1)
    {
      set[kept++] = set[i];
    }
  }
  return kept;
}

/* The triangles of a split: those of one tetrahedron alone; none belongs to more than two. */
__attribute__((unused)) static id_set* boundary_of(const split* s, size_t* count)
{
  const size_t n = s->counts.tetrahedra;
  id_set* const set = calloc(4 * n + 1, sizeof *set);
  if (!set)
  {
    exit(1);
  }
  for (size_t i = 0; i < 4 * n; ++i)
  {
    for (size_t k = 0; k < 4; ++k)
    {
      if (k != i % 4)
      {
        set[i].id[set[i].count++] = s->vertices[i / 4][k];
      }
    }
    qsort(set[i].id, 3, sizeof set[i].id[0], compare_ids);
  }
  size_t more;
  *count = keep_single(set, 4 * n, &more);
  CHECK(more == 0);
  return set;
}

#endif
