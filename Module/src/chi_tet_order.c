/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_order_internal.h"

#include "math/chi_mat4.h"

#include <math.h>
#include <time.h>

enum
{
  MAX_SIZE = 16384 /* pixels a side */
};

struct chi_tet_order
{
  chi_tet_mesh_view mesh;
  int32_t method;
  chi_order_adjacency adjacency;
  chi_order_shape shape;
  chi_order_lift lift;
  chi_order_sort sort;
  chi_tet_order_info info;
  /* of the last keys */
  chi_order_eye eye;
  chi_camera camera;
  const uint32_t* keys;
  int32_t bits;
};

static double now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct range_job
{
  const chi_tet_mesh_view* mesh;
  uint8_t* is_outside; /* [chunks] */
} range_job;

static void check_vertices(void* data, size_t begin, size_t end)
{
  const range_job* const it = (const range_job*)data;
  const size_t chunk = 4 * chi_order_chunk(it->mesh->count);
  for (size_t c = begin; c < end; ++c)
  {
    uint32_t most = 0;
    for (size_t i = c * chunk; i < (c + 1) * chunk && i < 4 * it->mesh->count; ++i)
    {
      most = it->mesh->vertices[i] > most ? it->mesh->vertices[i] : most;
    }
    it->is_outside[c] = most >= it->mesh->points.count;
  }
}

chi_status chi_order_mesh_check(
  const chi_exec* exec, const chi_tet_mesh_view* given, chi_tet_mesh_view* mesh)
{
  *mesh = (chi_tet_mesh_view){ .struct_size = sizeof *mesh };
  if (!given || !CHI_ADOPT(chi_tet_mesh_view, count, mesh, given) ||
    !chi_view_is_valid(&mesh->points) || (mesh->count && !mesh->vertices))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  /* faces are numbered by 32 bits, and a bit of a vertex tells their sense */
  if (mesh->count >= UINT32_MAX / 4 || mesh->points.count > INT32_MAX)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  uint8_t is_outside[CHI_ORDER_CHUNKS] = { 0 };
  range_job job = { mesh, is_outside };
  const chi_status status =
    mesh->count ? chi_for(exec, CHI_ORDER_CHUNKS, check_vertices, &job) : CHI_OK;
  for (int c = 0; c < CHI_ORDER_CHUNKS; ++c)
  {
    if (is_outside[c])
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
  }
  return status;
}

/* What the method needs, and for AUTO which one it is. */
static chi_status analyse(const chi_exec* exec, chi_tet_order* order)
{
  const chi_tet_mesh_view* const mesh = &order->mesh;
  const int automatic = order->method == CHI_TET_ORDER_AUTO;
  order->info.used = order->method;
  if (order->method == CHI_TET_ORDER_CENTROID)
  {
    return CHI_OK;
  }
  chi_status status = chi_order_adjacency_build(exec, &order->adjacency, mesh);
  if (status == CHI_OK)
  {
    status = chi_order_shape_find(exec, &order->shape, mesh, &order->adjacency);
  }
  if (status != CHI_OK)
  {
    return status;
  }
  order->info.interior_faces = order->adjacency.interior;
  order->info.boundary_faces = order->adjacency.boundary;
  order->info.bad_faces = order->adjacency.bad;
  order->info.pieces = order->shape.pieces;
  order->info.convex = order->shape.convex;
  if (order->method == CHI_TET_ORDER_TANGENTIAL || automatic)
  {
    const chi_order_lift* const lift = &order->lift;
    int32_t holds = order->shape.convex;
    status = chi_order_lift_find(
      exec, &order->lift, mesh, &order->adjacency, automatic ? 1 + (order->shape.convex != 0) : 0);
    if (status == CHI_OK && !holds && lift->usable && lift->tied == 0)
    {
      status = chi_order_lift_supports(exec, lift, mesh, &holds);
    }
    order->info.tied_faces = lift->tied;
    order->info.wrong_faces = lift->wrong;
    order->info.lift = lift->usable && holds && (automatic || lift->tied == 0);
  }
  if (automatic)
  {
    order->info.used = order->info.lift ? CHI_TET_ORDER_TANGENTIAL
      : order->shape.convex             ? CHI_TET_ORDER_MPVO
                                        : CHI_TET_ORDER_XMPVO;
  }
  if (order->info.used == CHI_TET_ORDER_TANGENTIAL)
  {
    chi_order_adjacency_free(exec, &order->adjacency);
  }
  else
  {
    chi_order_lift_free(exec, &order->lift);
  }
  return status;
}

static size_t count_bytes(const chi_tet_order* order)
{
  const chi_order_sort* const s = &order->sort;
  return sizeof *order + order->adjacency.neighbors.bytes + order->adjacency.exterior.bytes +
    order->lift.planes.bytes + order->lift.groups.bytes + order->lift.members.bytes +
    order->lift.outliers.bytes + s->sides.bytes + s->spare.bytes + s->waiting.bytes +
    s->queue.bytes + s->walk.bytes + s->relations.bytes + s->relation_starts.bytes +
    s->boxes.bytes + s->bands.bytes + s->counts.bytes + s->events.bytes + s->found.bytes;
}

