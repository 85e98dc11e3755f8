/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A slow path that judges keys: row by row the tetrahedra at every pixel, with the interval of
 * depths in which the pixel's ray is within them, from planes in double.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

enum
{
  ROWS = 32 /* judged at once; their fragments are held */
};

/* Intervals that are shorter, and overlaps, of this share of the extent are of no account. */
static const double SHORT = 1e-9;

typedef struct fragment
{
  double entry, exit;
  uint32_t x, t;
} fragment;

typedef struct violation_job
{
  const chi_tet_mesh_view* mesh;
  const chi_order_eye* eye;
  const uint32_t* keys;
  chi_order_window window;
  double least;
  int32_t top; /* the first of the rows at hand */
  chi_order_box* boxes;
  const uint32_t *row_starts, *row_tets; /* of the rows at hand */
  const size_t* fragment_starts;         /* likewise */
  fragment* fragments;
  double (*extents)[6]; /* [chunks] */
  int64_t* violations;  /* [rows] */
} violation_job;

static void fetch(const violation_job* it, size_t t, double v[4][3])
{
  double x[4][3];
  chi_order_corners(it->mesh, t, x);
  for (int i = 0; i < 4; ++i)
  {
    chi_order_to_eye(it->eye, x[i], v[i]);
  }
}

