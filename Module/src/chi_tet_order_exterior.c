/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What faces with neighbours do not tell: which tetrahedron is in front of which across a gap. As
 * in Cook, Max, Silva & Williams 2004, the gaps are looked up where it matters, on the rays through
 * the pixels' centres: there the mesh is left through one exterior face and entered through the
 * next.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

enum
{
  BAND = 16,       /* rows that one task draws */
  RECENT = 1 << 10 /* relations remembered, so that a face's many pixels say them once */
};

/* Depths of faces that touch may differ by rounding: of this share of the depth. */
static const double TOUCHING = 1e-12;

typedef struct event
{
  double depth;
  uint32_t t;
  uint32_t enters; /* on the way to the eye: 1 into the tetrahedron, 0 out of it */
} event;

typedef struct exterior_job
{
  const chi_tet_mesh_view* mesh;
  const chi_order_eye* eye;
  const uint32_t* faces;
  size_t face_count;
  double sense; /* of the matrix to the eye's space */
  chi_order_window window;
  chi_order_box* boxes;
  uint32_t *band_starts, *band_faces;
  uint32_t* counts; /* [pixels + 1] events, then where they start */
  event* events;    /* NULL: counted */
  chi_order_relation* found;
  uint32_t* found_counts; /* [bands] */
} exterior_job;

typedef struct triangle
{
  double v[3][3];    /* in the eye's space */
  double edge[3][3]; /* perspective: v_j x v_k */
} triangle;

static void fetch(const exterior_job* it, uint32_t face, triangle* f)
{
  for (size_t k = 0; k < 3; ++k)
  {
    double x[3];
    chi_view_get(
      &it->mesh->points, it->mesh->vertices[(face & ~3u) + (size_t)chi_order_face[face & 3][k]], x);
    chi_order_to_eye(it->eye, x, f->v[k]);
  }
  for (int k = 0; k < 3; ++k)
  {
    const double *const a = f->v[(k + 1) % 3], *const b = f->v[(k + 2) % 3];
    f->edge[k][0] = a[1] * b[2] - a[2] * b[1];
    f->edge[k][1] = a[2] * b[0] - a[0] * b[2];
    f->edge[k][2] = a[0] * b[1] - a[1] * b[0];
  }
}

/* The depth at which a ray meets the triangle: positive; and whether towards the eye it leaves the
 * tetrahedron. Weights of an edge that two faces share have the same size: no ray slips through. */
static int meet(
  const exterior_job* it, const triangle* f, double x, double y, double* depth, int* leaves)
{
  double w[3], sum = 0, z = 0;
  for (int k = 0; k < 3; ++k)
  {
    if (it->eye->parallel)
    {
      const double *const a = f->v[(k + 1) % 3], *const b = f->v[(k + 2) % 3];
      w[k] = (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x);
    }
    else
    {
      w[k] = x * f->edge[k][0] + y * f->edge[k][1] + f->edge[k][2];
    }
    sum += w[k];
    z += w[k] * f->v[k][2];
  }
  const int is_positive = w[0] >= 0 && w[1] >= 0 && w[2] >= 0;
  if ((!is_positive && !(w[0] <= 0 && w[1] <= 0 && w[2] <= 0)) || sum == 0)
  {
    return 0;
  }
  /* the point met is the weighted mean of the corners; perspective: all weights have the sign of
   * v0 . (v1 x v2), in a space whose third axis runs away from the eye */
  *depth = z / sum;
  *leaves = (sum > 0) == (it->sense > 0);
  return 1;
}

static void find_boxes(void* data, size_t begin, size_t end)
{
  const exterior_job* const it = (const exterior_job*)data;
  const size_t chunk = chi_order_chunk(it->face_count);
  for (size_t i = begin * chunk; i < end * chunk && i < it->face_count; ++i)
  {
    triangle f;
    fetch(it, it->faces[i], &f);
    it->boxes[i] = chi_order_box_of(&it->window, (const double(*)[3])f.v, 3);
  }
}

