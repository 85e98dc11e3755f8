/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_internal.h"
#include "math/chi_mat4.h"

#include <math.h>
#include <string.h>

static int all_of(const double* x, int count, double least)
{
  for (int i = 0; i < count; ++i)
  {
    if (!(isfinite(x[i]) && x[i] >= least))
    {
      return 0;
    }
  }
  return 1;
}

static double length3(const double v[3])
{
  const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
  double sum = 0; /* relative to the largest: squares overflow */
  for (int i = 0; i < 3 && largest > 0; ++i)
  {
    sum += v[i] / largest * (v[i] / largest);
  }
  return largest * sqrt(sum);
}

static int light_is_valid(const chi_shading_light* l)
{
  const int positional = l->kind == CHI_LIGHT_POSITIONAL;
  return l->kind >= CHI_LIGHT_EYE && l->kind <= CHI_LIGHT_POSITIONAL && all_of(l->diffuse, 3, 0) &&
    all_of(l->specular, 3, 0) &&
    (l->kind == CHI_LIGHT_EYE ||
      (all_of(l->direction, 3, -INFINITY) && length3(l->direction) > 0)) &&
    (!positional ||
      (all_of(l->position, 3, -INFINITY) && all_of(l->attenuation, 3, 0) &&
        all_of(&l->cone_angle_rad, 1, 0) && all_of(&l->exponent, 1, 0)));
}

int chi_shading_is_valid(const chi_shading_view* s)
{
  if (!s)
  {
    return 1;
  }
  if (!all_of(&s->ambient, 1, 0) || !all_of(&s->diffuse, 1, 0) || !all_of(&s->specular, 1, 0) ||
    !all_of(&s->specular_power, 1, 0) || !all_of(s->ambient_light, 3, 0) ||
    s->light_count > CHI_MAX_LIGHTS || (s->light_count && !s->lights))
  {
    return 0;
  }
  for (size_t i = 0; i < s->light_count; ++i)
  {
    if (!light_is_valid(s->lights + i))
    {
      return 0;
    }
  }
  return 1;
}

int chi_gradient_opacity_is_valid(const chi_transfer_view* t)
{
  return !t->gradient_opacity ||
    (t->gradient_count >= 2 && t->gradient_count <= 65536 && t->gradient_end > 0 &&
      isfinite(t->gradient_end));
}

void chi_shading_make_key(chi_shading_key* key, const chi_shading_view* s)
{
  memset(key, 0, sizeof *key);
  key->light_count = -1;
  if (s)
  {
    const double material[7] = { s->ambient, s->diffuse, s->specular, s->specular_power,
      s->ambient_light[0], s->ambient_light[1], s->ambient_light[2] };
    memcpy(key->material, material, sizeof material);
    key->two_sided = s->two_sided != 0;
    key->unclamped = s->unclamped != 0;
    key->light_count = (int64_t)s->light_count;
    if (s->light_count)
    {
      memcpy(key->light, s->lights, s->light_count * sizeof(chi_shading_light));
    }
  }
}

static void prepare_light(
  chi_plan_light* out, const chi_shading_light* l, double diffuse, double specular)
{
  const int positional = l->kind == CHI_LIGHT_POSITIONAL;
  const double length = l->kind == CHI_LIGHT_EYE ? 1 : length3(l->direction);
  const double* const a = l->attenuation;
  out->kind = (int32_t)l->kind;
  for (int c = 0; c < 3; ++c)
  {
    out->direction[c] = (float)(l->direction[c] / length);
    out->position[c] = (float)l->position[c];
    out->diffuse[c] = (float)(l->diffuse[c] * diffuse);
    out->specular[c] = (float)(l->specular[c] * specular);
    out->attenuation[c] = (float)a[c];
  }
  if (a[0] == 0 && a[1] == 0 && a[2] == 0)
  {
    out->attenuation[0] = 1;
  }
  const double right = 1.57079632679489662 * (1 + 1e-12); /* 90 degrees in whatever rounding */
  const int spot = positional && l->cone_angle_rad > 0 && l->cone_angle_rad <= right;
  out->cone_cosine = spot ? (float)fmax(cos(l->cone_angle_rad), 0) : -1;
  out->exponent = (float)l->exponent;
}

static void prepare_material(chi_plan_shading* out, const chi_shading_view* s)
{
  out->lit = 1;
  out->two_sided = s->two_sided != 0;
  out->ambient = (float)s->ambient;
  out->power = (float)s->specular_power;
  out->limit = s->unclamped ? INFINITY : 1;
  out->light_count = (int32_t)s->light_count;
  for (int c = 0; c < 3; ++c)
  {
    out->ambient_light[c] = (float)s->ambient_light[c];
  }
  for (size_t i = 0; i < s->light_count; ++i)
  {
    const chi_shading_light* const l = s->lights + i;
    prepare_light(out->light + i, l, s->diffuse, s->specular);
    out->shiny |= s->specular > 0 && l->specular[0] + l->specular[1] + l->specular[2] > 0;
  }
}

int chi_shading_prepare(chi_plan_shading* out, const chi_occlusion_frame* frame,
  const chi_bricks* bricks, const chi_classification* classification, int* needed)
{
  const chi_transfer_plane* const plane = &classification->plane;
  const chi_transfer_view* const t = frame->transfer;
  memset(out, 0, sizeof *out);
  *needed = frame->shading != NULL || t->gradient_opacity != NULL || t->plane != NULL;
  if (!*needed)
  {
    return 1;
  }
  const double range = t->range[1] - t->range[0];
  double to_eye[16], to_index[16], edges = 0;
  chi_mat4_multiply(frame->camera->world_to_eye, frame->volume->index_to_world, to_eye);
  if (!chi_mat4_invert_affine(to_eye, to_index))
  {
    return 0;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double edge[3] = { to_eye[a], to_eye[4 + a], to_eye[8 + a] };
    edges += length3(edge) / 3;
  }
  for (int c = 0; c < 3; ++c)
  {
    for (int a = 0; a < 4; ++a)
    {
      out->to_eye[c][a] = (float)to_eye[4 * c + a];
    }
    for (int a = 0; a < 3; ++a)
    {
      /* A gradient is a covector: it goes with the inverse transpose. Along an axis of one sample
       * there is no difference. */
      const double share =
        bricks->dimensions[a] > 1 ? 0.5 * edges / (range * bricks->copy_scale) : 0;
      out->gradient[c][a] = (float)(share * to_index[4 * a + c]);
    }
  }
  if (t->plane)
  {
    /* y_samples in their own units, gradients in shares of the scalar's range */
    const double entries = (double)(plane->count[1] - 1);
    const double scale = entries / (t->plane_range[1] - t->plane_range[0]);
    out->plane_table = (const chi_plan_entry*)plane->sigma.data;
    out->plane_rgba = (const float(*)[4])plane->rgba.data;
    out->plane_quantum = plane->quantum;
    out->plane_second = t->y_samples;
    out->plane_row = (int32_t)plane->count[0];
    out->plane_base = (float)(t->plane_range[0] / (t->y_samples ? 1 : range));
    out->plane_scale = (float)(scale * (t->y_samples ? 1 : range));
    out->plane_end = (float)entries;
  }
  else if (t->gradient_opacity)
  {
    out->gradient_opacity = (const float*)classification->gradient_opacity.data;
    out->gradient_end = (float)(t->gradient_count - 1);
    out->gradient_scale = (float)((double)(t->gradient_count - 1) * (range / t->gradient_end));
  }
  if (frame->shading)
  {
    prepare_material(out, frame->shading);
  }
  return 1;
}