static void find_boxes(void* data, size_t begin, size_t end)
{
  const violation_job* const it = (const violation_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  for (size_t c = begin; c < end; ++c)
  {
    double* const extent = it->extents[c];
    for (size_t t = c * chunk; t < n && t < (c + 1) * chunk; ++t)
    {
      double v[4][3];
      fetch(it, t, v);
      it->boxes[t] = chi_order_box_of(&it->window, (const double(*)[3])v, 4);
      for (int i = 0; i < 12; ++i)
      {
        extent[i % 3] = fmin(extent[i % 3], v[i / 3][i % 3]);
        extent[3 + i % 3] = fmax(extent[3 + i % 3], v[i / 3][i % 3]);
      }
    }
  }
}

/* Where a ray is within a tetrahedron: behind each face of which it sees the inner side, before
 * each of the others. */
static int find_interval(
  const violation_job* it, const double v[4][3], double x, double y, double* entry, double* exit)
{
  const double ray[3] = { it->eye->parallel ? 0 : x, it->eye->parallel ? 0 : y, 1 };
  *entry = it->window.near_depth;
  *exit = INFINITY;
  for (int i = 0; i < 4; ++i)
  {
    const double *const a = v[(i + 1) & 3], *const b = v[(i + 2) & 3], *const c = v[(i + 3) & 3];
    double n[3], inner = 0, along = 0, at = 0;
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      n[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
      inner += n[k] * (v[i][k] - a[k]);
      along += n[k] * ray[k];
    }
    at = it->eye->parallel ? n[0] * (a[0] - x) + n[1] * (a[1] - y) + n[2] * a[2]
                           : n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
    if (inner == 0)
    {
      return 0;
    }
    const double depth = at / along;
    if (along == 0)
    {
      if ((inner > 0) == (at > 0)) /* n . ray depth - at has the sign of -at everywhere */
      {
        return 0;
      }
    }
    else if ((inner > 0) == (along > 0))
    {
      *entry = depth > *entry ? depth : *entry;
    }
    else
    {
      *exit = depth < *exit ? depth : *exit;
    }
  }
  return *exit - *entry > it->least;
}

/* By pixel, then nearest first. */
static int is_less(const fragment* a, const fragment* b)
{
  return a->x < b->x ||
    (a->x == b->x && (a->entry < b->entry || (a->entry == b->entry && a->t < b->t)));
}

static void sift(fragment* f, size_t at, size_t count)
{
  const fragment moved = f[at];
  for (size_t child = 2 * at + 1; child < count; child = 2 * at + 1)
  {
    child += child + 1 < count && is_less(f + child, f + child + 1);
    if (!is_less(&moved, f + child))
    {
      break;
    }
    f[at] = f[child];
    at = child;
  }
  f[at] = moved;
}

static void heap_sort(fragment* f, size_t count)
{
  for (size_t i = count / 2; i-- > 0;)
  {
    sift(f, i, count);
  }
  for (size_t last = count; last-- > 1;)
  {
    const fragment top = f[0];
    f[0] = f[last];
    f[last] = top;
    sift(f, 0, last);
  }
}

static void judge_rows(void* data, size_t begin, size_t end)
{
  const violation_job* const it = (const violation_job*)data;
  for (size_t row = begin; row < end; ++row)
  {
    const int32_t py = it->top + (int32_t)row;
    const double y = it->window.first[1] + py * it->window.step[1];
    fragment* const f = it->fragments + it->fragment_starts[row];
    size_t count = 0;
    for (uint32_t k = it->row_starts[row]; k < it->row_starts[row + 1]; ++k)
    {
      const uint32_t t = it->row_tets[k];
      double v[4][3];
      fetch(it, t, v);
      for (int32_t x = it->boxes[t].x[0]; x <= it->boxes[t].x[1]; ++x)
      {
        fragment g = { .x = (uint32_t)x, .t = t };
        if (find_interval(it, (const double(*)[3])v, it->window.first[0] + x * it->window.step[0],
              y, &g.entry, &g.exit))
        {
          f[count++] = g;
        }
      }
    }
    heap_sort(f, count);
    int64_t wrong = 0;
    for (size_t i = 1; i < count; ++i)
    {
      const fragment *const a = f + i - 1, *const b = f + i; /* a is nearer: it has to come later */
      const uint32_t ka = it->keys[a->t], kb = it->keys[b->t];
      wrong +=
        a->x == b->x && a->exit <= b->entry + it->least && (ka < kb || (ka == kb && a->t < b->t));
    }
    it->violations[py] = wrong;
  }
}

/* The tetrahedra of each row at hand, and room for their fragments. */
static size_t deal(const violation_job* it, uint32_t* starts, uint32_t* tets, size_t* fragments)
{
  memset(starts, 0, (ROWS + 2) * sizeof *starts);
  memset(fragments, 0, (ROWS + 1) * sizeof *fragments);
  for (int pass = 0; pass < (tets ? 2 : 1); ++pass)
  {
    for (size_t t = 0; t < it->mesh->count; ++t)
    {
      const chi_order_box b = it->boxes[t];
      for (int32_t y = b.y[0] > it->top ? b.y[0] : it->top; y <= b.y[1] && y < it->top + ROWS; ++y)
      {
        const int32_t row = y - it->top;
        if (pass)
        {
          tets[starts[row + 1]++] = (uint32_t)t;
        }
        else
        {
          ++starts[row + 2];
          fragments[row + 1] += (size_t)(b.x[1] - b.x[0] + 1);
        }
      }
    }
    for (int row = 0; row < ROWS && !pass; ++row)
    {
      starts[row + 2] += starts[row + 1];
      fragments[row + 1] += fragments[row];
    }
  }
  return starts[ROWS + 1];
}

static chi_status judge(const chi_exec* exec, violation_job* job)
{
  chi_buffer tets = { 0 }, fragments = { 0 };
  uint32_t starts[ROWS + 2];
  size_t fragment_starts[ROWS + 1];
  chi_status status = CHI_OK;
  for (job->top = 0; job->top < job->window.size[1] && status == CHI_OK; job->top += ROWS)
  {
    const size_t count = deal(job, starts, NULL, fragment_starts);
    if (!chi_buffer_reserve(exec, &tets, count, sizeof(uint32_t)) ||
      !chi_buffer_reserve(exec, &fragments, fragment_starts[ROWS], sizeof(fragment)))
    {
      status = CHI_ERROR_OUT_OF_MEMORY;
      break;
    }
    if (count == 0)
    {
      continue;
    }
    deal(job, starts, (uint32_t*)tets.data, fragment_starts);
    job->row_starts = starts;
    job->row_tets = (const uint32_t*)tets.data;
    job->fragment_starts = fragment_starts;
    job->fragments = (fragment*)fragments.data;
    const int32_t left = job->window.size[1] - job->top;
    status = chi_for(exec, (size_t)(left < ROWS ? left : ROWS), judge_rows, job);
  }
  chi_buffer_free(exec, &tets);
  chi_buffer_free(exec, &fragments);
  return status;
}

chi_status chi_tet_order_violations(const chi_exec* exec, const chi_tet_mesh_view* given,
  const chi_tet_order_view* view, const uint32_t* keys, int64_t* violations)
{
  chi_camera camera;
  chi_order_eye eye;
  chi_tet_mesh_view mesh;
  if (!violations)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *violations = 0;
  chi_status status = chi_order_mesh_check(exec, given, &mesh);
  status = status == CHI_OK ? chi_order_eye_find(view, &camera, &eye) : status;
  if (status != CHI_OK || (mesh.count && !keys))
  {
    return status == CHI_OK ? CHI_ERROR_INVALID_ARGUMENT : status;
  }
  double extents[CHI_ORDER_CHUNKS][6];
  violation_job job = { .mesh = &mesh,
    .eye = &eye,
    .keys = keys,
    .window = chi_order_window_of(&eye),
    .extents = extents };
  for (int c = 0; c < CHI_ORDER_CHUNKS; ++c)
  {
    for (int k = 0; k < 6; ++k)
    {
      extents[c][k] = k < 3 ? INFINITY : -INFINITY;
    }
  }
  chi_buffer boxes = { 0 }, rows = { 0 };
  if (!chi_buffer_reserve(exec, &boxes, mesh.count, sizeof(chi_order_box)) ||
    !chi_buffer_reserve(exec, &rows, (size_t)camera.height, sizeof(int64_t)))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  else
  {
    job.boxes = (chi_order_box*)boxes.data;
    job.violations = (int64_t*)rows.data;
    memset(job.violations, 0, (size_t)camera.height * sizeof(int64_t));
    status = chi_for(exec, CHI_ORDER_CHUNKS, find_boxes, &job);
    double extent = 0;
    for (int k = 0; k < 3; ++k)
    {
      double low = INFINITY, high = -INFINITY;
      for (int c = 0; c < CHI_ORDER_CHUNKS; ++c)
      {
        low = fmin(low, extents[c][k]);
        high = fmax(high, extents[c][3 + k]);
      }
      extent += high > low ? (high - low) * (high - low) : 0;
    }
    job.least = SHORT * sqrt(extent);
    status = status == CHI_OK ? judge(exec, &job) : status;
    for (int32_t y = 0; y < camera.height && status == CHI_OK; ++y)
    {
      *violations += job.violations[y];
    }
  }
  chi_buffer_free(exec, &boxes);
  chi_buffer_free(exec, &rows);
  return status;
}
