/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Samples of several components: closed forms of even volumes, any type, what is refused. */

#include "chi_test.h"
#include "occlusion_reference.h"

enum
{
  SIDE = 12,
  DEPTH = 9, /* samples along z: the light path is 8 voxels */
  SAMPLES = SIDE * SIDE * DEPTH,
  PICTURE = 16,
  MIDDLE = 4 * (PICTURE / 2 * PICTURE + PICTURE / 2),
  ENTRIES = 257
};

/* Opacity a voxel is `high` times the scalar / 255, colours run from `from` to `to`. */
typedef struct ramp_functions
{
  float rgb[3 * ENTRIES], opacity[ENTRIES];
  chi_transfer_view view;
} ramp_functions;

static void make_functions(ramp_functions* t, double high, const double from[3], const double to[3])
{
  for (int i = 0; i < ENTRIES; ++i)
  {
    const double s = (double)i / (ENTRIES - 1);
    t->opacity[i] = (float)-expm1(-high * s);
    for (int c = 0; c < 3; ++c)
    {
      t->rgb[3 * i + c] = (float)(from[c] + s * (to[c] - from[c]));
    }
  }
  t->view = (chi_transfer_view){ .struct_size = sizeof t->view,
    .rgb = t->rgb,
    .opacity = t->opacity,
    .count = ENTRIES,
    .range = { 0, 255 },
    .unit_distance = 1,
    .version = 1 };
}

static const double colors[4][2][3] = { { { 0.1, 0.2, 0.9 }, { 1, 0.6, 0.1 } },
  { { 0.9, 0.1, 0.2 }, { 0.2, 1, 0.4 } }, { { 0.2, 0.8, 0.8 }, { 0.9, 0.9, 0.1 } },
  { { 0.7, 0.2, 0.9 }, { 0.3, 0.4, 0.2 } } };
static const double highs[4] = { 0.2, 0.3, 0.1, 0.25 };

typedef struct component_scene
{
  reference_frame frame;
  ramp_functions functions[4];
  chi_components components;
  chi_occlusion* engine;
  double scalars[4 * SAMPLES]; /* room for any type */
} component_scene;

static void store(void* out, chi_type type, size_t i, double value)
{
  switch (type)
  {
    case CHI_U8:
      ((uint8_t*)out)[i] = (uint8_t)value;
      break;
    case CHI_I16:
      ((int16_t*)out)[i] = (int16_t)value;
      break;
    case CHI_U16:
      ((uint16_t*)out)[i] = (uint16_t)value;
      break;
    case CHI_I32:
      ((int32_t*)out)[i] = (int32_t)value;
      break;
    case CHI_F32:
      ((float*)out)[i] = (float)value;
      break;
    default:
      ((double*)out)[i] = value;
      break;
  }
}

