/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_preintegration_internal.h"
#include "simd/chi_segment_kernels.h"

#include <math.h>

enum
{
  FULL_SCALARS = 128, /* entries of the full table each way by default: 8 MiB; */
  FULL_DEPTHS = 32,   /* theory/preintegration.md has the errors of other sizes */
  MOST_FULL = 1 << 22
};

/* What the tables were made of. */
typedef struct sources
{
  chi_transfer_view transfer; /* its pointers are not looked at again */
  chi_preintegration_params params;
} sources;

struct chi_preintegration
{
  chi_segment_tables tables; /* count 0: none */
  sources sources;
  float (*entries)[4]; /* color, then depth: [2 x (room + 1)] */
  size_t room;
  float (*psi)[CHI_PSI_SIZE]; /* made once */
  float (*full)[4];           /* [full_room] */
  size_t full_room;
  uint64_t version;
};

void chi_preintegration_default_params(chi_preintegration_params* params)
{
  *params = (chi_preintegration_params){ .struct_size = sizeof *params };
}

chi_status chi_preintegration_create(const chi_exec* exec, chi_preintegration** preintegration)
{
  if (!preintegration)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *preintegration = (chi_preintegration*)chi_alloc(exec, 1, sizeof **preintegration);
  if (!*preintegration)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*preintegration, 0, sizeof **preintegration);
  return CHI_OK;
}

static void release_entries(const chi_exec* exec, chi_preintegration* p)
{
  if (p->entries)
  {
    chi_free(exec, p->entries, 2 * (p->room + 1), sizeof *p->entries);
  }
  p->entries = NULL;
  p->room = 0;
}

static void release_full(const chi_exec* exec, chi_preintegration* p)
{
  if (p->full)
  {
    chi_free(exec, p->full, p->full_room, sizeof *p->full);
  }
  p->full = NULL;
  p->full_room = 0;
}

void chi_preintegration_destroy(const chi_exec* exec, chi_preintegration* p)
{
  if (!p)
  {
    return;
  }
  release_entries(exec, p);
  if (p->psi)
  {
    chi_free(exec, p->psi, CHI_PSI_SIZE, sizeof *p->psi);
  }
  release_full(exec, p);
  chi_free(exec, p, 1, sizeof *p);
}

/* The largest extinction that is accepted, world^-1: 65536 entries of it, over a length of as much,
 * are a float still. */
static const double most_extinction = 1e16;

static double extinction(double opacity, const sources* s)
{
  const double alpha = opacity > 0 ? fmin(opacity, 1) : 0;
  return (s->params.opacity_convention == CHI_OPACITY_IMAGE ? -log1p(-fmin(alpha, 1 - 1e-6))
                                                            : alpha) /
    s->transfer.unit_distance;
}

static int is_valid(const sources* s)
{
  static const float black[3] = { 0, 0, 0 };
  const chi_transfer_view* const t = &s->transfer;
  const chi_preintegration_params* const p = &s->params;
  if ((!t->rgb && !p->direct_color) || !t->opacity || t->plane || t->table_count > 1 ||
    t->count < 2 || t->count > 65536 || !(t->range[0] < t->range[1]) ||
    !isfinite(t->range[1] - t->range[0]) || !(t->unit_distance > 0) ||
    !isfinite(t->unit_distance) || p->method < CHI_PREINTEGRATION_AUTO ||
    p->method > CHI_PREINTEGRATION_FULL || p->opacity_convention < CHI_OPACITY_LINEAR ||
    p->opacity_convention > CHI_OPACITY_IMAGE || !(p->longest_segment >= 0) ||
    p->full_scalars < 4 || p->full_scalars > 512 || p->full_depths < 4 || p->full_depths > 64 ||
    p->full_scalars * p->full_scalars > MOST_FULL / p->full_depths ||
    !isfinite(p->longest_segment) || !(p->segment_range >= 0) || !isfinite(p->segment_range))
  {
    return 0;
  }
  for (size_t i = 0; i < t->count; ++i)
  {
    const float* const c = p->direct_color ? black : t->rgb + 3 * i;
    if (!isfinite(c[0]) || !isfinite(c[1]) || !isfinite(c[2]) || !isfinite(t->opacity[i]) ||
      extinction((double)t->opacity[i], s) > most_extinction)
    {
      return 0;
    }
  }
  return 1;
}

/* Whether the tables that stand are those of these sources. */
static int is_same(const sources* a, const sources* b)
{
  const chi_transfer_view *const s = &a->transfer, *const t = &b->transfer;
  return s->version == t->version && s->count == t->count && s->range[0] == t->range[0] &&
    s->range[1] == t->range[1] && s->unit_distance == t->unit_distance && s->rgb == t->rgb &&
    s->opacity == t->opacity && memcmp(&a->params, &b->params, sizeof a->params) == 0;
}

