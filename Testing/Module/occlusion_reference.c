/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "occlusion_reference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  BRICK = 8,
  MAX_RAYS = 4096
};

static const double golden_angle = 2.39996322972865332; /* pi (3 - sqrt 5) */
static const double radian = 0.017453292519943295;

int reference_volume_create(reference_volume* v, const size_t n[3])
{
  memset(v, 0, sizeof *v);
  memcpy(v->n, n, sizeof v->n);
  for (int a = 0; a < 3; ++a)
  {
    v->bricks[a] = (n[a] - 1) / BRICK + 1;
  }
  v->extinction = calloc(n[0] * n[1] * n[2], sizeof(float));
  v->occupied = calloc(v->bricks[0] * v->bricks[1] * v->bricks[2], 1);
  if (!v->extinction || !v->occupied)
  {
    reference_volume_free(v);
    return 0;
  }
  return 1;
}

void reference_volume_free(reference_volume* v)
{
  free(v->extinction);
  free(v->occupied);
  memset(v, 0, sizeof *v);
}

/* A sample touches the cells on both its sides, so it marks up to two bricks along each axis. */
static void mark(reference_volume* v, const size_t at[3])
{
  size_t first[3], last[3];
  for (int a = 0; a < 3; ++a)
  {
    first[a] = (at[a] > 0 ? at[a] - 1 : 0) / BRICK;
    last[a] = at[a] / BRICK;
  }
  for (size_t k = first[2]; k <= last[2]; ++k)
  {
    for (size_t j = first[1]; j <= last[1]; ++j)
    {
      for (size_t i = first[0]; i <= last[0]; ++i)
      {
        v->occupied[i + v->bricks[0] * (j + v->bricks[1] * k)] = 1;
      }
    }
  }
}

void reference_volume_finish(reference_volume* v)
{
  for (int a = 0; a < 3; ++a)
  {
    v->low[a] = INFINITY;
    v->high[a] = -INFINITY;
  }
  size_t i = 0, at[3];
  for (at[2] = 0; at[2] < v->n[2]; ++at[2])
  {
    for (at[1] = 0; at[1] < v->n[1]; ++at[1])
    {
      for (at[0] = 0; at[0] < v->n[0]; ++at[0], ++i)
      {
        if (v->extinction[i] > 0)
        {
          mark(v, at);
          for (int a = 0; a < 3; ++a)
          {
            const double last = (double)v->n[a] - 1;
            v->low[a] = fmin(v->low[a], fmax((double)at[a] - 1, 0));
            v->high[a] = fmax(v->high[a], fmin((double)at[a] + 1, last));
          }
        }
      }
    }
  }
}

/* 60 balls z, y, x, radius, extinction, from a generator that any language can repeat. */
static void add_balls(reference_volume* v)
{
  static const double extinctions[3] = { 0.05, 0.3, 2.0 };
  uint32_t state = 1;
  for (int ball = 0; ball < 60; ++ball)
  {
    double draw[5];
    for (int k = 0; k < 5; ++k)
    {
      state = state * 1664525u + 1013904223u;
      draw[k] = (double)state * 0x1p-32;
    }
    const double cz = 10 + 108 * draw[0], cy = 10 + 108 * draw[1], cx = 10 + 108 * draw[2];
    const double r = 3 + 7 * draw[3], e = extinctions[(int)(3 * draw[4])];
    const size_t n = REFERENCE_SIZE;
    for (size_t i = 0; i < n * n * n; ++i)
    {
      const double x = (double)(i % n) - cx, y = (double)(i / n % n) - cy;
      const double z = (double)(i / (n * n)) - cz;
      const double inside = r - sqrt(z * z + y * y + x * x) + 0.5;
      if (inside > 0)
      {
        v->extinction[i] += (float)(e * fmin(inside, 1));
      }
    }
  }
}

static int read_raw(reference_volume* v, const char* name)
{
  const size_t count = v->n[0] * v->n[1] * v->n[2];
  FILE* const file = name ? fopen(name, "rb") : NULL;
  const int ok = file && fread(v->extinction, sizeof(float), count, file) == count;
  if (file)
  {
    fclose(file);
  }
  return ok;
}

