/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Structs of callers who were compiled for another version of the library: shorter ones, whose lack
 * is the default, and longer ones. Each lies in memory of just its size, for the sanitizers to see.
 */

#include "occlusion_blobs.h"

#include <chiaroscuro/chi_occlusion_plan.h>
#include <chiaroscuro/chi_spline.h>
#include <chiaroscuro/chi_tube.h>

enum
{
  MORE = 24 /* bytes that a version to come might append */
};

/* sizeof where the member is the last. */
#define END(type, member) ((offsetof(type, member) + sizeof(((type*)0)->member) + 7) / 8 * 8)

/* The first `size` bytes of a struct as a struct of that size; `last`: what stands in its last byte
 * where it is longer. */
static void* resize(const void* whole, size_t whole_size, size_t size, unsigned char last)
{
  unsigned char* const block = calloc(1, size);
  if (!block)
  {
    exit(1);
  }
  memcpy(block, whole, size < whole_size ? size : whole_size);
  if (size > whole_size)
  {
    block[size - 1] = last;
  }
  memcpy(block, &size, sizeof size);
  return block;
}

/* One of a frame's structs: where its pointer stands, its sizes by version; the first is the least,
 * the last is that of today. `defaults` is what a lack is filled from, NULL: zero. */
typedef struct versions
{
  size_t place, size[12], count;
  const void* defaults;
} versions;

static void check_struct(scene* s, const versions* v)
{
  const size_t now = v->size[v->count - 1];
  const void** const place = (const void**)(void*)((char*)&s->frame + v->place);
  const void* const given = *place;
  CHECK(given != NULL);
  float* const expected = malloc(5 * PIXELS * sizeof *expected);
  for (size_t k = 0; k < v->count && expected; ++k)
  {
    char* const filled = calloc(1, now);
    void* const shorter = resize(given, now, v->size[k], 0);
    if (!filled)
    {
      exit(1);
    }
    if (v->defaults)
    {
      memcpy(filled, v->defaults, now);
    }
    memcpy(filled, given, v->size[k]);
    *place = filled;
    chi_occlusion_image image = render(s);
    memcpy(expected, image.rgba, 4 * PIXELS * sizeof *expected);
    memcpy(expected + 4 * PIXELS, image.visibility, PIXELS * sizeof *expected);
    const uint64_t features = chi_occlusion_features(&s->frame);
    *place = shorter;
    image = render(s);
    CHECK(memcmp(expected, image.rgba, 4 * PIXELS * sizeof *expected) == 0);
    CHECK(memcmp(expected + 4 * PIXELS, image.visibility, PIXELS * sizeof *expected) == 0);
    CHECK(chi_occlusion_features(&s->frame) == features);
    free(filled);
    free(shorter);
  }
  /* longer; longer with something in it; too short; without a member; odd; nonsense */
  const size_t sizes[] = { now + MORE, now + MORE, v->size[0] - 8, sizeof(size_t), now - 4, now };
  for (int k = 0; k < 6; ++k)
  {
    void* const other = resize(given, now, sizes[k], k == 1);
    const size_t said = k == 5 ? SIZE_MAX - 7 : sizes[k];
    memcpy(other, &said, sizeof said);
    const chi_status wanted = k == 0 ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT;
    chi_occlusion_plan plan;
    float* const depth = malloc(PIXELS * sizeof *depth);
    *place = other;
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == wanted);
    CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &plan) == wanted);
    CHECK(depth && chi_occlusion_find_depth(NULL, s->engine, &s->frame, 0.5, depth) == wanted);
    CHECK(
      (chi_occlusion_features(&s->frame) & CHI_FEATURE_OTHER) == (k == 0 ? 0 : CHI_FEATURE_OTHER));
    free(depth);
    free(other);
  }
  *place = given;
  free(expected);
}

#define PLACE(member) offsetof(chi_occlusion_frame, member)