/* Even samples of `count` components. */
static component_scene* scene_create(int count, int dependent, chi_type type, const double* value)
{
  component_scene* const s = calloc(1, sizeof *s);
  if (!s || chi_occlusion_create(NULL, &s->engine) != CHI_OK)
  {
    CHECK(0);
    free(s);
    return NULL;
  }
  for (size_t i = 0; i < SAMPLES * (size_t)count; ++i)
  {
    store(s->scalars, type, i, value[i % (size_t)count]);
  }
  const double center[3] = { 0.5 * (SIDE - 1), 0.5 * (SIDE - 1), 0.5 * (DEPTH - 1) };
  const double turn[2] = { 0, 0 };
  const reference_view view = reference_turned_view(center, 40, turn, 8, PICTURE, 1);
  reference_frame_init(&s->frame, NULL, &view, 255);
  s->frame.volume = (chi_volume_view){ .struct_size = sizeof s->frame.volume,
    .scalars = s->scalars,
    .type = type,
    .stride = (size_t)count * chi_type_size(type),
    .dimensions = { SIDE, SIDE, DEPTH },
    .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  s->frame.params.strength = 0;
  s->components = (chi_components){ .struct_size = sizeof s->components,
    .count = count,
    .dependent = dependent,
    .weight = { 1, 1, 1, 1 } };
  for (int k = 0; k < 4; ++k)
  {
    make_functions(&s->functions[k], highs[k], colors[k][0], colors[k][1]);
    if (k > 0)
    {
      s->components.transfer[k - 1] = &s->functions[k].view;
    }
  }
  s->frame.frame.volume = &s->frame.volume;
  s->frame.frame.transfer = &s->functions[0].view;
  s->frame.frame.components = &s->components;
  return s;
}

static void scene_free(component_scene* s)
{
  if (s)
  {
    chi_occlusion_destroy(NULL, s->engine);
    free(s);
  }
}

static const float* render(component_scene* s)
{
  chi_occlusion_image image = { 0 };
  const chi_status status = chi_occlusion_render(NULL, s->engine, &s->frame.frame);
  CHECK(status == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  return status == CHI_OK ? image.rgba : NULL;
}

/* Colour of a component of an even volume. */
static double color_of(int component, double value, int channel)
{
  const double s = value / 255;
  return colors[component][0][channel] +
    s * (colors[component][1][channel] - colors[component][0][channel]);
}

/* sigma = sum s^2 / sum w s, emission = sum w s c: alpha = 1 - e^(-8 sigma), colour = emission /
 * sigma alpha, whatever the distance of the slices. */
static void independent_components_have_their_closed_form(void)
{
  static const double value[4] = { 100, 180, 30, 255 };
  static const double weight[3][4] = { { 1, 1, 1, 1 }, { 1, 0.5, 0.2, 0.7 }, { 0, 1, 0, 0.3 } };
  static const chi_type types[6] = { CHI_U8, CHI_I16, CHI_U16, CHI_I32, CHI_F32, CHI_F64 };
  for (int count = 2; count <= 4; ++count)
  {
    for (int k = 0; k < 6; ++k)
    {
      component_scene* const s = scene_create(count, 0, types[k], value);
      for (int w = 0; s && w < 3; ++w)
      {
        double squares = 0, weighted = 0, emission[3] = { 0, 0, 0 };
        for (int c = 0; c < count; ++c)
        {
          const double sigma = highs[c] * value[c] / 255;
          s->components.weight[c] = weight[w][c];
          squares += weight[w][c] > 0 ? sigma * sigma : 0;
          weighted += weight[w][c] * sigma;
          for (int j = 0; j < 3; ++j)
          {
            emission[j] += weight[w][c] * sigma * color_of(c, value[c], j);
          }
        }
        const double all = squares / weighted, alpha = -expm1(-8 * all);
        s->frame.params.sample_distance = w == 0 ? 1 : 0.37;
        const float* const rgba = render(s);
        /* colours are those of the nearest of 257 entries; the rest is rounding of float */
        CHECK_NEAR((double)rgba[MIDDLE + 3], alpha, 2e-5);
        for (int j = 0; j < 3; ++j)
        {
          CHECK_NEAR((double)rgba[MIDDLE + j], emission[j] / all * alpha, 0.5 / 256 + 2e-5);
        }
      }
      scene_free(s);
    }
  }
}

static void dependent_components_have_their_closed_form(void)
{
  static const double two[2] = { 90, 200 }, four[4] = { 51, 204, 128, 200 };
  const double alpha = -expm1(-8 * highs[0] * 200 / 255);
  for (int k = 0; k < 2; ++k)
  {
    const chi_type type = k ? CHI_F32 : CHI_U8;
    component_scene* s = scene_create(2, 1, type, two);
    const float* rgba = s ? render(s) : NULL;
    for (int j = 0; rgba && j < 3; ++j)
    {
      CHECK_NEAR((double)rgba[MIDDLE + j], alpha * color_of(1, 90, j), 0.5 / 256 + 2e-5);
    }
    CHECK_NEAR(rgba ? (double)rgba[MIDDLE + 3] : 0, alpha, 2e-5);
    scene_free(s);
    double value[4];
    for (int j = 0; j < 4; ++j)
    {
      value[j] = k && j < 3 ? four[j] / 255 : four[j]; /* floats are colours already */
    }
    s = scene_create(4, 1, type, value);
    rgba = s ? render(s) : NULL;
    for (int j = 0; rgba && j < 3; ++j)
    {
      CHECK_NEAR((double)rgba[MIDDLE + j], alpha * four[j] / 255, 2e-5);
    }
    CHECK_NEAR(rgba ? (double)rgba[MIDDLE + 3] : 0, alpha, 2e-5);
    scene_free(s);
  }
}

/* Light behind an even slab of two components: V = e^(-sigma length), straight ahead. */
static void light_takes_the_extinction_of_all_components(void)
{
  static const double value[2] = { 120, 200 };
  component_scene* const s = scene_create(2, 0, CHI_U8, value);
  if (s)
  {
    double squares = 0, weighted = 0;
    s->components.weight[1] = 0.5;
    for (int c = 0; c < 2; ++c)
    {
      const double sigma = highs[c] * value[c] / 255;
      squares += sigma * sigma;
      weighted += s->components.weight[c] * sigma;
    }
    const double position[3] = { 8, 8, 40 + 4 - 0.5 }; /* half a voxel before the rear face */
    float visibility = 0;
    s->frame.params.strength = 1;
    s->frame.params.cone_angle_rad = 1 * 0.017453292519943295;
    s->frame.params.directions = 4;
    s->frame.probes = (chi_occlusion_probes){ position, &visibility, 1 };
    s->frame.frame.probes = &s->frame.probes;
    render(s);
    /* between planes of light V is linear: sigma^2 / 8 of it */
    const double sigma = squares / weighted, expected = exp(-7.5 * sigma);
    CHECK_NEAR((double)visibility, expected, expected * (sigma * sigma / 8 + 1e-3));
  }
  scene_free(s);
}

/* A component of weight 0 is as if it were not there, to the bit; so is any number of schedules. */
static void a_component_of_weight_zero_is_not_there(void)
{
  static const double value[2] = { 120, 200 };
  component_scene* const s = scene_create(2, 0, CHI_F32, value);
  static float first[4 * PICTURE * PICTURE];
  if (s)
  {
    s->components.weight[1] = 0;
    memcpy(first, render(s), sizeof first);
    s->functions[1].view.version = 2;
    for (int i = 0; i < ENTRIES; ++i)
    {
      s->functions[1].opacity[i] = 1;
    }
    CHECK(memcmp(first, render(s), sizeof first) == 0);
    s->components.weight[1] = 0.5;
    CHECK(memcmp(first, render(s), sizeof first) != 0); /* a changed weight is a new picture */
    const chi_exec backwards = { .struct_size = sizeof backwards,
      .parallel_for = chi_test_backwards };
    memcpy(first, render(s), sizeof first);
    s->frame.params.bias = 0.7; /* nothing of an unshaded picture depends on it */
    CHECK(chi_occlusion_render(&backwards, s->engine, &s->frame.frame) == CHI_OK);
    chi_occlusion_image image;
    chi_occlusion_get_image(s->engine, &image);
    CHECK(memcmp(first, image.rgba, sizeof first) == 0);
  }
  scene_free(s);
}

static void a_component_that_is_not_finite_makes_its_cells_transparent(void)
{
  static const double value[2] = { 120, 200 };
  for (int component = 0; component < 2; ++component)
  {
    for (int dependent = 0; dependent < 2; ++dependent)
    {
      component_scene* const s = scene_create(2, dependent, CHI_F32, value);
      if (!s)
      {
        continue;
      }
      const float before = render(s)[MIDDLE + 3];
      for (size_t i = 0; i < SAMPLES; ++i)
      {
        if (i / (SIDE * SIDE) >= 4)
        {
          ((float*)(void*)s->scalars)[2 * i + (size_t)component] = i & 1 ? NAN : INFINITY;
        }
      }
      s->frame.volume.version = 2;
      const float* const rgba = render(s);
      for (int i = 0; i < 4 * PICTURE * PICTURE; ++i)
      {
        CHECK(isfinite(rgba[i]));
      }
      /* of eight voxels three are left, less the slice that lies on the first such sample's cell */
      const double left = log1p(-(double)rgba[MIDDLE + 3]) / log1p(-(double)before);
      CHECK(left > 2.0 / 8 - 1e-6 && left < 3.0 / 8 + 1e-6);
      chi_occlusion_stats stats;
      chi_occlusion_get_stats(s->engine, &stats);
      CHECK(stats.non_finite_samples == 5 * SIDE * SIDE);
      scene_free(s);
    }
  }
}

static void what_makes_no_sense_is_refused(void)
{
  static const double value[4] = { 100, 100, 100, 100 };
  component_scene* const s = scene_create(4, 0, CHI_U8, value);
  if (s)
  {
#define REFUSED(member, wrong)                                                                     \
  do                                                                                               \
  {                                                                                                \
    const component_scene keep = *s;                                                               \
    s->member = wrong;                                                                             \
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame.frame) == CHI_ERROR_INVALID_ARGUMENT);   \
    s->components = keep.components;                                                               \
    s->frame.volume = keep.frame.volume;                                                           \
  } while (0)
    REFUSED(components.count, 5);
    REFUSED(components.count, 1);
    REFUSED(components.weight[1], -0.1);
    REFUSED(components.weight[3], (double)NAN);
    REFUSED(components.transfer[2], NULL);
    REFUSED(frame.volume.stride, 3);
    s->components.dependent = 1;
    REFUSED(components.count, 3);
#undef REFUSED
    const chi_shading_view shading = { .struct_size = sizeof shading };
    s->frame.frame.shading = &shading;
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame.frame) == CHI_ERROR_INVALID_ARGUMENT);
    s->frame.frame.shading = NULL;
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame.frame) == CHI_OK);
  }
  scene_free(s);
}

