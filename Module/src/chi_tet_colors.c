/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Colours that are given, not looked up: three floats a point, or a cell, from 0 to 1. */

#include "chi_tet_internal.h"

typedef struct color_job
{
  const float* from;
  float* to;
  double zero, scale;
  size_t count, chunk;
} color_job;

static void bring_to_range(void* data, size_t begin, size_t end)
{
  const color_job* const it = (const color_job*)data;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    for (size_t i = chunk * it->chunk; i < it->count && i < (chunk + 1) * it->chunk; ++i)
    {
      const double c = ((double)it->from[i] - it->zero) * it->scale;
      it->to[3 * i] = c > 0 ? c < 1 ? (float)c : 1 : 0; /* NaN: 0 */
    }
  }
}

chi_status chi_tet_colors_build(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_grid_view* grid, const chi_tet_field* field)
{
  values->direct = field->colors != NULL;
  if (!values->direct)
  {
    chi_buffer_free(exec, &values->colors);
    return CHI_OK;
  }
  const size_t count = values->is_cell_data ? mesh->counts.cells : mesh->point_count;
  const size_t extra = values->is_cell_data ? 0 : mesh->counts.extra_points;
  const double* const range = field->color_range;
  const int given = range[0] != 0 || range[1] != 0;
  if (field->colors->count != count - extra)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  /* there are no opacities beside direct colours: their room is free meanwhile */
  if (!chi_buffer_reserve(exec, &values->colors, count, 3 * sizeof(float)) ||
    !chi_buffer_reserve(exec, &values->opacities, count, sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_status status = CHI_OK;
  for (int c = 0; c < 3 && status == CHI_OK; ++c)
  {
    color_job job = { (const float*)values->opacities.data, (float*)values->colors.data + c,
      given ? range[0] : 0, given ? 1 / (range[1] - range[0]) : 1, count,
      (count + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS };
    status = chi_grid_scalars(exec, grid, field->colors, field->color_component + c,
      (const uint32_t*)mesh->extra_cells.data, extra, (float*)values->opacities.data);
    status = status == CHI_OK ? chi_for(exec, CHI_TET_CHUNKS, bring_to_range, &job) : status;
  }
  chi_buffer_free(exec, &values->opacities);
  return status;
}
