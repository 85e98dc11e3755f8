/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cropping regions: what they take is as if it were not in the data. */

#include "occlusion_blobs.h"

enum
{
  FENCE = 0x2ebfeba, /* the names and values of vtkVolumeMapper */
  INVERTED_FENCE = 0x5140145,
  CROSS = 0x0417410,
  INVERTED_CROSS = 0x7be8bef,
  CENTRE = 1 << 13
};

static void every_region_alone_is_the_cut_data(void)
{
  /* cuts on samples, so that the data can be cut there as well */
  static const double low[3] = { 11, 8, 14 }, high[3] = { 24, 30, 27 };
  for (int k = 0; k < 54; ++k)
  {
    const int region = k % 27, parallel = k < 27,
              at[3] = { region % 3, region / 3 % 3, region / 9 };
    size_t first[3], count[3];
    for (int a = 0; a < 3; ++a)
    {
      const size_t edge[4] = { 0, (size_t)low[a], (size_t)high[a], N - 1 };
      first[a] = edge[at[a]];
      count[a] = edge[at[a] + 1] - first[a] + 1;
    }
    scene* const cut = make_whole(parallel);
    scene* const less = make_scene(parallel, first, count);
    chi_crop_view view;
    crop(cut, &view, low, high, UINT32_C(1) << region);
    const chi_occlusion_image a = render(cut), b = render(less);
    double most = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      most = fmax(most, (double)a.rgba[4 * i + 3]);
    }
    CHECK(most > 0.3);
    /* Positions are floats of up to 40 voxels, 4e-6, times the steepest opacity; some sums round so
     */
    CHECK_NEAR(difference(&a, &b), 0, 1e-4);
    free_scene(less);
    free_scene(cut);
  }
}

/* Length of a ray p + t d, 0 <= t <= 1, in the regions that stay, in units of t: brute force over
 * all 27 boxes. */
static double length_by_boxes(
  const double p[3], const double d[3], const double low[3], const double high[3], uint32_t regions)
{
  double length = 0;
  for (int region = 0; region < 27; ++region)
  {
    if (!(regions >> region & 1))
    {
      continue;
    }
    const int at[3] = { region % 3, region / 3 % 3, region / 9 };
    double from = 0, to = 1;
    for (int a = 0; a < 3; ++a)
    {
      const double edge[4] = { 0, low[a], high[a], N - 1 };
      const double t0 = (edge[at[a]] - p[a]) / d[a], t1 = (edge[at[a] + 1] - p[a]) / d[a];
      from = fmax(from, fmin(t0, t1));
      to = fmin(to, fmax(t0, t1));
    }
    length += to > from ? to - from : 0;
  }
  return length;
}

static void in_fog_every_set_of_regions_leaves_the_length_that_its_boxes_have(void)
{
  /* nothing lies on samples; the second pair is closer than a slice */
  static const double low[3] = { 11.3, 17.2, 14.8 }, high[3] = { 24.6, 17.9, 27.1 };
  static const uint32_t sets[] = { FENCE, INVERTED_FENCE, CROSS, INVERTED_CROSS, CENTRE,
    CHI_CROP_ALL_REGIONS & ~CENTRE, 0x5555555, 0x2aaaaaa, 0x1234567, 0x7fedcba };
  for (size_t k = 0; k < sizeof sets / sizeof sets[0]; ++k)
  {
    scene* const s = make_whole(k & 1);
    s->frame.surface = NULL;
    s->opacity[0] = s->opacity[1] = 0.02f;
    const double sigma = -log(1 - 0.02);
    look_askew(s);
    chi_crop_view view;
    crop(s, &view, low, high, sets[k]);
    if (k == 3) /* slices of any distance */
    {
      s->params.sample_distance = 0.37;
    }
    const chi_occlusion_image image = render(s);
    double worst = 0;
    int cut = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      double p[3], d[3];
      const double scale = askew_ray(s, i, p, d);
      const double all = length_by_boxes(p, d, low, high, CHI_CROP_ALL_REGIONS);
      const double length = length_by_boxes(p, d, low, high, sets[k]);
      const double exact = 1 - exp(-sigma * length * scale);
      worst = fmax(worst, fabs((double)image.rgba[4 * i + 3] - exact));
      cut += length > 0 && length < 0.999 * all;
    }
    /* positions are floats of up to 140, 8e-6, at seven cuts a ray; 110 sums of floats, 6e-8 each
     */
    CHECK_NEAR(worst, 0, 3e-5);
    CHECK(cut > (sets[k] == CENTRE || sets[k] == (CHI_CROP_ALL_REGIONS & ~CENTRE) ? 40 : 1000));
    free_scene(s);
  }
}

