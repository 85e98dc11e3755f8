/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_internal.h"

#include <math.h>

chi_status chi_tet_mesh_build(const chi_exec* exec, chi_tet_mesh* mesh, const chi_grid_view* grid)
{
  mesh->counts = (chi_grid_counts){ .struct_size = sizeof mesh->counts };
  chi_status status = chi_grid_count(exec, grid, &mesh->counts);
  if (status != CHI_OK)
  {
    return status;
  }
  const chi_grid_counts* const n = &mesh->counts;
  const int has_points = grid->kind == CHI_GRID_UNSTRUCTURED || grid->kind == CHI_GRID_CURVILINEAR;
  const int borrow = has_points && n->extra_points == 0;
  const int identity = n->single_cells == n->cells; /* tetrahedron i is cell i */
  mesh->point_count = n->points + n->extra_points;
  if (n->tetrahedra > UINT32_MAX - 1 ||
    !chi_buffer_reserve(exec, &mesh->vertices, n->tetrahedra, 4 * sizeof(uint32_t)) ||
    (!identity && !chi_buffer_reserve(exec, &mesh->cells, n->tetrahedra, sizeof(uint32_t))) ||
    !chi_buffer_reserve(exec, &mesh->extra_cells, n->extra_points, sizeof(uint32_t)) ||
    (!borrow && !chi_buffer_reserve(exec, &mesh->points, mesh->point_count, 3 * sizeof(double))))
  {
    return n->tetrahedra > UINT32_MAX - 1 ? CHI_ERROR_TOO_LARGE : CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_grid_tetrahedra out = { .struct_size = sizeof out,
    .vertices = (uint32_t*)mesh->vertices.data,
    .cells = identity ? NULL : (uint32_t*)mesh->cells.data,
    .points = borrow ? NULL : (double*)mesh->points.data,
    .extra_cells = (uint32_t*)mesh->extra_cells.data };
  status = chi_grid_split(exec, grid, n, &out);
  mesh->cell_of = out.cells;
  mesh->all_points = borrow
    ? grid->points
    : (chi_vec3_view){ mesh->points.data, mesh->point_count, 3 * sizeof(double), CHI_F64 };
  return status;
}

size_t chi_tet_cells_of(const chi_tet_mesh* mesh)
{
  const chi_grid_counts* const n = &mesh->counts;
  const size_t cells = n->cells - n->ghost_cells - n->blanked_cells - n->lower_dimensional_cells -
    n->unsupported_cells - n->non_finite_cells;
  return cells ? cells : 1;
}

void chi_tet_mesh_free(const chi_exec* exec, chi_tet_mesh* mesh)
{
  chi_buffer_free(exec, &mesh->vertices);
  chi_buffer_free(exec, &mesh->cells);
  chi_buffer_free(exec, &mesh->extra_cells);
  chi_buffer_free(exec, &mesh->points);
}

/*------------------------------------------------------------------------------------------------*/
/* What no segment of a ray exceeds: the longest edge, and the widest range of a tetrahedron. */
typedef struct measure
{
  const chi_tet_mesh* mesh;
  const float* scalars; /* of points; NULL: of cells, which have no range */
  size_t chunk;
  double (*most)[2]; /* [chunks] square of the edge, range */
} measure;

static void measure_chunk(void* data, size_t begin, size_t end)
{
  const measure* const m = (const measure*)data;
  const size_t count = m->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    double longest = 0, widest = 0;
    for (size_t t = chunk * m->chunk; t < count && t < (chunk + 1) * m->chunk; ++t)
    {
      const uint32_t* const v = (const uint32_t*)m->mesh->vertices.data + 4 * t;
      double p[4][3];
      for (int i = 0; i < 4; ++i)
      {
        chi_view_get(&m->mesh->all_points, v[i], p[i]);
        for (int j = 0; j < i; ++j)
        {
          const double d[3] = { p[i][0] - p[j][0], p[i][1] - p[j][1], p[i][2] - p[j][2] };
          const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
          const double range = m->scalars ? fabs((double)m->scalars[v[i]] - m->scalars[v[j]]) : 0;
          longest = square > longest ? square : longest;
          widest = range > widest && range < INFINITY ? range : widest;
        }
      }
    }
    m->most[chunk][0] = longest;
    m->most[chunk][1] = widest;
  }
}