static void draw_bands(void* data, size_t begin, size_t end)
{
  const exterior_job* const it = (const exterior_job*)data;
  const double near_depth = it->eye->parallel ? -INFINITY : 0;
  const size_t width = (size_t)it->window.size[0];
  for (size_t band = begin; band < end; ++band)
  {
    const int32_t top = (int32_t)band * BAND;
    const int32_t past = top + BAND < it->window.size[1] ? top + BAND : it->window.size[1];
    if (!it->events)
    {
      memset(it->counts + (size_t)top * width, 0, (size_t)(past - top) * width * sizeof(uint32_t));
    }
    for (uint32_t k = it->band_starts[band]; k < it->band_starts[band + 1]; ++k)
    {
      const uint32_t i = it->band_faces[k];
      const chi_order_box b = it->boxes[i];
      triangle f;
      fetch(it, it->faces[i], &f);
      for (int32_t y = b.y[0] > top ? b.y[0] : top; y <= b.y[1] && y < past; ++y)
      {
        for (int32_t x = b.x[0]; x <= b.x[1]; ++x)
        {
          double depth;
          int leaves;
          if (meet(it, &f, it->window.first[0] + x * it->window.step[0],
                it->window.first[1] + y * it->window.step[1], &depth, &leaves) &&
            depth > near_depth)
          {
            uint32_t* const place = it->counts + (size_t)y * width + (size_t)x;
            if (it->events)
            {
              it->events[*place] = (event){ depth, it->faces[i] / 4, !leaves };
            }
            ++*place;
          }
        }
      }
    }
  }
}

/* Farthest first; of faces that touch those first through which the mesh is left. */
static int comes_before(const event* a, const event* b)
{
  const double apart = TOUCHING * (fabs(a->depth) + fabs(b->depth));
  if (a->enters != b->enters && fabs(a->depth - b->depth) <= apart)
  {
    return a->enters < b->enters;
  }
  return a->depth > b->depth || (a->depth == b->depth && a->t < b->t);
}

static void remember(chi_order_relation* recent, uint32_t from, uint32_t to,
  chi_order_relation* found, uint32_t* count)
{
  chi_order_relation* const last =
    recent + ((from * 0x9e3779b1u ^ to * 0x85ebca6bu) >> 16) % RECENT;
  if (from != to && (last->from != from || last->to != to))
  {
    *last = (chi_order_relation){ from, to };
    found[(*count)++] = *last;
  }
}

/* Of one ray's events, which are not sorted. */
static void relate(event* e, size_t count, chi_order_relation* recent, chi_order_relation* found,
  uint32_t* found_count)
{
  for (size_t i = 1; i < count; ++i)
  {
    const event moved = e[i];
    size_t at = i;
    for (; at > 0 && comes_before(&moved, e + at - 1); --at)
    {
      e[at] = e[at - 1];
    }
    e[at] = moved;
  }
  for (size_t i = 1; i < count; ++i)
  {
    if (!e[i].enters || e[i - 1].enters)
    {
      continue;
    }
    /* an edge may be left and entered through two faces at once: all leave before one, and one
     * leaves before all */
    const double apart = 2 * TOUCHING * fabs(e[i].depth);
    remember(recent, e[i - 1].t, e[i].t, found, found_count);
    for (size_t k = i - 1; k-- > 0 && !e[k].enters && e[k].depth - e[i - 1].depth <= apart;)
    {
      remember(recent, e[k].t, e[i].t, found, found_count);
    }
    for (size_t k = i + 1; k < count && e[k].enters && e[i].depth - e[k].depth <= apart; ++k)
    {
      remember(recent, e[i - 1].t, e[k].t, found, found_count);
    }
  }
}

static void relate_bands(void* data, size_t begin, size_t end)
{
  const exterior_job* const it = (const exterior_job*)data;
  const size_t width = (size_t)it->window.size[0], pixels = width * (size_t)it->window.size[1];
  for (size_t band = begin; band < end; ++band)
  {
    chi_order_relation recent[RECENT] = { { 0, 0 } };
    const size_t first = band * BAND * width, last = first + BAND * width;
    uint32_t count = 0;
    /* where a pixel's events start is where those of the one before end, now that they are in */
    const uint32_t start = first ? it->counts[first - 1] : 0;
    for (size_t p = first; p < last && p < pixels; ++p)
    {
      const uint32_t from = p ? it->counts[p - 1] : 0;
      relate(it->events + from, it->counts[p] - from, recent, it->found + start, &count);
    }
    it->found_counts[band] = count;
  }
}