chi_status chi_tet_order_create(
  const chi_exec* exec, const chi_tet_mesh_view* mesh, int32_t method, chi_tet_order** order)
{
  if (!order || method < CHI_TET_ORDER_AUTO || method > CHI_TET_ORDER_XMPVO)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *order = NULL;
  chi_tet_mesh_view own;
  chi_status status = chi_order_mesh_check(exec, mesh, &own);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_tet_order* const made = (chi_tet_order*)chi_alloc(exec, 1, sizeof *made);
  if (!made)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  const double start = now();
  *made = (chi_tet_order){
    .mesh = own, .method = method, .info = { .struct_size = sizeof(chi_tet_order_info) }
  };
  status = analyse(exec, made);
  if (status != CHI_OK)
  {
    chi_tet_order_destroy(exec, made);
    return status;
  }
  made->info.seconds_analysis = now() - start;
  made->info.bytes = count_bytes(made);
  *order = made;
  return CHI_OK;
}

void chi_tet_order_destroy(const chi_exec* exec, chi_tet_order* order)
{
  if (order)
  {
    chi_order_adjacency_free(exec, &order->adjacency);
    chi_order_lift_free(exec, &order->lift);
    chi_order_sort_free(exec, &order->sort);
    chi_free(exec, order, 1, sizeof *order);
  }
}

chi_status chi_order_eye_find(
  const chi_tet_order_view* given, chi_camera* camera, chi_order_eye* eye)
{
  chi_tet_order_view view = { .struct_size = sizeof view };
  *camera = (chi_camera){ .struct_size = sizeof *camera };
  double inverse[16];
  if (!given || !CHI_ADOPT(chi_tet_order_view, grid_to_world, &view, given) || !view.camera ||
    !CHI_ADOPT(chi_camera, near_depth, camera, view.camera) || camera->width < 1 ||
    camera->height < 1 || camera->width > MAX_SIZE || camera->height > MAX_SIZE)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *eye = (chi_order_eye){ .parallel = camera->parallel != 0, .camera = camera };
  memcpy(eye->to_eye, camera->world_to_eye, sizeof eye->to_eye);
  if (view.grid_to_world)
  {
    chi_mat4_multiply(camera->world_to_eye, view.grid_to_world, eye->to_eye);
  }
  if (!chi_mat4_invert_affine(eye->to_eye, inverse))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  double sum = 0;
  for (int k = 0; k < 3; ++k)
  {
    eye->at[k] = inverse[4 * k + (eye->parallel ? 2 : 3)];
    sum += 0 * eye->at[k];
  }
  return sum == 0 ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT;
}

/* Bits of numbers below count. */
static int32_t bits_of(size_t count)
{
  int32_t bits = 1;
  while (bits < 32 && count > (size_t)1 << bits)
  {
    ++bits;
  }
  return bits;
}

/* The keys depend on where one looks from, and, where gaps are looked up, on the whole view. */
static int is_same(const chi_tet_order* order, const chi_order_eye* eye)
{
  return memcmp(order->eye.to_eye, eye->to_eye, sizeof eye->to_eye) == 0 &&
    order->eye.parallel == eye->parallel &&
    (order->info.used != CHI_TET_ORDER_XMPVO ||
      (memcmp(order->camera.window, eye->camera->window, sizeof order->camera.window) == 0 &&
        order->camera.width == eye->camera->width && order->camera.height == eye->camera->height &&
        order->camera.near_depth == eye->camera->near_depth));
}

static chi_status find_keys(
  const chi_exec* exec, chi_tet_order* order, const chi_order_eye* eye, uint32_t* keys)
{
  chi_status status = CHI_OK;
  switch (order->info.used)
  {
    case CHI_TET_ORDER_CENTROID:
      order->bits = 32;
      return chi_order_centroid_keys(exec, &order->mesh, eye, keys);
    case CHI_TET_ORDER_TANGENTIAL:
      order->bits = 32;
      return chi_order_lift_keys(exec, &order->lift, &order->mesh, eye, keys);
    case CHI_TET_ORDER_XMPVO:
      status = chi_order_exterior_find(exec, &order->sort, &order->mesh, &order->adjacency, eye);
      break;
    default:
      break;
  }
  order->bits = bits_of(order->mesh.count);
  return status == CHI_OK
    ? chi_order_sort_find(exec, &order->sort, &order->mesh, &order->adjacency, eye, keys)
    : status;
}

chi_status chi_tet_order_keys(const chi_exec* exec, chi_tet_order* order,
  const chi_tet_order_view* view, uint32_t* keys, int32_t* bits)
{
  chi_camera camera;
  chi_order_eye eye;
  if (!order || !keys || !bits)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_order_eye_find(view, &camera, &eye);
  if (status != CHI_OK)
  {
    return status;
  }
  const double start = now();
  order->info.reused = order->keys == keys && is_same(order, &eye);
  if (!order->info.reused)
  {
    order->keys = NULL;
    order->bits = 1;
    status = order->mesh.count ? find_keys(exec, order, &eye, keys) : CHI_OK;
    order->info.cycles = order->sort.cycles;
    order->info.sorted = order->sort.replaced;
  }
  if (status == CHI_OK)
  {
    order->eye = eye;
    order->camera = camera;
    order->eye.camera = NULL; /* the caller's stack: what matters of it is in camera */
    order->keys = keys;
    *bits = order->bits;
  }
  order->info.seconds_keys = now() - start;
  order->info.bytes = count_bytes(order);
  return status;
}

void chi_tet_order_get_info(const chi_tet_order* order, chi_tet_order_info* info)
{
  if (order && info)
  {
    *info = order->info;
  }
}