static chi_status measure_all(
  const chi_exec* exec, chi_tet_values* values, const chi_tet_mesh* mesh)
{
  double most[CHI_TET_CHUNKS][2] = { { 0 } };
  measure m = { mesh, values->is_cell_data ? NULL : (const float*)values->scalars.data,
    (mesh->counts.tetrahedra + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS, most };
  const chi_status status = chi_for(exec, CHI_TET_CHUNKS, measure_chunk, &m);
  values->longest_edge = values->widest_range = 0;
  for (int i = 0; i < CHI_TET_CHUNKS; ++i)
  {
    values->longest_edge = fmax(values->longest_edge, sqrt(most[i][0]));
    values->widest_range = fmax(values->widest_range, most[i][1]);
  }
  return status;
}

chi_status chi_tet_values_build(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_grid_view* grid, const chi_tet_field* field, int by_plane)
{
  const chi_array_view* const other = by_plane ? field->second : field->opacity;
  values->is_cell_data = field->is_cell_data != 0;
  values->by_plane = by_plane;
  values->by_gradient = by_plane && !other;
  values->separate = other || by_plane;
  values->all_opaque = 0;
  const size_t count = values->is_cell_data ? mesh->counts.cells : mesh->point_count;
  const size_t extra = values->is_cell_data ? 0 : mesh->counts.extra_points;
  for (int q = 0; q <= (other != NULL); ++q)
  {
    chi_buffer* const buffer = q ? &values->opacities : &values->scalars;
    const chi_array_view* const array = q ? other : field->scalars;
    if (array->count != count - extra)
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    if (!chi_buffer_reserve(exec, buffer, count, sizeof(float)))
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    const chi_status status = chi_grid_scalars(exec, grid, array,
      !q           ? field->component
        : by_plane ? field->second_component
                   : field->opacity_component,
      (const uint32_t*)mesh->extra_cells.data, extra, (float*)buffer->data);
    if (status != CHI_OK)
    {
      return status;
    }
  }
  chi_status status = chi_tet_colors_build(exec, values, mesh, grid, field);
  if (values->by_gradient && status == CHI_OK)
  {
    status = chi_tet_gradients_build(exec, values, mesh);
  }
  return status == CHI_OK ? measure_all(exec, values, mesh) : status;
}

typedef struct choice
{
  const chi_tet_mesh* mesh;
  const chi_tet_values* values;
  const uint32_t* opaque; /* [entries + 1] entries before that are not transparent; NULL */
  float base, scale, end;
  uint32_t* visible;
  uint32_t* before; /* [chunks x 3] non-finite, transparent, changed words */
  size_t words, words_a_chunk;
} choice;

/* The finite range of a tetrahedron's values; 0 where one is not finite. */
static int find_range(const choice* c, const float* of, size_t t, float range[2])
{
  if (c->values->is_cell_data)
  {
    range[0] = range[1] = of[c->mesh->cell_of ? c->mesh->cell_of[t] : t];
    return isfinite(range[0]);
  }
  const uint32_t* const v = (const uint32_t*)c->mesh->vertices.data + 4 * t;
  range[0] = range[1] = of[v[0]];
  int finite = isfinite(range[0]);
  for (int i = 1; i < 4; ++i)
  {
    const float s = of[v[i]];
    finite &= isfinite(s);
    range[0] = s < range[0] ? s : range[0];
    range[1] = s > range[1] ? s : range[1];
  }
  return finite;
}

static int is_transparent(const choice* c, const float range[2])
{
  float x[2];
  for (int i = 0; i < 2; ++i)
  {
    x[i] = (range[i] - c->base) * c->scale;
    x[i] = x[i] > 0 ? x[i] < c->end ? x[i] : c->end : 0;
  }
  return c->opaque[(size_t)floorf(x[0])] == c->opaque[(size_t)ceilf(x[1]) + 1];
}

static void choose(void* data, size_t begin, size_t end)
{
  const choice* const c = (const choice*)data;
  const size_t count = c->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    uint32_t non_finite = 0, transparent = 0, changed = 0;
    const size_t last = (chunk + 1) * c->words_a_chunk;
    for (size_t w = chunk * c->words_a_chunk; w < c->words && w < last; ++w)
    {
      uint32_t word = 0;
      for (size_t t = 32 * w; t < 32 * w + 32 && t < count; ++t)
      {
        float range[2], other[2] = { 0, 0 };
        const int finite = find_range(c, (const float*)c->values->scalars.data, t, range) &
          (!c->values->separate || c->values->by_gradient ||
            find_range(c, (const float*)c->values->opacities.data, t, other));
        const int clear = finite && c->opaque &&
          is_transparent(c, c->values->separate && !c->values->by_plane ? other : range);
        non_finite += !finite;
        transparent += (uint32_t)clear;
        word |= (uint32_t)(finite && !clear) << (t % 32);
      }
      changed += c->visible[w] != word;
      c->visible[w] = word;
    }
    c->before[3 * chunk] = non_finite;
    c->before[3 * chunk + 1] = transparent;
    c->before[3 * chunk + 2] = changed;
  }
}

