/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The cells of a planned tube: strips or triangles of its bands and caps, outward everywhere. */

#include "chi_tube_internal.h"

typedef struct cell_writer
{
  const chi_tube_outputs* out;
  size_t cell, entry;
  int64_t line;
} cell_writer;

static void end_cell(cell_writer* w)
{
  if (w->out->offsets)
  {
    w->out->offsets[w->cell + 1] = (int64_t)w->entry;
  }
  if (w->out->line_ids)
  {
    w->out->line_ids[w->cell] = w->line;
  }
  ++w->cell;
}

static void put(cell_writer* w, size_t vertex)
{
  w->out->connectivity[w->entry++] = (int64_t)vertex;
}

static void put_triangle(cell_writer* w, size_t a, size_t b, size_t c)
{
  put(w, a);
  put(w, b);
  put(w, c);
  end_cell(w);
}

/* A band between two rows of vertices around, `upper` towards the curve's end; a row of one vertex
 * is a pole. */
static void put_band(cell_writer* w, const chi_tube* t, size_t lower, size_t lower_count,
  size_t upper, size_t upper_count)
{
  const size_t n = (size_t)t->sides;
  for (size_t j = 0; j < n; ++j)
  {
    const size_t a = lower + (lower_count > 1 ? j : 0), c = upper + (upper_count > 1 ? j : 0);
    const size_t next = (j + 1) % n;
    const size_t b = lower + (lower_count > 1 ? next : 0), d = upper + (upper_count > 1 ? next : 0);
    if (t->cells == CHI_TUBE_TRIANGLES)
    {
      if (lower_count > 1)
      {
        put_triangle(w, a, b, c);
      }
      if (upper_count > 1)
      {
        put_triangle(w, b, d, c);
      }
      continue;
    }
    if (j == 0)
    {
      put(w, c);
      put(w, a);
    }
    put(w, d);
    put(w, b);
    if (j + 1 == n)
    {
      end_cell(w);
    }
  }
}

static void put_flat_cap(cell_writer* w, const chi_tube* t, size_t first, int end)
{
  const size_t n = (size_t)t->sides;
  if (t->cells == CHI_TUBE_TRIANGLES)
  {
    for (size_t j = 1; j + 1 < n; ++j)
    {
      put_triangle(w, first, first + (end ? j : j + 1), first + (end ? j + 1 : j));
    }
    return;
  }
  put(w, first);
  for (size_t k = 1; k < n; ++k)
  {
    const size_t step = (k + 1) / 2;
    const int from_front = (k & 1) == (size_t)(end != 0);
    put(w, first + (from_front ? step : n - step));
  }
  end_cell(w);
}

static void put_round_cap(cell_writer* w, const chi_tube* t, size_t rim, size_t first, int end)
{
  const size_t n = (size_t)t->sides, latitudes = chi_tube_latitudes(t->sides);
  for (size_t l = 0; l <= latitudes; ++l)
  {
    const size_t inner = l == 0 ? rim : first + (l - 1) * n;
    const size_t outer = first + l * n, outer_count = l < latitudes ? n : 1;
    if (end)
    {
      put_band(w, t, inner, n, outer, outer_count);
    }
    else
    {
      put_band(w, t, outer, outer_count, inner, n);
    }
  }
}

void chi_tube_write_cells(const chi_tube* t, const chi_tube_outputs* out, size_t i)
{
  const chi_tube_line* const line = &t->line[i];
  const size_t n = (size_t)t->sides, rings = line->ring_count, first = line->point_start;
  chi_spline_curve c;
  chi_spline_get_curve(t->spline, i, &c);
  const size_t own = c.closed ? rings - 1 : rings;
  cell_writer w = { out, line->cell_start, line->connectivity_start, (int64_t)i };
  for (size_t j = 0; j < n; ++j)
  {
    const size_t a = first + j, b = first + (j + 1) % n;
    if (t->cells == CHI_TUBE_STRIPS)
    {
      int64_t* const strip = out->connectivity + w.entry;
      for (size_t k = 0; k < own; ++k)
      {
        strip[2 * k] = (int64_t)(a + k * n);
        strip[2 * k + 1] = (int64_t)(b + k * n);
      }
      if (c.closed)
      {
        strip[2 * own] = (int64_t)a;
        strip[2 * own + 1] = (int64_t)b;
      }
      w.entry += 2 * rings;
      end_cell(&w);
      continue;
    }
    for (size_t k = 0; k + 1 < rings; ++k)
    {
      const size_t here = k * n, there = (k + 1 < own ? k + 1 : 0) * n;
      put_triangle(&w, a + here, b + here, a + there);
      put_triangle(&w, b + here, b + there, a + there);
    }
  }
  if (c.closed || t->cap == CHI_TUBE_CAP_NONE)
  {
    return;
  }
  const size_t cap = first + own * n, points = chi_tube_cap_points(t);
  for (int end = 0; end < 2; ++end)
  {
    const size_t at = cap + (end ? points : 0);
    if (t->cap == CHI_TUBE_CAP_FLAT)
    {
      put_flat_cap(&w, t, at, end);
    }
    else
    {
      put_round_cap(&w, t, end ? first + (own - 1) * n : first, at, end);
    }
  }
}
