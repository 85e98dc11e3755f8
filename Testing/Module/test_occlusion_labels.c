/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Labels: of voxels that choose among transfer functions, and as samples of their own. */

#include "occlusion_blobs.h"

enum
{
  VOXELS = N * N * N,
  TABLES = 3
};

/* Three tables over the blobs: blue to yellow, red, green; of different opacity. */
static const float rgb[6 * TABLES] = { 0.2f, 0.4f, 0.9f, 1, 0.8f, 0.3f, 1, 0, 0, 1, 0, 0, 0, 1, 0,
  0, 1, 0 };
static const float opacity[2 * TABLES] = { 0, 0.3f, 0.1f, 0.2f, 0.05f, 0.4f };
static const uint8_t table_of_value[6] = { 0, 2, 0, 1, 0, 2 };

static void label_with(scene* s, chi_mask_view* view, const uint8_t* values)
{
  s->transfer.rgb = rgb;
  s->transfer.opacity = opacity;
  s->transfer.table_count = TABLES;
  *view = (chi_mask_view){ .struct_size = sizeof *view,
    .values = values,
    .type = CHI_U8,
    .stride = 1,
    .version = 1,
    .table_of_value = table_of_value,
    .value_count = sizeof table_of_value };
  s->frame.mask = view;
}

static void use_table(scene* s, int table)
{
  s->transfer.rgb = rgb + 6 * table;
  s->transfer.opacity = opacity + 2 * table;
}

static void one_label_everywhere_is_its_table_alone(void)
{
  static uint8_t values[VOXELS];
  for (int label = 0; label < 8; ++label)
  {
    scene* const s = make_whole(label & 1);
    scene* const t = make_whole(label & 1);
    chi_mask_view view;
    memset(values, label, sizeof values);
    label_with(s, &view, values);
    use_table(t, label < 6 ? table_of_value[label] : 0);
    const chi_occlusion_image a = render(s), b = render(t);
    CHECK_NEAR(difference(&a, &b), 0, 1e-5); /* table positions are floats of up to 6: 5e-7 */
    free_scene(t);
    free_scene(s);
  }
}

static void each_ray_sees_the_table_of_its_own_voxels(void)
{
  static uint8_t values[VOXELS];
  scene* const s = make_whole(1);
  chi_mask_view view;
  for (size_t n = 0; n < VOXELS; ++n)
  {
    const size_t i = n % N, j = n / N % N;
    values[n] = (uint8_t)(i < 15 ? 0 : j < 22 ? 3 : 5);
  }
  label_with(s, &view, values);
  s->params.strength = 0;
  const chi_occlusion_image image = render(s);
  int compared = 0;
  for (int table = 0; table < TABLES; ++table)
  {
    scene* const t = make_whole(1);
    t->params.strength = 0;
    use_table(t, table);
    const chi_occlusion_image alone = render(t);
    double worst = 0;
    for (int pixel = 0; pixel < PIXELS; ++pixel)
    {
      /* where the ray runs, in voxels; rays run along z */
      const double i = -30 + (pixel % WIDTH + 0.5) * 60 / WIDTH + 0.5 * (N - 1);
      const double j = -30 + (pixel / WIDTH + 0.5) * 60 / WIDTH + 0.5 * (N - 1);
      if ((i < 14.5 ? 0 : j < 21.5 ? 1 : 2) == table && i >= 0 && i <= N - 1)
      {
        ++compared;
        for (int c = 0; c < 4; ++c)
        {
          worst = fmax(
            worst, fabs((double)image.rgba[4 * pixel + c] - (double)alone.rgba[4 * pixel + c]));
        }
      }
    }
    CHECK_NEAR(worst, 0, 1e-5); /* as above */
    free_scene(t);
  }
  CHECK(compared > 3000);
  free_scene(s);
}

static void layers_of_labels_have_the_thickness_of_their_tables_and_no_colour_between(void)
{
  /* Layers of three voxels across the view, one scalar: red and blue in turns, green between them
   * in the table of tables. */
  static uint8_t values[VOXELS];
  const float three[6 * TABLES] = { 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1 };
  const float alpha[2 * TABLES] = { 0.02f, 0.02f, 0.9f, 0.9f, 0.05f, 0.05f };
  scene* const s = make_whole(1);
  chi_mask_view view;
  int layers[2] = { 0, 0 };
  for (size_t n = 0; n < VOXELS; ++n)
  {
    const size_t k = n / (N * N);
    values[n] = (uint8_t)(k / 3 % 2); /* tables 0 and 2 */
    layers[k / 3 % 2] += n % (N * N) == 0;
  }
  label_with(s, &view, values);
  s->transfer.rgb = three;
  s->transfer.opacity = alpha;
  s->frame.surface = NULL;
  s->params.strength = 0;
  const chi_occlusion_image image = render(s);
  const float* const p = image.rgba + 4 * (WIDTH / 2 * WIDTH + WIDTH / 2);
  CHECK(p[0] > 0.1f && p[2] > 0.1f);
  CHECK(p[1] == 0);
  /* N - 1 segments; each has the label at its far end, the farthest (k = 0) or the nearest layer
   * has no segment of its own */
  const double thin = -log(1 - 0.02), thick = -log(1 - 0.05);
  const double most = 1 - exp(-thin * (layers[0] - 1) - thick * layers[1]);
  const double least = 1 - exp(-thin * layers[0] - thick * (layers[1] - 1));
  CHECK(fabs((double)p[3] - most) < 1e-5 || fabs((double)p[3] - least) < 1e-5);
  free_scene(s);
}