int reference_scene(reference_volume* v, reference_kind kind, const char* raw_file)
{
  const size_t n[3] = { REFERENCE_SIZE, REFERENCE_SIZE, REFERENCE_SIZE };
  if (!reference_volume_create(v, n))
  {
    return 0;
  }
  if (kind == REFERENCE_HALF_PLANE)
  {
    for (size_t k = 20; k < 22; ++k)
    {
      for (size_t i = 0; i < n[0] * n[1]; ++i)
      {
        v->extinction[i + n[0] * n[1] * k] = i % n[0] < n[0] / 2 ? 8.0f : 0.0f;
      }
    }
  }
  else if (kind == REFERENCE_BALLS)
  {
    add_balls(v);
  }
  else if (!read_raw(v, raw_file))
  {
    reference_volume_free(v);
    return 0;
  }
  reference_volume_finish(v);
  return 1;
}

double reference_extinction(const reference_volume* v, const double at[3])
{
  size_t cell[3];
  double f[3];
  for (int a = 0; a < 3; ++a)
  {
    if (!(at[a] >= 0 && at[a] <= (double)(v->n[a] - 1)))
    {
      return 0;
    }
    cell[a] = (size_t)at[a];
    cell[a] = cell[a] + 1 < v->n[a] ? cell[a] : v->n[a] > 1 ? v->n[a] - 2 : 0;
    f[a] = at[a] - (double)cell[a];
  }
  const size_t brick =
    cell[0] / BRICK + v->bricks[0] * (cell[1] / BRICK + v->bricks[1] * (cell[2] / BRICK));
  if (!v->occupied[brick])
  {
    return 0;
  }
  const size_t dx = v->n[0] > 1, dy = v->n[1] > 1 ? v->n[0] : 0;
  const size_t dz = v->n[2] > 1 ? v->n[0] * v->n[1] : 0;
  const float* const s = v->extinction + cell[0] + v->n[0] * (cell[1] + v->n[1] * cell[2]);
  const double a = (1 - f[0]) * (double)s[0] + f[0] * (double)s[dx];
  const double b = (1 - f[0]) * (double)s[dy] + f[0] * (double)s[dy + dx];
  const double c = (1 - f[0]) * (double)s[dz] + f[0] * (double)s[dz + dx];
  const double d = (1 - f[0]) * (double)s[dz + dy] + f[0] * (double)s[dz + dy + dx];
  return (1 - f[2]) * ((1 - f[1]) * a + f[1] * b) + f[2] * ((1 - f[1]) * c + f[1] * d);
}

static reference_view view_from(const double eye[3])
{
  reference_view view = { .camera = { .struct_size = sizeof(chi_camera),
                            .world_to_eye = {
                              1, 0, 0, -eye[0], 0, 1, 0, -eye[1], 0, 0, 1, eye[2], 0, 0, 0, 1 } } };
  memcpy(view.eye, eye, sizeof view.eye);
  return view;
}

reference_view reference_parallel_view(void)
{
  const double middle = 0.5 * (REFERENCE_SIZE - 1);
  const double eye[3] = { middle, middle, -10 };
  reference_view view = view_from(eye);
  const double half = 0.5 * REFERENCE_SIZE;
  view.camera.window[0] = view.camera.window[2] = -half;
  view.camera.window[1] = view.camera.window[3] = half;
  view.camera.parallel = 1;
  view.camera.width = view.camera.height = REFERENCE_SIZE;
  return view;
}

/* As ResetCamera places it, then zoom 1.25. */
reference_view reference_perspective_view(double angle_deg)
{
  const double half = 0.5 * angle_deg * radian, n = REFERENCE_SIZE;
  const double front = n * sqrt(3.0) / 2 / sin(half) - n / 2; /* depth of the grid's front face */
  const double eye[3] = { 0.5 * (n - 1), 0.5 * (n - 1), -(front + 0.5) };
  reference_view view = view_from(eye);
  const double slope = tan(half) / 1.25;
  view.camera.window[0] = view.camera.window[2] = -slope;
  view.camera.window[1] = view.camera.window[3] = slope;
  view.camera.width = view.camera.height = REFERENCE_PICTURE;
  view.camera.near_depth = 1;
  return view;
}