/* Faces by the bands that they are in. */
static chi_status deal(const chi_exec* exec, chi_order_sort* sort, exterior_job* job, size_t bands)
{
  if (!chi_buffer_reserve(exec, &sort->counts,
        (size_t)job->window.size[0] * (size_t)job->window.size[1] + 2 * (bands + 2),
        sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->counts = (uint32_t*)sort->counts.data;
  job->band_starts = job->counts + (size_t)job->window.size[0] * (size_t)job->window.size[1];
  job->found_counts = job->band_starts + bands + 2;
  memset(job->band_starts, 0, (bands + 2) * sizeof(uint32_t));
  uint64_t sum = 0;
  for (size_t i = 0; i < job->face_count; ++i)
  {
    for (int b = job->boxes[i].y[0] / BAND;
         job->boxes[i].y[0] <= job->boxes[i].y[1] && b <= job->boxes[i].y[1] / BAND; ++b)
    {
      ++job->band_starts[b + 2];
      ++sum;
    }
  }
  if (sum > UINT32_MAX)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  if (!chi_buffer_reserve(exec, &sort->bands, (size_t)sum, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->band_faces = (uint32_t*)sort->bands.data;
  for (size_t b = 0; b < bands; ++b)
  {
    job->band_starts[b + 2] += job->band_starts[b + 1];
  }
  for (size_t i = 0; i < job->face_count; ++i)
  {
    for (int b = job->boxes[i].y[0] / BAND;
         job->boxes[i].y[0] <= job->boxes[i].y[1] && b <= job->boxes[i].y[1] / BAND; ++b)
    {
      job->band_faces[job->band_starts[b + 1]++] = (uint32_t)i;
    }
  }
  return CHI_OK;
}

chi_status chi_order_exterior_find(const chi_exec* exec, chi_order_sort* sort,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const chi_order_eye* eye)
{
  const double* const m = eye->to_eye;
  exterior_job job = { .mesh = mesh,
    .eye = eye,
    .faces = (const uint32_t*)adjacency->exterior.data,
    .face_count = adjacency->exterior_count,
    .sense = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
      m[2] * (m[4] * m[9] - m[5] * m[8]),
    .window = chi_order_window_of(eye) };
  const size_t pixels = (size_t)job.window.size[0] * (size_t)job.window.size[1];
  const size_t bands = ((size_t)job.window.size[1] + BAND - 1) / BAND;
  if (!chi_buffer_reserve(exec, &sort->boxes, job.face_count, sizeof(chi_order_box)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job.boxes = (chi_order_box*)sort->boxes.data;
  chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, find_boxes, &job);
  status = status == CHI_OK ? deal(exec, sort, &job, bands) : status;
  status = status == CHI_OK ? chi_for(exec, bands, draw_bands, &job) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  uint64_t sum = 0;
  for (size_t p = 0; p < pixels; ++p)
  {
    const uint32_t count = job.counts[p];
    job.counts[p] = (uint32_t)sum;
    sum += count;
    if (sum > UINT32_MAX)
    {
      return CHI_ERROR_TOO_LARGE;
    }
  }
  if (!chi_buffer_reserve(exec, &sort->events, (size_t)sum, sizeof(event)) ||
    !chi_buffer_reserve(exec, &sort->found, (size_t)sum, sizeof(chi_order_relation)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  sort->relation_count = 0;
  job.events = (event*)sort->events.data;
  job.found = (chi_order_relation*)sort->found.data;
  if (sum == 0)
  {
    return CHI_OK;
  }
  status = chi_for(exec, bands, draw_bands, &job);
  status = status == CHI_OK ? chi_for(exec, bands, relate_bands, &job) : status;
  for (size_t band = 0; band < bands && status == CHI_OK; ++band)
  {
    const size_t first = band * BAND * (size_t)job.window.size[0];
    const uint32_t start = first ? job.counts[first - 1] : 0;
    memmove(job.found + sort->relation_count, job.found + start,
      job.found_counts[band] * sizeof(chi_order_relation));
    sort->relation_count += job.found_counts[band];
  }
  return status;
}