static void structs_of_older_frames_have_defaults_for_what_they_lack(void)
{
  scene* const s = make_whole(0);
  chi_occlusion_params defaults;
  memset(&defaults, 0, sizeof defaults);
  chi_occlusion_default_params(&defaults);
  /* nothing is as the defaults have it, so that it shows what has been read */
  s->params.combine = CHI_COMBINE_MINIMUM;
  s->params.geometry_opacity = 0.4;
  s->params.vicinity_samples = 20;
  s->params.reduction = 2;
  s->params.vicinity_distance = 4;
  s->params.vicinity_bias = 0.5;
  s->params.light_direction[0] = s->params.light_direction[2] = 0.5;
  s->params.second_light_direction[1] = s->params.second_light_direction[2] = 0.5;
  s->params.second_light_cone_angle_rad = 0.5;
  s->params.second_light_share = 0.3;
  s->params.attenuation[0] = 0.2;
  s->params.attenuation[1] = 0.6;
  s->params.attenuation[2] = 0.9;
  s->params.colored_attenuation = 1;
  s->params.color_integration = CHI_COLOR_MIDDLE;
  s->params.coarsening = 2;
  static const float ramp[2] = { 0.2f, 1 };
  s->transfer.gradient_opacity = ramp;
  s->transfer.gradient_count = 2;
  s->transfer.gradient_end = 1;
  s->transfer.table_count = 1;
  float* const end = malloc(PIXELS * sizeof *end);
  float* const rgba = calloc(4 * PIXELS, sizeof *rgba);
  for (int i = 0; i < PIXELS && end && rgba; ++i)
  {
    end[i] = s->depth[i] + 4;
    rgba[4 * i] = rgba[4 * i + 3] = 0.4f;
  }
  s->surface.end = end;
  s->surface.edge_depth = s->depth;
  s->surface.edge_rgba = rgba;
  const chi_layers_view layers = {
    .struct_size = sizeof layers, .depth = s->depth, .rgba = rgba, .count = 1
  };
  s->frame.layers = &layers;
  chi_crop_view regions;
  static const double low[3] = { 8, 8, 8 }, high[3] = { 30, 30, 30 };
  crop(s, &regions, low, high, 0x5ffffff);
  const chi_shading_light lamp = {
    .kind = CHI_LIGHT_EYE, .diffuse = { 1, 1, 1 }, .specular = { 1, 1, 1 }
  };
  const chi_shading_view shading = { .struct_size = sizeof shading,
    .ambient = 0.3,
    .diffuse = 0.6,
    .specular = 0.2,
    .specular_power = 5,
    .lights = &lamp,
    .light_count = 1 };
  s->frame.shading = &shading;
  static uint8_t shown[N * N * N];
  memset(shown, 1, sizeof shown);
  memset(shown, 0, sizeof shown / 3);
  const chi_mask_view mask = {
    .struct_size = sizeof mask, .values = shown, .type = CHI_U8, .stride = 1, .version = 1
  };
  s->frame.mask = &mask;
  add_plane(s, 0.2, 0.1, -1, -92);

#define P(member) END(chi_occlusion_params, member)
  const versions all[] = {
    { PLACE(camera), { sizeof(chi_camera) }, 1, NULL },
    { PLACE(volume), { sizeof(chi_volume_view) }, 1, NULL },
    { PLACE(transfer),
      { END(chi_transfer_view, version), END(chi_transfer_view, gradient_end),
        END(chi_transfer_view, y_samples), sizeof(chi_transfer_view) },
      4, NULL },
    { PLACE(surface),
      { END(chi_surface_view, version), END(chi_surface_view, end), sizeof(chi_surface_view) }, 3,
      NULL },
    { PLACE(params),
      { P(skip), P(combine), P(geometry_opacity), P(vicinity_samples), P(reduction),
        P(vicinity_distance), P(vicinity_bias), P(light_direction), P(second_light_share),
        P(colored_attenuation), P(color_integration), sizeof(chi_occlusion_params) },
      12, &defaults },
    { PLACE(layers), { END(chi_layers_view, count), sizeof(chi_layers_view) }, 2, NULL },
    { PLACE(crop), { END(chi_crop_view, regions), sizeof(chi_crop_view) }, 2, NULL },
    { PLACE(shading), { sizeof(chi_shading_view) }, 1, NULL },
    { PLACE(mask), { END(chi_mask_view, version), sizeof(chi_mask_view) }, 2, NULL },
  };
#undef P
  for (size_t k = 0; k < sizeof all / sizeof all[0]; ++k)
  {
    check_struct(s, all + k);
  }
  free(end);
  free(rgba);
  free_scene(s);
}

static void older_frames_lack_what_came_later(void)
{
#define F(member) END(chi_occlusion_frame, member)
  static const size_t size[] = { F(probes), F(clip_plane_count), F(layers), F(crop), F(shading),
    F(mask), sizeof(chi_occlusion_frame) };
#undef F
  scene* const s = make_whole(1);
  add_plane(s, 0.2, 0.1, -1, -92);
  chi_crop_view regions;
  static const double low[3] = { 8, 8, 8 }, high[3] = { 30, 30, 30 };
  crop(s, &regions, low, high, 0x5ffffff);
  static uint8_t hidden[N * N * N];
  const chi_mask_view mask = {
    .struct_size = sizeof mask, .values = hidden, .type = CHI_U8, .stride = 1, .version = 1
  };
  s->frame.mask = &mask;
  float* const first = malloc(4 * PIXELS * sizeof *first);
  int changes = 0;
  for (size_t k = 0; k < sizeof size / sizeof size[0] && first; ++k)
  {
    chi_occlusion_frame filled = { .struct_size = sizeof filled };
    memcpy((char*)&filled + sizeof(size_t), (const char*)&s->frame + sizeof(size_t),
      size[k] - sizeof(size_t));
    void* const shorter = resize(&s->frame, sizeof s->frame, size[k], 0);
    CHECK(chi_occlusion_render(NULL, s->engine, &filled) == CHI_OK);
    chi_occlusion_image image;
    chi_occlusion_get_image(s->engine, &image);
    changes += k && memcmp(first, image.rgba, 4 * PIXELS * sizeof *first) != 0;
    memcpy(first, image.rgba, 4 * PIXELS * sizeof *first);
    CHECK(chi_occlusion_render(NULL, s->engine, (const chi_occlusion_frame*)shorter) == CHI_OK);
    chi_occlusion_get_image(s->engine, &image);
    CHECK(memcmp(first, image.rgba, 4 * PIXELS * sizeof *first) == 0);
    free(shorter);
  }
  CHECK(changes == 3); /* clip planes, regions, mask */
  for (int k = 0; k < 3; ++k)
  {
    void* const other =
      resize(&s->frame, sizeof s->frame, k == 0 ? size[0] - 8 : sizeof s->frame + MORE, k == 2);
    CHECK(chi_occlusion_render(NULL, s->engine, (const chi_occlusion_frame*)other) ==
      (k == 1 ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT));
    free(other);
  }
  free(first);
  free_scene(s);
}