reference_view reference_turned_view(const double center[3], double distance,
  const double turn_deg[2], double size, int32_t pixels, int32_t parallel)
{
  const double a = turn_deg[0] * radian, e = turn_deg[1] * radian;
  /* Rows of the rotation from the world to the eye. */
  const double r[3][3] = { { cos(a), 0, sin(a) }, { sin(e) * sin(a), cos(e), -sin(e) * cos(a) },
    { -cos(e) * sin(a), sin(e), cos(e) * cos(a) } };
  const double world[3] = { center[0], center[1], -center[2] };
  reference_view view = { .camera = { .struct_size = sizeof(chi_camera) } };
  for (int i = 0; i < 3; ++i)
  {
    double* const row = view.camera.world_to_eye + 4 * i;
    row[3] = i == 2 ? -distance : 0;
    for (int j = 0; j < 3; ++j)
    {
      row[j] = r[i][j];
      row[3] -= r[i][j] * world[j];
    }
  }
  view.camera.world_to_eye[15] = 1;
  const double half = 0.5 * size / (parallel ? 1 : distance);
  view.camera.window[0] = view.camera.window[2] = -half;
  view.camera.window[1] = view.camera.window[3] = half;
  view.camera.parallel = parallel;
  view.camera.width = view.camera.height = pixels;
  view.camera.near_depth = parallel ? 0 : 1e-3 * distance;
  return view;
}

double reference_depth(const reference_view* view, const double at[3])
{
  return at[2] - view->eye[2];
}

/* Pixel coordinates (centre of pixel i is i + 0.5) and depth of a point. */
static void project(const reference_view* view, const double at[3], double pixel[3])
{
  const chi_camera* const c = &view->camera;
  const double depth = reference_depth(view, at), scale = c->parallel ? 1 : 1 / depth;
  pixel[0] = ((at[0] - view->eye[0]) * scale - c->window[0]) / (c->window[1] - c->window[0]) *
    (double)c->width;
  pixel[1] = ((at[1] - view->eye[1]) * scale - c->window[2]) / (c->window[3] - c->window[2]) *
    (double)c->height;
  pixel[2] = depth;
}

static int is_judged(const reference_volume* v, reference_kind kind, size_t x, size_t y, size_t z)
{
  const double s = (double)v->extinction[x + v->n[0] * (y + v->n[1] * z)];
  switch (kind)
  {
    case REFERENCE_HALF_PLANE:
      return z >= 24 && z % 4 == 0 && y == 64 && fabs((double)x - 63.5) <= (double)z - 21;
    case REFERENCE_BALLS:
      return s < 0.5 && z % 6 == 3 && y % 6 == 3 && x % 6 == 3;
    default:
      return s > (double)0.002f && z % 4 == 1 && y % 4 == 1 && x % 4 == 1;
  }
}

static void keep_point(
  reference_points* points, size_t* seen, size_t stride, double x, double y, double z)
{
  if ((*seen)++ % stride == 0)
  {
    double* const p = points->position + 3 * points->count++;
    p[0] = x;
    p[1] = y;
    p[2] = z;
  }
}

static void parallel_points(
  reference_points* points, const reference_volume* v, reference_kind kind, size_t stride)
{
  size_t seen = 0;
  for (size_t z = 0; z < v->n[2]; ++z)
  {
    for (size_t y = 0; y < v->n[1]; ++y)
    {
      for (size_t x = 0; x < v->n[0]; ++x)
      {
        if (is_judged(v, kind, x, y, z))
        {
          keep_point(points, &seen, stride, (double)x, (double)y, (double)z);
        }
      }
    }
  }
}

/* Middles of pixels, every eighth layer; columns and rows thinned out as in perspective.py. */
static void perspective_points(reference_points* points, const reference_volume* v,
  reference_kind kind, const reference_view* view, size_t stride)
{
  const chi_camera* const c = &view->camera;
  const double middle = 0.5 * (REFERENCE_SIZE - 1), limit = 0.5 * REFERENCE_SIZE - 2;
  size_t seen = 0;
  for (int z = 24; z < REFERENCE_SIZE; z += 8)
  {
    for (int j = 0; j < c->height; j += 5)
    {
      for (int i = 0; i < c->width; i += kind == REFERENCE_HALF_PLANE ? 2 : 5)
      {
        const double depth = (double)z - view->eye[2];
        const double x =
          depth * (c->window[0] + (i + 0.5) / c->width * (c->window[1] - c->window[0]));
        const double y =
          depth * (c->window[2] + (j + 0.5) / c->height * (c->window[3] - c->window[2]));
        const double at[3] = { x + middle, y + middle, z };
        int inside = fabs(x) < limit && fabs(y) < limit;
        inside = inside &&
          (kind == REFERENCE_HALF_PLANE ? fabs(x) <= z - 21 && fabs(y) < 30
                                        : reference_extinction(v, at) < 0.5);
        if (inside)
        {
          keep_point(points, &seen, stride, at[0], at[1], at[2]);
        }
      }
    }
  }
}