static void transparent_labels_draw_nothing_and_darken_nothing(void)
{
  static uint8_t values[VOXELS];
  const float clear[2 * TABLES] = { 0.3f, 0.3f, 0, 0, 0, 0 };
  scene* const s = make_whole(0);
  chi_mask_view view;
  chi_occlusion_stats stats;
  memset(values, 3, sizeof values);
  label_with(s, &view, values);
  s->transfer.opacity = clear;
  for (int skip = 0; skip < 2; ++skip)
  {
    s->params.skip = skip;
    const chi_occlusion_image image = render(s);
    double most = 0, darkest = 1;
    for (int i = 0; i < PIXELS; ++i)
    {
      most = fmax(most, (double)image.rgba[4 * i + 3]);
      darkest = fmin(darkest, (double)image.visibility[i]);
    }
    chi_occlusion_get_stats(s->engine, &stats);
    CHECK(most == 0 && darkest < 0.95 && stats.occupied_bricks == 0);
  }
  /* half of it: bricks of the transparent label are not sampled */
  for (size_t n = 0; n < VOXELS; ++n)
  {
    values[n] = n % N < N / 2 ? 3 : 0;
  }
  ++view.version;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.occupied_bricks > 0 && stats.occupied_bricks < stats.bricks * 8 / 10);
  free_scene(s);
}

static void skipping_and_schedules_change_nothing(void)
{
  static uint8_t values[VOXELS];
  for (int k = 0; k < 4; ++k)
  {
    scene* const s = make_whole(k & 1);
    scene* const t = make_whole(k & 1);
    chi_mask_view view;
    for (size_t n = 0; n < VOXELS; ++n)
    {
      values[n] = (uint8_t)((n % N / 5 + n / N % N / 7 + n / (N * N) / 9) % 6);
    }
    label_with(s, &view, values);
    label_with(t, &view, values);
    s->params.sample_distance = t->params.sample_distance = k < 2 ? 1 : 5; /* and across bricks */
    const chi_occlusion_image a = render(s);
    const chi_exec backwards = { .struct_size = sizeof backwards,
      .parallel_for = chi_test_backwards };
    chi_occlusion_image b;
    CHECK(chi_occlusion_render(&backwards, t->engine, &t->frame) == CHI_OK);
    chi_occlusion_get_image(t->engine, &b);
    CHECK(memcmp(a.rgba, b.rgba, 4 * PIXELS * sizeof(float)) == 0);
    CHECK(memcmp(a.visibility, b.visibility, PIXELS * sizeof(float)) == 0);
    t->params.skip = 0;
    b = render(t);
    CHECK(difference(&a, &b) <= 1.0 / 255); /* the bound */
    free_scene(t);
    free_scene(s);
  }
}

static void bad_labels_are_refused_and_odd_values_take_the_first_table(void)
{
  static float values[VOXELS];
  scene* const s = make_whole(1);
  scene* const t = make_whole(1);
  chi_mask_view view;
  static const float odd[4] = { NAN, -1, 6, 1e30f };
  for (size_t n = 0; n < VOXELS; ++n)
  {
    values[n] = odd[n % 4];
  }
  label_with(s, &view, (const uint8_t*)values);
  view.type = CHI_F32;
  view.stride = sizeof(float);
  use_table(t, 0);
  const chi_occlusion_image a = render(s), b = render(t);
  CHECK_NEAR(difference(&a, &b), 0, 1e-5);
  s->transfer.table_count = 2; /* one label names the third */
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->transfer.table_count = 257;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  free_scene(t);
  free_scene(s);
}

static void labels_of_nearest_interpolation_do_not_blend(void)
{
  /* Labels 1 and 3 in turns, the opacity of 2 between them: a table entry that no sample has. */
  scene* const s = make_whole(1);
  float rgb[15] = { 0 }, opacity[5] = { 0, 0.3f, 0.9f, 0.1f, 0 };
  rgb[3] = 1;  /* label 1: red */
  rgb[7] = 1;  /* label 2: green */
  rgb[11] = 1; /* label 3: blue */
  s->transfer.rgb = rgb;
  s->transfer.opacity = opacity;
  s->transfer.count = 5;
  s->transfer.range[0] = 0;
  s->transfer.range[1] = 4;
  for (int i = 0; i < N * N * N; ++i)
  {
    s->samples[i] = i / (N * N) & 1 ? 1 : 3; /* layers across the view */
  }
  s->volume.interpolation = CHI_NEAREST;
  s->frame.surface = NULL;
  s->params.strength = 0;
  const chi_occlusion_image image = render(s);
  const float* const p = image.rgba + 4 * (WIDTH / 2 * WIDTH + WIDTH / 2);
  CHECK(p[0] > 0.1f && p[2] > 0.1f);
  CHECK(p[1] == 0); /* no label 2 anywhere */
  /* one segment a layer but the nearest: 20 of 3, 19 of 1, in any order, until less than 0.002 is
   * left */
  CHECK_NEAR((double)p[3], 1, 0.0021);
  free_scene(s);
}

int main(void)
{
  one_label_everywhere_is_its_table_alone();
  each_ray_sees_the_table_of_its_own_voxels();
  layers_of_labels_have_the_thickness_of_their_tables_and_no_colour_between();
  transparent_labels_draw_nothing_and_darken_nothing();
  skipping_and_schedules_change_nothing();
  bad_labels_are_refused_and_odd_values_take_the_first_table();
  labels_of_nearest_interpolation_do_not_blend();
  return chi_test_report();
}
