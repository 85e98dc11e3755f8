/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* A frame's plan for another engine. */
#include "chi_tet_handle.h"

#include "math/chi_mat4.h"

#include <math.h>

/* Of the eye's space, in which the mesh's bounds are a box that is turned. */
static double limit_of_points(const chi_tet* tet, const chi_tet_frame* f)
{
  double matrix[16], limit = 0;
  memcpy(matrix, f->camera->world_to_eye, sizeof matrix);
  if (f->grid_to_world)
  {
    chi_mat4_multiply(f->camera->world_to_eye, f->grid_to_world, matrix);
  }
  const double* const bounds = tet->mesh.counts.bounds;
  for (int corner = 0; corner < 8; ++corner)
  {
    for (int i = 0; i < 3; ++i)
    {
      double x = matrix[4 * i + 3];
      for (int j = 0; j < 3; ++j)
      {
        x += matrix[4 * i + j] * bounds[2 * j + (corner >> j & 1)];
      }
      limit = fmax(limit, fabs(x));
    }
  }
  return limit;
}

static void add_plane(const chi_tet* tet, chi_tet_plan* plan)
{
  const chi_tet_plane* const p = &tet->plane;
  plan->plane = (const float(*)[4])p->entries.data;
  plan->plane_rows = (int32_t)p->rows;
  plan->plane_step = CHI_TET_PLANE_STEP;
  plan->plane_parts = CHI_TET_PLANE_PARTS;
  memcpy(plan->plane_range, p->key.plane_range, sizeof plan->plane_range);
  plan->plane_version = p->version;
  plan->seconds = tet->values.by_gradient ? (const float*)tet->values.gradients.data : NULL;
}

static chi_tet_plan make_plan(const chi_tet* tet, const chi_tet_frame* f, const chi_camera* full)
{
  const chi_tet_values* const v = &tet->values;
  const chi_tet_mesh* const m = &tet->mesh;
  return (chi_tet_plan){ .struct_size = sizeof(chi_tet_plan),
    .points = (const double*)tet->eye.points.data,
    .scalars = (const float*)v->scalars.data,
    .opacities = v->separate && !v->by_gradient ? (const float*)v->opacities.data : NULL,
    .point_count = m->point_count,
    .value_count = v->is_cell_data ? m->counts.cells : m->point_count,
    .vertices = (const uint32_t*)m->vertices.data,
    .cells = m->cell_of,
    .count = m->counts.tetrahedra,
    .sequence = (const uint32_t*)tet->sequence.data,
    .sequence_count = tet->sequence_count,
    .is_cell_data = v->is_cell_data,
    .blend = f->params->blend,
    .planes = tet->eye.planes,
    .plane_count = f->clip_plane_count,
    .maximum_path = tet->stats.unit_distance,
    .opacity_convention = f->params->opacity_convention,
    .parallel = f->camera->parallel != 0,
    .colors = v->direct ? (const float*)v->colors.data : NULL,
    .tables = tet->tables,
    .points_version = tet->versions[0],
    .scalars_version = tet->versions[3],
    .vertices_version = tet->versions[2],
    .sequence_version = tet->versions[1],
    .shades = f->shading ? (const float*)tet->shades.data : NULL,
    .color_limit = f->shading && f->shading->unclamped ? INFINITY : 1,
    .width = f->camera->width,
    .height = f->camera->height,
    .full_width = full->width,
    .full_height = full->height,
    .reduction = f->params->reduction > 1 ? f->params->reduction : 1,
    .first = { tet->eye.first[0], tet->eye.first[1] },
    .step = { tet->eye.step[0], tet->eye.step[1] },
    .near_depth = f->camera->near_depth,
    .point_limit = limit_of_points(tet, f),
    .depth = f->surface ? f->surface->depth : NULL,
    .surface_version = f->surface ? f->surface->version : 0,
    .frame_version = tet->frame_version };
}

chi_status chi_tet_describe(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame, chi_tet_plan* plan)
{
  chi_tet_own_frame own;
  const chi_status valid = tet && plan && plan->struct_size >= sizeof *plan
    ? chi_tet_adopt_frame(&own, frame)
    : CHI_ERROR_INVALID_ARGUMENT;
  if (valid != CHI_OK)
  {
    return valid;
  }
  const double start = chi_tet_now();
  const chi_tet_frame* const f = &own.frame;
  own.params.subpixel_splatting = 0;
  chi_status status = chi_tet_reduce_frame(exec, tet, &own);
  status = status == CHI_OK ? chi_tet_prepare(exec, tet, f) : status;
  if (status == CHI_OK && (tet->sequenced != tet->versions[1] || !tet->sequenced))
  {
    status = chi_tet_sequence(
      exec, &tet->bins, &tet->mesh, tet->bits, &tet->sequence, &tet->sequence_count);
    tet->sequenced = status == CHI_OK ? tet->versions[1] : 0;
  }
  if (status == CHI_OK && f->shading)
  {
    status = chi_tet_shade(exec, &tet->shades, &tet->mesh, &tet->values, &tet->eye, &tet->bins, f);
  }
  if (status != CHI_OK)
  {
    return status;
  }
  chi_tet_described_key key;
  memset(&key, 0, sizeof key);
  key.draw = chi_tet_key_of_draw(tet, f, &own.camera);
  memcpy(key.versions, tet->versions, sizeof key.versions);
  tet->stats.reused =
    !chi_tet_differs(tet, f, tet->frame_version != 0, &tet->described, &key, sizeof key);
  tet->frame_version += !tet->stats.reused;
  tet->described = key;
  *plan = make_plan(tet, f, &own.camera);
  if (tet->values.by_plane)
  {
    add_plane(tet, plan);
  }
  chi_tet_report(&tet->stats, &(chi_tet_tally){ .tetrahedra = (int64_t)tet->sequence_count });
  tet->stats.seconds_draw = 0;
  tet->stats.seconds_total = chi_tet_now() - start;
  return CHI_OK;
}