int reference_points_create(reference_points* points, const reference_volume* v,
  reference_kind kind, const reference_view* view, size_t stride)
{
  points->count = 0;
  points->position = malloc(v->n[0] * v->n[1] * v->n[2] / 16 * 3 * sizeof(double));
  if (!points->position)
  {
    return 0;
  }
  if (view->camera.parallel)
  {
    parallel_points(points, v, kind, stride);
  }
  else
  {
    perspective_points(points, v, kind, view, stride);
  }
  return 1;
}

void reference_points_free(reference_points* points)
{
  free(points->position);
  points->position = NULL;
  points->count = 0;
}

static int is_blocked(
  const reference_surface* surface, const reference_view* view, const double at[3])
{
  double pixel[3];
  project(view, at, pixel);
  const chi_camera* const c = &view->camera;
  if (!(pixel[0] >= 0 && pixel[1] >= 0 && pixel[0] < c->width && pixel[1] < c->height))
  {
    return 0;
  }
  const double depth =
    (double)surface->depth[(size_t)pixel[0] + (size_t)c->width * (size_t)pixel[1]];
  return depth > 0 && pixel[2] >= depth && pixel[2] < depth + surface->thickness;
}

/* Parameters of the ray start - t direction between which it can meet anything. */
static void clip(const double low[3], const double high[3], const double start[3],
  const double direction[3], double range[2])
{
  for (int a = 0; a < 3; ++a)
  {
    if (direction[a] != 0)
    {
      const double t0 = (start[a] - low[a]) / direction[a],
                   t1 = (start[a] - high[a]) / direction[a];
      range[0] = fmax(range[0], fmin(t0, t1));
      range[1] = fmin(range[1], fmax(t0, t1));
    }
    else if (start[a] < low[a] || start[a] > high[a])
    {
      range[1] = -1;
    }
  }
}

/* Optical depth of one ray; the midpoint rule on the same steps whatever is left out as empty. */
static double ray_thickness(const reference_volume* v, const reference_surface* surface,
  const reference_view* view, const double start[3], const double direction[3], double step)
{
  double range[2] = { 0, -1 };
  if (surface)
  {
    range[1] = 4.0 * REFERENCE_SIZE;
  }
  else if (v)
  {
    range[1] = INFINITY;
    clip(v->low, v->high, start, direction, range);
  }
  if (range[1] < range[0])
  {
    return 0;
  }
  double tau = 0;
  const long first = (long)floor(range[0] / step - 0.5), last = (long)ceil(range[1] / step - 0.5);
  for (long k = first > 0 ? first : 0; k <= last && tau < 40; ++k) /* exp(-40) = 4e-18 */
  {
    const double t = ((double)k + 0.5) * step;
    const double at[3] = { start[0] - t * direction[0], start[1] - t * direction[1],
      start[2] - t * direction[2] };
    if (surface)
    {
      const double front = v ? reference_depth(view, v->low) : INFINITY;
      if (reference_depth(view, at) < fmin(surface->nearest, front))
      {
        break;
      }
      if (surface->contains ? surface->contains(surface->solid, at) : is_blocked(surface, view, at))
      {
        return INFINITY;
      }
    }
    if (v)
    {
      tau += reference_extinction(v, at) * step;
    }
  }
  return tau;
}

static void cross(const double a[3], const double b[3], double out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalize(double a[3])
{
  const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int k = 0; k < 3; ++k)
  {
    a[k] /= length;
  }
}

/* Turn a direction by the smallest turn that takes (0, 0, 1) to the axis. */
static void turn_to(const double axis[3], double d[3])
{
  double a[3] = { axis[0], axis[1], axis[2] }, middle[3], turned[3];
  normalize(a);
  for (int k = 0; k < 3; ++k)
  {
    middle[k] = a[k] + (k == 2);
  }
  normalize(middle);
  /* Half a turn about z, then half a turn about the middle of z and the axis. */
  const double flipped[3] = { -d[0], -d[1], d[2] };
  double along = 0;
  for (int k = 0; k < 3; ++k)
  {
    along += middle[k] * flipped[k];
  }
  for (int k = 0; k < 3; ++k)
  {
    turned[k] = 2 * along * middle[k] - flipped[k];
  }
  for (int k = 0; k < 3; ++k)
  {
    d[k] = turned[k];
  }
}

/*
 * Checked once against exact() of the numpy prototypes. Parallel, 1024 rays, step 1/4, some 400
 * points a scene: half-plane within 4e-11, balls 5e-7, brain 2e-10. Perspective, 512 rays, step
 * 1/2, 30 and 60 degrees, some 200 points: half-plane 2e-10, balls 2e-6 (the prototype adds its
 * balls up in float).
 */