/* The largest step from entry to entry: of a colour, or of extinction over the unit of length in
 * which it is largest 1. */
static float coarseness(const chi_segment_tables* tables)
{
  float most = 0, step[4] = { 0 };
  for (int32_t i = 0; i + 1 < tables->count; ++i)
  {
    for (int k = 0; k < 4; ++k)
    {
      step[k] = fmaxf(step[k], fabsf(tables->color[i + 1][k] - tables->color[i][k]));
    }
    most = fmaxf(most, fmaxf(tables->color[i][3], tables->color[i + 1][3]));
  }
  return fmaxf(fmaxf(step[0], step[1]), fmaxf(step[2], most > 0 ? step[3] / most : 0));
}

chi_status chi_tet_values_choose(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_segment_tables* tables, int skip_transparent)
{
  const size_t entries = (size_t)tables->count, words = (mesh->counts.tetrahedra + 31) / 32;
  const size_t had = values->visible.bytes;
  if (!chi_buffer_reserve(exec, &values->opaque, entries + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &values->extinction, entries + 1, sizeof(float)) ||
    !chi_buffer_reserve(exec, &values->visible, words + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  uint32_t* const opaque = (uint32_t*)values->opaque.data;
  opaque[0] = 0;
  for (size_t i = 0; i < entries; ++i)
  {
    opaque[i + 1] = opaque[i] + (tables->color[i][3] > 0);
  }
  for (size_t i = 0; i <= entries; ++i)
  {
    ((float*)values->extinction.data)[i] = tables->color[i][3];
  }
  values->coarseness = coarseness(tables);
  /* a table without transparent entries leaves all that is finite, as the last one may have done */
  const int any = skip_transparent && opaque[entries] < entries;
  if (!any && values->all_opaque)
  {
    return CHI_OK;
  }
  uint32_t tally[3 * CHI_TET_CHUNKS] = { 0 };
  choice c = { mesh, values, any ? opaque : NULL, (float)tables->range[0],
    (float)((double)(entries - 1) / (tables->range[1] - tables->range[0])), (float)(entries - 1),
    (uint32_t*)values->visible.data, tally, words, (words + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS };
  const chi_status status = chi_for(exec, CHI_TET_CHUNKS, choose, &c);
  values->non_finite = values->transparent = 0;
  uint64_t changed = values->visible.bytes != had;
  for (size_t i = 0; i < CHI_TET_CHUNKS; ++i)
  {
    values->non_finite += tally[3 * i];
    values->transparent += tally[3 * i + 1];
    changed |= tally[3 * i + 2];
  }
  values->version += changed != 0;
  values->all_opaque = !any && status == CHI_OK;
  return status;
}

void chi_tet_values_free(const chi_exec* exec, chi_tet_values* values)
{
  chi_buffer_free(exec, &values->scalars);
  chi_buffer_free(exec, &values->opacities);
  chi_buffer_free(exec, &values->colors);
  chi_buffer_free(exec, &values->gradients);
  chi_buffer_free(exec, &values->visible);
  chi_buffer_free(exec, &values->opaque);
  chi_buffer_free(exec, &values->extinction);
}