/* Larger part first: differences of such sums lose nothing. */
static void split(double sum, float parts[2])
{
  parts[0] = (float)sum;
  parts[1] = (float)(sum - (double)parts[0]);
}

static void fill_entries(chi_preintegration* p, const sources* s)
{
  const size_t n = s->transfer.count;
  float(*const color)[4] = p->entries, (*const depth)[4] = p->entries + n + 1;
  double sum = 0;
  for (size_t i = 0; i <= n; ++i)
  {
    const size_t from = i < n ? i : n - 1;
    for (int c = 0; c < 3; ++c)
    {
      /* of direct colours: the entry's own place */
      color[i][c] = !s->params.direct_color
        ? fminf(fmaxf(s->transfer.rgb[3 * from + (size_t)c], 0), 1)
        : c == 0 ? (float)from / (float)(n - 1)
                 : 0;
    }
    color[i][3] = depth[i][0] = (float)extinction((double)s->transfer.opacity[from], s);
    sum += i > 0 && i < n ? 0.5 * ((double)color[i - 1][3] + (double)color[i][3]) : 0;
    split(sum, depth[i] + 1);
    depth[i][3] = 0;
  }
}

static void fill_psi(float (*psi)[CHI_PSI_SIZE])
{
  for (int i = 0; i < CHI_PSI_SIZE; ++i)
  {
    for (int j = 0; j < CHI_PSI_SIZE; ++j)
    {
      const double end = CHI_PSI_SIZE - 1; /* gamma / (1 - gamma) */
      psi[i][j] = (float)chi_psi(j / (end - j), i / (end - i));
    }
  }
}

/* Room for the 1-D tables and psi, which is filled. */
static int make_room(const chi_exec* exec, chi_preintegration* p, size_t count)
{
  if (count > p->room)
  {
    release_entries(exec, p);
    p->entries = (float(*)[4])chi_alloc(exec, 2 * (count + 1), sizeof *p->entries);
    p->room = p->entries ? count : 0;
  }
  if (p->entries && !p->psi)
  {
    p->psi = (float(*)[CHI_PSI_SIZE])chi_alloc(exec, CHI_PSI_SIZE, sizeof *p->psi);
    if (p->psi)
    {
      fill_psi(p->psi);
    }
  }
  return p->entries && p->psi;
}

/* Integral of colour x extinction, and of extinction, from the first entry to place x; `sums` holds
 * those to each entry. */
static void sum_to(const chi_segment_tables* t, double (*const sums)[4], double x, double sum[4])
{
  const double entry = floor(x);
  memcpy(sum, sums[(size_t)entry], sizeof *sums);
  chi_integrate_entries(t->color, t->count, entry, x, sum);
}

/* What a segment from place a to b adds to a pixel, without attenuation, less what partial
 * pre-integration takes for it; the largest of its colours and optical depth. */
static double linear_error(const chi_segment_tables* t, double (*const sums)[4], int direct,
  double a, double b, double length)
{
  double front[4], back[4], before[4], sum[4], linear[4] = { 0 }, error = 0;
  chi_classify_at(t->color, t->count, a, front);
  chi_classify_at(t->color, t->count, b, back);
  chi_add_products(front, back, b - a, linear);
  sum_to(t, sums, a, before);
  sum_to(t, sums, b, sum);
  for (int c = 0; c < 4; ++c)
  {
    sum[c] -= before[c];
    error = fmax(error, fabs(sum[c] - linear[c]));
  }
  if (direct) /* red is the place in the table: in the segment, it is a colour that goes from 0 to 1
               */
  {
    const double end = t->count - 1;
    const double off = end * (sum[0] - linear[0]) - a * (sum[3] - linear[3]);
    error = fmax(error, fabs(off) / (b - a));
  }
  /* Of what is thick, only so much is seen. */
  const double thick = 1 + fmin(sum[3], linear[3]) * length / (b - a);
  return error * length / (b - a) / thick;
}

/* Whether segments of at most that range and length may be taken as linear: the error of one of the
 * longest is 1/510 at most. Those from and to every entry are looked at, and shorter ones, because
 * what bends up and down again may cancel. */
