/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_internal.h"

#include "math/chi_mat4.h"

#include <chiaroscuro/chi_tet_order.h>

struct chi_tet_order
{
  chi_tet_mesh_view mesh;
  chi_tet_order_info info;
};

enum
{
  CHUNK = 8192
};

typedef struct key_job
{
  const chi_tet_mesh_view* mesh;
  double eye[3], axis[3];
  int parallel;
  uint32_t* keys;
} key_job;

chi_status chi_tet_order_create(
  const chi_exec* exec, const chi_tet_mesh_view* mesh, int32_t method, chi_tet_order** order)
{
  if (!order || !mesh || !chi_view_is_valid(&mesh->points) || (mesh->count && !mesh->vertices) ||
    method != CHI_TET_ORDER_CENTROID)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *order = (chi_tet_order*)chi_alloc(exec, 1, sizeof **order);
  if (!*order)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  **order = (chi_tet_order){ .mesh = *mesh,
    .info = { .struct_size = sizeof(chi_tet_order_info), .used = CHI_TET_ORDER_CENTROID } };
  return CHI_OK;
}

void chi_tet_order_destroy(const chi_exec* exec, chi_tet_order* order)
{
  if (order)
  {
    chi_free(exec, order, 1, sizeof *order);
  }
}

/* Floats that are not negative are ordered as their bits are; the nearest comes last. */
static uint32_t descending(double distance)
{
  const float f = (float)distance;
  uint32_t bits;
  memcpy(&bits, &f, sizeof bits);
  return ~(bits & 0x80000000u ? ~bits : bits | 0x80000000u);
}

static void find_keys(void* data, size_t begin, size_t end)
{
  const key_job* const it = (const key_job*)data;
  for (size_t t = begin * CHUNK; t < end * CHUNK && t < it->mesh->count; ++t)
  {
    double center[3] = { 0, 0, 0 }, distance = 0;
    for (int i = 0; i < 4; ++i)
    {
      double p[3];
      chi_view_get(&it->mesh->points, it->mesh->vertices[4 * t + (size_t)i], p);
      for (int k = 0; k < 3; ++k)
      {
        center[k] += 0.25 * p[k];
      }
    }
    for (int k = 0; k < 3; ++k)
    {
      const double away = center[k] - it->eye[k];
      distance += it->parallel ? away * it->axis[k] : away * away;
    }
    it->keys[t] = descending(distance);
  }
}

chi_status chi_tet_order_keys(const chi_exec* exec, chi_tet_order* order,
  const chi_tet_order_view* view, uint32_t* keys, int32_t* bits)
{
  if (!order || !view || !view->camera || !keys || !bits)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  double matrix[16], inverse[16];
  memcpy(matrix, view->camera->world_to_eye, sizeof matrix);
  if (view->grid_to_world)
  {
    chi_mat4_multiply(view->camera->world_to_eye, view->grid_to_world, matrix);
  }
  if (!chi_mat4_invert_affine(matrix, inverse))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  key_job job = { .mesh = &order->mesh, .parallel = view->camera->parallel != 0, .keys = keys };
  for (int k = 0; k < 3; ++k)
  {
    job.eye[k] = inverse[4 * k + 3];
    job.axis[k] = -matrix[8 + k];
  }
  *bits = 32;
  return chi_for(exec, (order->mesh.count + CHUNK - 1) / CHUNK, find_keys, &job);
}

void chi_tet_order_get_info(const chi_tet_order* order, chi_tet_order_info* info)
{
  if (order && info)
  {
    *info = order->info;
  }
}