static void components_functions_may_be_older(void)
{
  scene* const s = make_whole(1);
  static float two[2 * N * N * N];
  for (int i = 0; i < 2 * N * N * N; ++i)
  {
    two[i] = s->samples[i / 2] * (i & 1 ? 0.5f : 1);
  }
  s->volume.scalars = two;
  s->volume.stride = 2 * sizeof(float);
  void* const older = resize(&s->transfer, sizeof s->transfer, END(chi_transfer_view, version), 0);
  const chi_components components = { .struct_size = sizeof components,
    .count = 2,
    .transfer = { (const chi_transfer_view*)older, (const chi_transfer_view*)"not looked at" },
    .weight = { 1, 1 } };
  void* const longer = resize(&components, sizeof components, sizeof components + MORE, 0);
  s->frame.components = (const chi_components*)longer;
  CHECK(render(s).rgba[4 * (PIXELS / 2 + WIDTH / 2) + 3] > 0);
  const size_t nonsense = 9;
  memcpy(older, &nonsense, sizeof nonsense);
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  free(older);
  free(longer);
  free_scene(s);
}

static void splines_and_tubes_take_older_structs(void)
{
  double x[40][3];
  for (int i = 0; i < 40; ++i)
  {
    x[i][0] = 0.2 * i;
    x[i][1] = sin(0.2 * i);
    x[i][2] = cos(0.3 * i);
  }
  const int64_t offsets[2] = { 0, 40 };
  const chi_lines_view lines = {
    .points = { x, 40, sizeof x[0], CHI_F64 }, .offsets = offsets, .line_count = 1
  };
  chi_spline* spline = NULL;
  chi_tube* tube = NULL;
  CHECK(chi_spline_create(NULL, &spline) == CHI_OK && chi_tube_create(NULL, &tube) == CHI_OK);
  const chi_spline_params fit = { .struct_size = sizeof fit,
    .tolerance = 1e-3,
    .method = CHI_SPLINE_LEAST_SQUARES,
    .coefficients = 7 };
  const size_t sizes[] = { sizeof fit, END(chi_spline_params, merge_distance),
    END(chi_spline_params, max_halvings), sizeof fit + MORE };
  size_t counts[2];
  for (int k = 0; k < 4; ++k)
  {
    void* const other = resize(&fit, sizeof fit, sizes[k], 0);
    const chi_status wanted = k == 2 ? CHI_ERROR_INVALID_ARGUMENT : CHI_OK;
    CHECK(chi_spline_fit(NULL, spline, &lines, (const chi_spline_params*)other) == wanted);
    chi_spline_stats stats;
    chi_spline_get_stats(spline, &stats);
    counts[k & 1] = stats.coefficients;
    CHECK(k != 1 || counts[0] == 7);
    CHECK(k != 1 || counts[1] > 7); /* as many as the tolerance asks for */
    free(other);
  }
  const chi_tube_params params = { .struct_size = sizeof params,
    .radius = 0.1,
    .sides = 6,
    .chord_tolerance = 0.01,
    .angular_tolerance_rad = 0.3 };
  const chi_tube_outputs outputs = { .struct_size = sizeof outputs };
  for (int k = 0; k < 3; ++k)
  {
    const size_t more = k == 1 ? MORE : 0, less = k == 2 ? sizeof(double) : 0;
    void* const p = resize(&params, sizeof params, sizeof params + more - less, 0);
    void* const o = resize(&outputs, sizeof outputs, sizeof outputs + more - less, 0);
    const chi_status wanted = k == 2 ? CHI_ERROR_INVALID_ARGUMENT : CHI_OK;
    CHECK(chi_tube_sweep(NULL, tube, (const chi_tube_outputs*)o) ==
      (k == 0 ? CHI_ERROR_NOT_READY : wanted));
    CHECK(chi_tube_plan(NULL, tube, spline, &lines, (const chi_tube_params*)p) == wanted);
    free(p);
    free(o);
  }
  chi_tube_destroy(NULL, tube);
  chi_spline_destroy(NULL, spline);
}

int main(void)
{
  structs_of_older_frames_have_defaults_for_what_they_lack();
  older_frames_lack_what_came_later();
  components_functions_may_be_older();
  splines_and_tubes_take_older_structs();
  return chi_test_report();
}