static int is_linear(const chi_segment_tables* t, double (*const sums)[4], const sources* s)
{
  const int direct = s->params.direct_color;
  const double end = t->count - 1, most = 0.5 / 255;
  const double range =
    s->params.segment_range > 0 ? s->params.segment_range / (t->range[1] - t->range[0]) * end : end;
  const double length =
    s->params.longest_segment > 0 ? s->params.longest_segment : s->transfer.unit_distance;
  memset(sums[0], 0, sizeof sums[0]);
  for (int i = 1; i < t->count; ++i)
  {
    memcpy(sums[i], sums[i - 1], sizeof sums[i]);
    chi_integrate_entries(t->color, t->count, i - 1, i, sums[i]);
  }
  for (double share = 1; share > 0.2; share *= 0.5)
  {
    const double way = fmin(range, end) * share;
    for (int i = 0; i < t->count; ++i)
    {
      const double up = fmin(i + way, end), down = fmax(i - way, 0);
      if ((up > i && linear_error(t, sums, direct, i, up, length * share) > most) ||
        (down < i && linear_error(t, sums, direct, down, i, length * share) > most) ||
        (up > down &&
          linear_error(t, sums, direct, 0.5 * (down + i), 0.5 * (up + i), length * share) > most))
      {
        return 0;
      }
    }
  }
  return 1;
}

/* AUTO's choice. */
static chi_status choose_method(const chi_exec* exec, chi_segment_tables* t, const sources* s)
{
  const size_t count = (size_t)t->count;
  double(*const sums)[4] = (double(*)[4])chi_alloc(exec, count, sizeof *sums);
  if (!sums)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  t->method = is_linear(t, sums, s) ? CHI_PREINTEGRATION_PARTIAL : CHI_PREINTEGRATION_FULL;
  chi_free(exec, sums, count, sizeof *sums);
  return CHI_OK;
}

static chi_status fill_full(
  const chi_exec* exec, chi_preintegration* p, chi_segment_tables* t, const sources* s)
{
  t->full_size[0] = t->full_size[1] = s->params.full_scalars;
  t->full_size[2] = s->params.full_depths;
  const size_t n = (size_t)t->count;
  const size_t size = (size_t)t->full_size[0] * (size_t)t->full_size[1] * (size_t)t->full_size[2];
  if (size != p->full_room)
  {
    release_full(exec, p);
    p->full = (float(*)[4])chi_alloc(exec, size, sizeof *p->full);
    if (!p->full)
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    p->full_room = size;
  }
  t->full = (const float(*)[4])p->full;
  const chi_status status =
    chi_fill_full(exec, t->color, p->entries + n + 1, n, t->full_size, p->full);
  if (status == CHI_OK && s->params.direct_color)
  {
    chi_center_full(t->depth, n, t->full_size, p->full);
  }
  return status;
}

chi_status chi_preintegration_update(const chi_exec* exec, chi_preintegration* p,
  const chi_transfer_view* transfer, const chi_preintegration_params* params)
{
  sources now;
  memset(&now, 0, sizeof now);
  chi_preintegration_default_params(&now.params);
  if (!p || !transfer || !CHI_ADOPT(chi_transfer_view, version, &now.transfer, transfer) ||
    (params && !CHI_ADOPT(chi_preintegration_params, full_depths, &now.params, params)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  now.params.full_scalars = now.params.full_scalars ? now.params.full_scalars : FULL_SCALARS;
  now.params.full_depths = now.params.full_depths ? now.params.full_depths : FULL_DEPTHS;
  now.params.direct_color = now.params.direct_color != 0;
  if (!is_valid(&now))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  now.transfer.rgb = now.params.direct_color ? NULL : now.transfer.rgb;
  if (p->tables.count && is_same(&now, &p->sources))
  {
    return CHI_OK;
  }
  memset(&p->tables, 0, sizeof p->tables);
  const size_t count = now.transfer.count;
  if (!make_room(exec, p, count))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  fill_entries(p, &now);
  chi_segment_tables t = { .struct_size = sizeof t,
    .method = now.params.method,
    .count = (int32_t)count,
    .range = { now.transfer.range[0], now.transfer.range[1] },
    .color = (const float(*)[4])p->entries,
    .depth = (const float(*)[4])p->entries + count + 1,
    .psi = p->psi[0] };
  chi_status status = t.method == CHI_PREINTEGRATION_AUTO ? choose_method(exec, &t, &now) : CHI_OK;
  if (status == CHI_OK && t.method == CHI_PREINTEGRATION_FULL)
  {
    status = fill_full(exec, p, &t, &now);
  }
  if (status == CHI_OK)
  {
    t.version = ++p->version;
    p->tables = t;
    p->sources = now;
  }
  return status;
}

void chi_preintegration_get_tables(const chi_preintegration* p, chi_segment_tables* tables)
{
  *tables = p->tables;
}

chi_status chi_segment_evaluate(const chi_segment_tables* tables, size_t count, const float* x0,
  const float* x1, const float* length, float* rgba)
{
  if (!tables || (count > 0 && (!x0 || !x1 || !length || !rgba)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (tables->count == 0)
  {
    return CHI_ERROR_NOT_READY;
  }
  if (tables->method < CHI_PREINTEGRATION_NONE || tables->method > CHI_PREINTEGRATION_FULL)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_segment_get_kernels()->evaluate(tables, count, x0, x1, length, rgba);
  return CHI_OK;
}
