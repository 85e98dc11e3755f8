/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The gradient of a linear field is one vector a tetrahedron, so is what lights make of it: a
 * factor of the albedo and a highlight, taken at the centre of gravity.
 */
#include "chi_tet_internal.h"

#include <math.h>

typedef struct shade_job
{
  const chi_tet_mesh* mesh;
  const chi_tet_values* values;
  const chi_tet_point* points;
  const uint32_t* in_tile;
  const chi_shading_view* shading;
  int parallel;
  size_t chunk;
  float (*shades)[6];
} shade_job;

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* 0 where it has no length. */
static int normalize(double v[3])
{
  const double length = sqrt(dot(v, v));
  for (int k = 0; k < 3 && length > 0; ++k)
  {
    v[k] /= length;
  }
  return length > 0;
}

/* Eye coordinates of a point, which look along -z. */
static void place(const chi_tet_point* p, double out[3])
{
  out[0] = p->x;
  out[1] = p->y;
  out[2] = -p->z;
}

/* Direction of the gradient; zero where there is none. */
static void find_normal(const chi_tet_point* const p[4], double normal[3])
{
  double at[4][3], e[3][3], n[3][3];
  for (int i = 0; i < 4; ++i)
  {
    place(p[i], at[i]);
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      e[i][k] = at[i + 1][k] - at[0][k];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    const double *const a = e[(i + 1) % 3], *const b = e[(i + 2) % 3];
    n[i][0] = a[1] * b[2] - a[2] * b[1];
    n[i][1] = a[2] * b[0] - a[0] * b[2];
    n[i][2] = a[0] * b[1] - a[1] * b[0];
  }
  const double side = dot(e[0], n[0]) < 0 ? -1 : 1; /* whose size the direction does not need */
  for (int k = 0; k < 3; ++k)
  {
    normal[k] = 0;
    for (int i = 0; i < 3; ++i)
    {
      normal[k] += side * ((double)p[i + 1]->scalar - p[0]->scalar) * n[i][k];
    }
  }
  if (!normalize(normal))
  {
    normal[0] = normal[1] = normal[2] = 0;
  }
}

/* How much of a light reaches a point, and in which direction it travels there. */
static double reach(
  const chi_shading_light* light, const double at[3], const double view[3], double travel[3])
{
  if (light->kind != CHI_LIGHT_POSITIONAL)
  {
    memcpy(travel, light->kind == CHI_LIGHT_EYE ? view : light->direction, 3 * sizeof(double));
    normalize(travel);
    return 1;
  }
  double axis[3];
  memcpy(axis, light->direction, sizeof axis);
  normalize(axis);
  for (int k = 0; k < 3; ++k)
  {
    travel[k] = at[k] - light->position[k];
  }
  const double far = sqrt(dot(travel, travel));
  normalize(travel);
  const double* const a = light->attenuation;
  const double fades = a[0] + far * (a[1] + far * a[2]);
  const double cosine = dot(travel, axis);
  const int spot = light->cone_angle_rad > 0 && light->cone_angle_rad <= 1.5707963267948966;
  if (spot && cosine < cos(light->cone_angle_rad))
  {
    return 0;
  }
  return (spot ? pow(cosine, light->exponent) : 1) / (fades > 0 ? fades : 1);
}

static void add_light(const chi_shading_view* s, const chi_shading_light* light,
  const double normal[3], const double at[3], const double view[3], double diffuse[3],
  double specular[3])
{
  double travel[3];
  const double reaches = reach(light, at, view, travel);
  const double cosine = dot(normal, travel);
  const double facing = s->two_sided ? fabs(cosine) : cosine;
  if (!(facing > 0 && reaches > 0))
  {
    return;
  }
  /* r = 2 (n.l) n - l with one factor turned round, the other not: VTK's rule */
  const double factor = light->kind == CHI_LIGHT_EYE ? cosine : facing;
  const double square = 1 + 4 * factor * (factor - cosine);
  double mirrored = (2 * factor * dot(normal, view) - dot(travel, view)) / sqrt(fmax(square, 0));
  mirrored = s->two_sided && light->kind == CHI_LIGHT_POSITIONAL ? fabs(mirrored) : mirrored;
  const double shine = mirrored > 0 && s->specular > 0 ? pow(mirrored, s->specular_power) : 0;
  for (int k = 0; k < 3; ++k)
  {
    diffuse[k] += s->diffuse * facing * reaches * light->diffuse[k];
    specular[k] += s->specular * reaches * shine * light->specular[k];
  }
}

static void shade(const shade_job* it, size_t t)
{
  const chi_shading_view* const s = it->shading;
  const uint32_t* const v = (const uint32_t*)it->mesh->vertices.data + 4 * t;
  const chi_tet_point* const p[4] = { it->points + v[0], it->points + v[1], it->points + v[2],
    it->points + v[3] };
  double normal[3] = { 0, 0, 0 }, at[3] = { 0, 0, 0 };
  if (!it->values->is_cell_data)
  {
    find_normal(p, normal);
  }
  for (int i = 0; i < 4; ++i)
  {
    double corner[3];
    place(p[i], corner);
    for (int k = 0; k < 3; ++k)
    {
      at[k] += 0.25 * corner[k];
    }
  }
  double view[3] = { 0, 0, -1 };
  if (!it->parallel)
  {
    memcpy(view, at, sizeof view);
    normalize(view);
  }
  double diffuse[3] = { s->ambient, s->ambient, s->ambient };
  double specular[3] = { s->ambient_light[0], s->ambient_light[1], s->ambient_light[2] };
  for (size_t i = 0; i < s->light_count; ++i)
  {
    add_light(s, s->lights + i, normal, at, view, diffuse, specular);
  }
  for (int k = 0; k < 3; ++k)
  {
    it->shades[t][k] = (float)diffuse[k];
    it->shades[t][3 + k] = (float)specular[k];
  }
}

static void shade_chunk(void* data, size_t begin, size_t end)
{
  const shade_job* const it = (const shade_job*)data;
  const size_t count = it->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    for (size_t t = chunk * it->chunk; t < count && t < (chunk + 1) * it->chunk; ++t)
    {
      if (it->in_tile[t / 32] >> t % 32 & 1)
      {
        shade(it, t);
      }
    }
  }
}

chi_status chi_tet_shade(const chi_exec* exec, chi_buffer* shades, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_eye* eye, const chi_tet_bins* bins,
  const chi_tet_frame* frame)
{
  const size_t count = mesh->counts.tetrahedra;
  if (!chi_buffer_reserve(exec, shades, count, 6 * sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  shade_job job = { mesh, values, (const chi_tet_point*)eye->points.data,
    (const uint32_t*)bins->in_tile.data, frame->shading, frame->camera->parallel != 0,
    (count + CHI_TET_CHUNKS - 1) / CHI_TET_CHUNKS, (float(*)[6])shades->data };
  return chi_for(exec, CHI_TET_CHUNKS, shade_chunk, &job);
}
