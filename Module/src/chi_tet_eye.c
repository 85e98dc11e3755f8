/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_internal.h"

#include "math/chi_mat4.h"

#include <math.h>

typedef struct eye_job
{
  const chi_tet_mesh* mesh;
  const float* scalars;       /* of points, or NULL */
  const float* opacities;     /* likewise */
  double matrix[3][3], at[3]; /* p' = matrix (p - at): offsets cancel before they are multiplied */
  double first[2], per_pixel[2], near_depth;
  const double* planes;
  size_t plane_count, chunk;
  int parallel;
  chi_tet_point* points;
  float (*screen)[2];
  uint32_t* codes;
  uint8_t* beyond_chunk;
} eye_job;

static void place(void* data, size_t begin, size_t end)
{
  const eye_job* const it = (const eye_job*)data;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    const size_t last = (chunk + 1) * it->chunk;
    uint8_t any_beyond = 0;
    for (size_t i = chunk * it->chunk; i < it->mesh->point_count && i < last; ++i)
    {
      double p[3], q[3];
      chi_view_get(&it->mesh->all_points, i, p);
      for (int k = 0; k < 3; ++k)
      {
        p[k] -= it->at[k];
      }
      for (int k = 0; k < 3; ++k)
      {
        q[k] = it->matrix[k][0] * p[0] + it->matrix[k][1] * p[1] + it->matrix[k][2] * p[2];
      }
      it->points[i] = (chi_tet_point){ q[0], q[1], q[2], it->scalars ? it->scalars[i] : 0,
        it->opacities ? it->opacities[i] : 0 };
      const int is_near =
        fabs(q[0]) < CHI_TET_FAR && fabs(q[1]) < CHI_TET_FAR && fabs(q[2]) < CHI_TET_FAR;
      const int beyond = !is_near || (!it->parallel && q[2] < it->near_depth);
      const double w = it->parallel ? 1 : 1 / q[2];
      any_beyond |= (uint8_t)beyond;
      it->screen[i][0] = beyond ? NAN : (float)((q[0] * w - it->first[0]) * it->per_pixel[0]);
      it->screen[i][1] = beyond ? NAN : (float)((q[1] * w - it->first[1]) * it->per_pixel[1]);
      if (it->codes)
      {
        uint32_t code = 0;
        for (size_t k = 0; k < it->plane_count; ++k)
        {
          const double* const n = it->planes + 4 * k;
          code |= (uint32_t)(n[0] * q[0] + n[1] * q[1] + n[2] * q[2] + n[3] < 0) << k;
        }
        it->codes[i] = code;
      }
    }
    it->beyond_chunk[chunk] = any_beyond;
  }
}

/* A plane of the world in the eye's space, whose third axis is the depth. */
static void turn_plane(const double m[16], const double world[4], double eye[4])
{
  eye[3] = world[3];
  for (int i = 0; i < 3; ++i)
  {
    const double n = m[4 * i] * world[0] + m[4 * i + 1] * world[1] + m[4 * i + 2] * world[2];
    eye[3] -= n * m[4 * i + 3];
    eye[i] = i == 2 ? -n : n;
  }
}

chi_status chi_tet_eye_build(const chi_exec* exec, chi_tet_eye* eye, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_frame* frame)
{
  static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  const chi_camera* const camera = frame->camera;
  double matrix[16], inverse[16];
  chi_mat4_multiply(
    camera->world_to_eye, frame->grid_to_world ? frame->grid_to_world : identity, matrix);
  if (!chi_mat4_invert_affine(matrix, inverse))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const size_t n = mesh->point_count;
  if (!chi_buffer_reserve(exec, &eye->points, n, sizeof(chi_tet_point)) ||
    !chi_buffer_reserve(exec, &eye->screen, n, 2 * sizeof(float)) ||
    (frame->clip_plane_count && !chi_buffer_reserve(exec, &eye->codes, n, sizeof(uint32_t))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  const double width[2] = { camera->window[1] - camera->window[0],
    camera->window[3] - camera->window[2] };
  const int32_t size[2] = { camera->width, camera->height };
  eye_job job = { .mesh = mesh,
    .scalars = values->is_cell_data ? NULL : (const float*)values->scalars.data,
    .opacities = values->is_cell_data || !values->separate || values->by_gradient
      ? NULL
      : (const float*)values->opacities.data,
    .near_depth = camera->near_depth,
    .planes = eye->planes,
    .plane_count = frame->clip_plane_count,
    .chunk = (n + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS,
    .parallel = camera->parallel != 0,
    .points = (chi_tet_point*)eye->points.data,
    .screen = (float(*)[2])eye->screen.data,
    .codes = frame->clip_plane_count ? (uint32_t*)eye->codes.data : NULL };
  for (int k = 0; k < 2; ++k)
  {
    eye->step[k] = width[k] / size[k];
    eye->first[k] = camera->window[2 * k] + 0.5 * eye->step[k];
    job.first[k] = eye->first[k];
    job.per_pixel[k] = 1 / eye->step[k];
  }
  for (int i = 0; i < 3; ++i)
  {
    job.at[i] = inverse[4 * i + 3];
    for (int j = 0; j < 3; ++j)
    {
      job.matrix[i][j] = i == 2 ? -matrix[4 * i + j] : matrix[4 * i + j];
    }
  }
  for (size_t k = 0; k < frame->clip_plane_count; ++k)
  {
    turn_plane(camera->world_to_eye, frame->clip_planes + 4 * k, eye->planes + 4 * k);
  }
  uint8_t beyond_chunk[CHI_TET_CHUNKS] = { 0 };
  job.beyond_chunk = beyond_chunk;
  const chi_status status = chi_for(exec, CHI_TET_CHUNKS, place, &job);
  eye->any_beyond = 0;
  for (int i = 0; i < CHI_TET_CHUNKS; ++i)
  {
    eye->any_beyond |= beyond_chunk[i];
  }
  return status;
}

void chi_tet_eye_free(const chi_exec* exec, chi_tet_eye* eye)
{
  chi_buffer_free(exec, &eye->points);
  chi_buffer_free(exec, &eye->screen);
  chi_buffer_free(exec, &eye->codes);
}