static void regions_that_do_not_touch_are_composited(void)
{
  static const double low[3] = { 11.3, 12.2, 14.8 }, high[3] = { 24.6, 27.4, 27.1 };
  uint32_t corners = 0;
  for (int k = 0; k < 8; ++k)
  {
    corners |= UINT32_C(1) << (2 * (k & 1) + 6 * (k >> 1 & 1) + 18 * (k >> 2));
  }
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    static double through[PIXELS];
    scene* const s = make_whole(parallel);
    chi_crop_view view;
    s->frame.surface = NULL;
    for (int i = 0; i < PIXELS; ++i)
    {
      through[i] = 1;
    }
    for (int region = 0; region < 27; ++region)
    {
      if (corners >> region & 1)
      {
        crop(s, &view, low, high, UINT32_C(1) << region);
        const chi_occlusion_image one = render(s);
        for (int i = 0; i < PIXELS; ++i)
        {
          through[i] *= 1 - (double)one.rgba[4 * i + 3];
        }
      }
    }
    crop(s, &view, low, high, corners);
    const chi_occlusion_image all = render(s);
    double worst = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      worst = fmax(worst, fabs(1 - (double)all.rgba[4 * i + 3] - through[i]));
    }
    CHECK_NEAR(worst, 0, 2e-6); /* products of up to 26 floats */
    free_scene(s);
  }
}

static void skipping_and_schedules_change_nothing(void)
{
  static const double low[3] = { 11.3, 12.2, 14.8 }, high[3] = { 24.6, 27.4, 27.1 };
  static const uint32_t sets[] = { FENCE, INVERTED_CROSS, 0x1234567 };
  for (int k = 0; k < 3; ++k)
  {
    scene* const s = make_whole(k & 1);
    scene* const t = make_whole(k & 1);
    chi_crop_view view;
    s->opacity[1] = t->opacity[1] = 0.9f;
    crop(s, &view, low, high, sets[k]);
    crop(t, &view, low, high, sets[k]);
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

static void regions_of_a_mirrored_volume_lie_where_its_data_lie(void)
{
  static const double low[3] = { 11.3, 12.2, 14.8 }, high[3] = { 24.6, 27.4, 27.1 };
  scene* const s = make_whole(0);
  scene* const t = make_whole(0);
  chi_crop_view view;
  crop(s, &view, low, high, 0x1234567);
  crop(t, &view, low, high, 0x1234567);
  for (int k = 0; k < N; ++k) /* the same data from the other end */
  {
    for (int j = 0; j < N; ++j)
    {
      for (int i = 0; i < N; ++i)
      {
        t->samples[(N - 1 - i) + N * (j + N * k)] = s->samples[i + N * (j + N * k)];
      }
    }
  }
  t->volume.index_to_world[0] = -1;
  t->volume.index_to_world[3] += N - 1;
  const chi_occlusion_image a = render(s), b = render(t);
  CHECK_NEAR(difference(&a, &b), 0, 1e-4); /* positions in float, as above */
  free_scene(t);
  free_scene(s);
}

static void all_regions_are_the_plain_picture_and_none_is_the_geometry_alone(void)
{
  static const double low[3] = { 11, 8, 14 }, high[3] = { 24, 30, 27 };
  scene* const s = make_whole(0);
  scene* const t = make_whole(0);
  chi_crop_view view;
  chi_occlusion_stats stats;
  const chi_occlusion_image plain = render(s);
  crop(t, &view, low, high, CHI_CROP_ALL_REGIONS);
  chi_occlusion_image image = render(t);
  CHECK(memcmp(plain.rgba, image.rgba, 4 * PIXELS * sizeof(float)) == 0);
  crop(t, &view, low, high, 0);
  for (int skip = 0; skip < 2; ++skip)
  {
    t->params.skip = skip;
    image = render(t);
    chi_occlusion_get_stats(t->engine, &stats);
    double most = 0, darkest = 1;
    for (int i = 0; i < PIXELS; ++i)
    {
      most = fmax(most, (double)image.rgba[4 * i + 3]);
      darkest = fmin(darkest, (double)image.visibility[i]);
    }
    CHECK(most == 0 && stats.samples == 0);
    CHECK(darkest < 0.95); /* the near surface still shades the far one */
  }
  free_scene(t);
  free_scene(s);
}

static void other_regions_render_anew_and_equal_ones_do_not(void)
{
  static const double low[3] = { 11, 8, 14 }, high[3] = { 24, 30, 27 };
  scene* const s = make_whole(1);
  chi_crop_view view, copy;
  chi_occlusion_stats stats;
  crop(s, &view, low, high, FENCE);
  render(s);
  copy = view;
  s->frame.crop = &copy;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused);
  copy.regions = CROSS;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(!stats.reused && stats.reused_classification);
  copy.planes[0][3] -= 1;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(!stats.reused && stats.reused_classification);
  copy.planes[0][0] = 0; /* no direction */
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  copy.planes[0][0] = NAN;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  free_scene(s);
}

int main(void)
{
  every_region_alone_is_the_cut_data();
  in_fog_every_set_of_regions_leaves_the_length_that_its_boxes_have();
  regions_that_do_not_touch_are_composited();
  skipping_and_schedules_change_nothing();
  regions_of_a_mirrored_volume_lie_where_its_data_lie();
  all_regions_are_the_plain_picture_and_none_is_the_geometry_alone();
  other_regions_render_anew_and_equal_ones_do_not();
  return chi_test_report();
}
