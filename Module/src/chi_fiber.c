/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The handle of fiber surfaces, what it keeps, and the order of the steps. */

#include "chi_fiber_internal.h"

#include <math.h>

chi_status chi_fiber_create(const chi_exec* exec, chi_fiber** fiber)
{
  if (!fiber)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *fiber = (chi_fiber*)chi_alloc(exec, 1, sizeof **fiber);
  if (!*fiber)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*fiber, 0, sizeof **fiber);
  (*fiber)->sizes.first_bad_cell = -1;
  return CHI_OK;
}

void chi_fiber_destroy(const chi_exec* exec, chi_fiber* fiber)
{
  if (fiber)
  {
    chi_fiber_polygon_free(exec, &fiber->polygon);
    chi_fiber_polygon_free(exec, &fiber->next);
    chi_fiber_index_free(exec, &fiber->index);
    chi_fiber_pairs_free(exec, &fiber->pairs);
    chi_fiber_parts_free(exec, &fiber->parts);
    chi_fiber_components_free(exec, &fiber->components);
    chi_fiber_enclosed_free(exec, &fiber->enclosed);
    chi_free(exec, fiber, 1, sizeof *fiber);
  }
}

static int same_segment(const chi_fiber_segment* a, const chi_fiber_segment* b)
{
  return memcmp(a->p, b->p, sizeof a->p) == 0 && memcmp(a->q, b->q, sizeof a->q) == 0 &&
    a->corner[0] == b->corner[0] && a->corner[1] == b->corner[1] && a->id == b->id &&
    a->side == b->side && a->is_closed == b->is_closed;
}

static int same_polygon(const chi_fiber_polygon* a, const chi_fiber_polygon* b)
{
  int same = a->count == b->count && a->empty == b->empty;
  for (size_t i = 0; same && i < a->count; ++i)
  {
    same = same_segment(a->segment + i, b->segment + i);
  }
  return same;
}

static int fields_are_valid(const chi_fiber_params* p)
{
  for (int k = 0; k < 2; ++k)
  {
    if (!chi_array_is_valid(p->fields[k]) || p->components[k] < -1 ||
      (p->components[k] >= 0 && (size_t)p->components[k] >= p->fields[k]->components))
    {
      return 0;
    }
  }
  return 1;
}

static uint64_t bytes_of(const chi_fiber* f)
{
  const chi_buffer* const buffers[] = { &f->polygon.segments, &f->polygon.corner_buffer,
    &f->polygon.given, &f->polygon.order, &f->next.segments, &f->next.corner_buffer, &f->next.given,
    &f->next.order, &f->index.value_buffer, &f->index.flag_buffer, &f->index.brick_buffer,
    &f->index.run_buffer, &f->index.list_buffer, &f->index.cell_buffer, &f->index.center_buffer,
    &f->index.place_buffer, &f->index.sum_buffer, &f->pairs.job_buffer, &f->pairs.pair_pointers,
    &f->pairs.mask_buffer, &f->pairs.active_buffer, &f->parts.name_buffer, &f->parts.corner_buffer,
    &f->parts.size_buffer, &f->parts.normal_buffer, &f->parts.id_buffer, &f->parts.used_buffer,
    &f->parts.table_buffer, &f->parts.order_buffer, &f->parts.partition_buffer,
    &f->components.point_buffer, &f->components.id_buffer, &f->components.area_buffer,
    &f->components.place_buffer, &f->components.job_buffer };
  uint64_t bytes = sizeof *f;
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; ++i)
  {
    bytes += buffers[i]->bytes;
  }
  for (size_t i = 0; i < f->pairs.buffers; ++i)
  {
    bytes += f->pairs.pair_buffer[i].bytes;
  }
  return bytes;
}

/* What the sizes say of the index. */
static void describe_index(chi_fiber* f)
{
  const chi_fiber_index* const x = &f->index;
  f->sizes.tetrahedra = x->tetrahedra;
  f->sizes.non_finite_values = x->bad_values;
  f->sizes.non_finite_cells = x->bad_places;
  f->sizes.hidden_cells = x->hidden;
  f->sizes.other_cells = x->others;
  for (int k = 0; k < 2; ++k)
  {
    f->sizes.field_ranges[2 * k] = x->range.low[k];
    f->sizes.field_ranges[2 * k + 1] = x->range.high[k];
  }
}