double reference_visibility(const reference_volume* v, const reference_surface* surface,
  const reference_view* view, const reference_rays* rays, const double at[3])
{
  double w[3] = { 0, 0, 1 }, across[3] = { -1, 0, 0 }, up[3] = { 0, -1, 0 };
  if (!view->camera.parallel)
  {
    for (int a = 0; a < 3; ++a)
    {
      w[a] = at[a] - view->eye[a];
    }
    normalize(w);
    up[1] = 1;
    cross(w, up, across);
    normalize(across);
    cross(w, across, up);
  }
  double sum = 0;
  for (int m = 0; m < rays->count; ++m)
  {
    const double mu = 1 - (1 - cos(rays->half_angle)) * (m + 0.5) / rays->count;
    const double sine = sqrt(1 - mu * mu), azimuth = (m + 0.5) * golden_angle;
    double direction[3], d[3] = { sine * cos(azimuth), sine * sin(azimuth), mu };
    if (view->light[0] != 0 || view->light[1] != 0)
    {
      turn_to(view->light, d);
    }
    for (int a = 0; a < 3; ++a)
    {
      direction[a] = d[2] * w[a] + d[0] * across[a] + d[1] * up[a];
    }
    const double step = view->camera.parallel ? rays->step / mu : rays->step;
    sum += exp(-ray_thickness(v, surface, view, at, direction, step));
  }
  return sum / rays->count;
}

void reference_frame_init(
  reference_frame* f, const reference_volume* volume, const reference_view* view, double range)
{
  memset(f, 0, sizeof *f);
  f->camera = view->camera;
  chi_occlusion_default_params(&f->params);
  f->params.bias = 0;
  /*
   * Optical depth 2 a unit distance at most. Opacity is a float, so extinction is off by 2^-24
   * e^2 / 2 = 2e-7 of the largest; between entries, where opacity and not extinction is linear, by
   * (2 / 4096)^2 / 8 / 2 = 1.5e-8 of it.
   */
  f->transfer = (chi_transfer_view){ .struct_size = sizeof f->transfer,
    .rgb = f->rgb,
    .opacity = f->opacity,
    .count = REFERENCE_ENTRIES,
    .range = { 0, range },
    .unit_distance = 2 / range,
    .version = 1 };
  for (int i = 0; i < REFERENCE_ENTRIES; ++i)
  {
    f->opacity[i] = (float)-expm1(-2.0 * i / (REFERENCE_ENTRIES - 1));
    f->rgb[3 * i] = f->rgb[3 * i + 1] = f->rgb[3 * i + 2] = 1;
  }
  f->frame = (chi_occlusion_frame){
    .struct_size = sizeof f->frame, .camera = &f->camera, .params = &f->params
  };
  if (volume)
  {
    f->volume = (chi_volume_view){ .struct_size = sizeof f->volume,
      .scalars = volume->extinction,
      .type = CHI_F32,
      .stride = sizeof(float),
      .dimensions = { volume->n[0], volume->n[1], volume->n[2] },
      .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
      .interpolation = CHI_LINEAR,
      .version = 1 };
    f->frame.volume = &f->volume;
    f->frame.transfer = &f->transfer;
  }
}

chi_status reference_probe(const chi_exec* exec, chi_occlusion* engine, reference_frame* f,
  const reference_view* view, const reference_points* points, float* visibility)
{
  double* const position = malloc((points->count + 1) * 3 * sizeof(double));
  if (!position)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < points->count; ++i)
  {
    project(view, points->position + 3 * i, position + 3 * i);
  }
  f->probes = (chi_occlusion_probes){ position, visibility, points->count };
  f->frame.probes = &f->probes;
  const chi_status status = chi_occlusion_render(exec, engine, &f->frame);
  f->frame.probes = NULL;
  free(position);
  return status;
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

reference_error reference_compare(
  const float* visibility, const double* exact, size_t count, double* work)
{
  reference_error e = { 0, 0, 0, 0, 0 };
  for (size_t i = 0; i < count; ++i)
  {
    const double d = (double)visibility[i] - exact[i];
    work[i] = fabs(d);
    e.mean += work[i] / (double)count;
    e.bias += d / (double)count;
    e.rms += d * d / (double)count;
  }
  e.rms = sqrt(e.rms);
  qsort(work, count, sizeof(double), ascending);
  if (count)
  {
    e.p99 = work[(size_t)(0.99 * (double)(count - 1) + 0.5)];
    e.max = work[count - 1];
  }
  return e;
}