static void a_refused_allocation_leaves_the_engine_usable(void)
{
  static const double value[4] = { 100, 150, 200, 250 };
  for (int64_t at = 0; at < 200; ++at)
  {
    component_scene* const s = scene_create(4, 0, CHI_I32, value);
    if (!s)
    {
      return;
    }
    chi_occlusion_destroy(NULL, s->engine);
    s->engine = NULL;
    chi_test_host host = { .refuse_at = -1, .cancel_at = INT32_MAX };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    CHECK(chi_occlusion_create(&exec, &s->engine) == CHI_OK);
    host.refuse_at = host.allocations + (int)at;
    const chi_status status = chi_occlusion_render(&exec, s->engine, &s->frame.frame);
    CHECK(status == CHI_OK || status == CHI_ERROR_OUT_OF_MEMORY);
    host.refuse_at = -1;
    CHECK(chi_occlusion_render(&exec, s->engine, &s->frame.frame) == CHI_OK);
    chi_occlusion_destroy(&exec, s->engine);
    s->engine = NULL;
    CHECK(host.live == 0);
    scene_free(s);
    if (status == CHI_OK)
    {
      return;
    }
  }
}

int main(void)
{
  independent_components_have_their_closed_form();
  dependent_components_have_their_closed_form();
  light_takes_the_extinction_of_all_components();
  a_component_of_weight_zero_is_not_there();
  a_component_that_is_not_finite_makes_its_cells_transparent();
  what_makes_no_sense_is_refused();
  a_refused_allocation_leaves_the_engine_usable();
  return chi_test_report();
}