static chi_status make_surface(const chi_exec* exec, chi_fiber* f, int32_t no_skipping)
{
  chi_status status = chi_fiber_find(exec, &f->pairs, &f->index, &f->polygon, no_skipping);
  if (status == CHI_OK)
  {
    status = chi_fiber_cut(exec, &f->parts, &f->pairs, &f->index, &f->polygon, f->with_normals);
  }
  if (status == CHI_OK)
  {
    status = chi_fiber_weld(exec, &f->parts, &f->pairs, &f->all_points, &f->all_triangles);
  }
  f->sizes.points = f->all_points;
  f->sizes.triangles = f->all_triangles;
  if (status == CHI_OK && f->with_components)
  {
    status = chi_fiber_find_components(exec, f);
  }
  if (status != CHI_OK)
  {
    return status;
  }
  for (size_t j = 0; j < f->pairs.jobs; ++j)
  {
    f->sizes.crossed += f->pairs.job[j].crossed;
  }
  f->sizes.segments = f->polygon.count;
  f->sizes.empty_segments = f->polygon.empty;
  f->sizes.skipped[0] = (int64_t)f->pairs.skipped_bricks;
  f->sizes.skipped[1] = (int64_t)f->pairs.skipped_runs;
  return CHI_OK;
}

chi_status chi_fiber_extract(
  const chi_exec* exec, chi_fiber* f, const chi_grid_view* grid, const chi_fiber_params* given)
{
  chi_fiber_params p = { 0 };
  if (!f)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const int had_surface = f->has_surface;
  const chi_fiber_sizes last = f->sizes;
  f->has_surface = 0;
  f->sizes = (chi_fiber_sizes){ .struct_size = sizeof f->sizes, .first_bad_cell = -1 };
  if (!grid || !given || !CHI_ADOPT(chi_fiber_params, minimum_area, &p, given) ||
    !fields_are_valid(&p) || !(p.minimum_area >= 0 && p.minimum_area < INFINITY))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_fiber_polygon_read(exec, &f->next, &p.polygon);
  if (status != CHI_OK)
  {
    return status;
  }
  const int looks = !(p.no_skipping & CHI_FIBER_SKIP_UNCHANGED);
  uint64_t version = 0;
  memcpy(&version, &grid->version,
    grid->struct_size >= CHI_BEYOND(chi_grid_view, version) ? sizeof version : 0);
  const int same_index = looks && f->has_index && p.fields_version != 0 &&
    f->fields_version == p.fields_version && f->grid_version == version &&
    f->component[0] == p.components[0] && f->component[1] == p.components[1];
  const int with_normals = !p.no_normals;
  const int with_components = p.find_components || p.minimum_area > 0;
  if (same_index && had_surface && same_polygon(&f->polygon, &f->next) &&
    f->with_normals == with_normals && f->with_components == with_components &&
    f->parts.split_corners == (p.split_corners != 0) && f->minimum_area == p.minimum_area)
  {
    f->sizes = last;
    f->sizes.skipped[2] = 2;
    f->has_surface = 1;
    return CHI_OK;
  }
  f->enclosed.is_ready = 0;
  const chi_fiber_polygon next = f->next;
  f->next = f->polygon;
  f->polygon = next;
  f->with_normals = with_normals;
  f->with_components = with_components;
  f->parts.split_corners = p.split_corners != 0;
  f->minimum_area = p.minimum_area;
  if (!same_index)
  {
    f->has_index = 0;
    status = chi_fiber_index_build(exec, &f->index, grid, &p, &f->sizes.first_bad_cell);
    if (status != CHI_OK)
    {
      return status;
    }
    f->has_index = 1;
    f->grid_version = version;
    f->fields_version = p.fields_version;
    f->component[0] = p.components[0];
    f->component[1] = p.components[1];
  }
  describe_index(f);
  status = make_surface(exec, f, p.no_skipping);
  f->has_surface = status == CHI_OK;
  f->sizes.skipped[2] = same_index;
  f->sizes.scratch_bytes = bytes_of(f);
  if (!f->has_surface)
  {
    f->sizes.points = f->sizes.triangles = f->sizes.components = 0;
  }
  return status;
}

void chi_fiber_get_sizes(const chi_fiber* fiber, chi_fiber_sizes* sizes)
{
  if (fiber && sizes)
  {
    *sizes = fiber->sizes;
    sizes->struct_size = sizeof *sizes;
  }
}
