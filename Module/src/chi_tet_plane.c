/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Transfer functions of two quantities for tetrahedra: their tables, and the gradient where that is
 * the second one. */

#include "chi_tet_internal.h"

#include "chi_occlusion_internal.h" /* what the table is between its entries */

#include <math.h>

static double extinction_of(double opacity, int32_t convention, double unit)
{
  return (convention == CHI_OPACITY_IMAGE ? -log1p(-fmin(opacity, 1 - 1e-6)) : opacity) / unit;
}

static void fill_table(chi_tet_plane* p, const chi_transfer_view* t, int32_t convention)
{
  size_t parts[2];
  chi_transfer_plane_parts(t, parts);
  float(*entry)[4] = (float(*)[4])p->entries.data;
  float *const opacity = (float*)p->bound.data, *const white = opacity + p->columns;
  for (size_t i = 0; i < p->columns; ++i)
  {
    opacity[i] = 0;
    white[3 * i] = white[3 * i + 1] = white[3 * i + 2] = 1;
  }
  for (size_t j = 0; j < p->rows; ++j)
  {
    for (size_t i = 0; i < p->columns; ++i, ++entry)
    {
      const double x = (double)i / (double)parts[0], y = (double)j / (double)parts[1];
      const double alpha = chi_transfer_plane_value(t, x, y, 3);
      for (int c = 0; c < 3; ++c)
      {
        entry[0][c] = (float)chi_transfer_plane_value(t, x, y, c);
      }
      entry[0][3] = (float)extinction_of(alpha, convention, t->unit_distance);
      opacity[i] = fmaxf(opacity[i], (float)alpha);
    }
    memcpy(entry, entry - 1, sizeof *entry); /* the last one again */
    ++entry;
  }
}

chi_status chi_tet_plane_build(const chi_exec* exec, chi_tet_plane* p, const chi_transfer_view* t,
  int32_t convention, chi_transfer_view* bound)
{
  if (!chi_transfer_plane_is_valid(t) || t->table_count > 1 || !(t->unit_distance > 0) ||
    !isfinite(t->unit_distance) || !(t->range[0] < t->range[1]) ||
    !isfinite(t->range[1] - t->range[0]))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_tet_plane_key key;
  memset(&key, 0, sizeof key);
  key.table = t->plane;
  key.version = t->version;
  memcpy(key.count, t->plane_count, sizeof key.count);
  memcpy(key.range, t->range, sizeof key.range);
  memcpy(key.plane_range, t->plane_range, sizeof key.plane_range);
  key.unit_distance = t->unit_distance;
  key.convention = convention;
  if (!p->columns || memcmp(&key, &p->key, sizeof key) != 0)
  {
    size_t parts[2];
    chi_transfer_plane_parts(t, parts);
    p->columns = (t->plane_count[0] - 1) * parts[0] + 1;
    p->rows = (t->plane_count[1] - 1) * parts[1] + 1;
    const size_t entries = (p->columns + 1) * p->rows;
    const size_t columns = p->columns;
    p->columns = 0;
    if (!chi_buffer_reserve(exec, &p->entries, entries, 4 * sizeof(float)) ||
      !chi_buffer_reserve(exec, &p->bound, 4 * columns, sizeof(float)))
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    p->columns = columns;
    fill_table(p, t, convention);
    p->key = key;
    ++p->version;
  }
  *bound = *t;
  bound->plane = NULL;
  bound->gradient_opacity = NULL;
  bound->opacity = (const float*)p->bound.data;
  bound->rgb = bound->opacity + p->columns;
  bound->count = p->columns;
  bound->version = p->version;
  return CHI_OK;
}

void chi_tet_plane_free(const chi_exec* exec, chi_tet_plane* p)
{
  chi_buffer_free(exec, &p->entries);
  chi_buffer_free(exec, &p->bound);
  p->columns = 0; /* versions go on */
}

/*------------------------------------------------------------------------------------------------*/
typedef struct gradient_job
{
  const chi_tet_mesh* mesh;
  const float* scalars;
  double edge;
  size_t chunk;
  float* out;
} gradient_job;

/* Of a linear field: its differences along three edges in the dual basis. */
static double gradient_of(const double e[3][3], const double d[3])
{
  double g[3] = { 0 }, det = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double *const a = e[(k + 1) % 3], *const b = e[(k + 2) % 3];
    const double n[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
      a[0] * b[1] - a[1] * b[0] };
    det = e[k][0] * n[0] + e[k][1] * n[1] + e[k][2] * n[2];
    for (int i = 0; i < 3; ++i)
    {
      g[i] += d[k] * n[i];
    }
  }
  const double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / fabs(det);
  return isfinite(length) ? length : 0; /* flat: nothing is drawn */
}

static void find_gradients(void* data, size_t begin, size_t end)
{
  const gradient_job* const it = (const gradient_job*)data;
  const size_t count = it->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    for (size_t t = chunk * it->chunk; t < count && t < (chunk + 1) * it->chunk; ++t)
    {
      const uint32_t* const v = (const uint32_t*)it->mesh->vertices.data + 4 * t;
      double p[3], e[3][3], d[3];
      chi_view_get(&it->mesh->all_points, v[0], p);
      for (int k = 0; k < 3; ++k)
      {
        chi_view_get(&it->mesh->all_points, v[k + 1], e[k]);
        for (int i = 0; i < 3; ++i)
        {
          e[k][i] -= p[i];
        }
        d[k] = (double)it->scalars[v[k + 1]] - (double)it->scalars[v[0]];
      }
      it->out[t] = (float)(gradient_of((const double(*)[3])e, d) * it->edge);
    }
  }
}

chi_status chi_tet_gradients_build(
  const chi_exec* exec, chi_tet_values* values, const chi_tet_mesh* mesh)
{
  const size_t count = mesh->counts.tetrahedra;
  if (!chi_buffer_reserve(exec, &values->gradients, count + 1, sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  float* const out = (float*)values->gradients.data;
  if (values->is_cell_data) /* constant in each */
  {
    memset(out, 0, count * sizeof *out);
    return CHI_OK;
  }
  gradient_job job = { mesh, (const float*)values->scalars.data,
    cbrt(mesh->counts.volume / (double)chi_tet_cells_of(mesh)),
    (count + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS, out };
  return chi_for(exec, CHI_TET_CHUNKS, find_gradients, &job);
}
