/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Clip planes: what they cut away is as if it were not in the data. */

#include "occlusion_blobs.h"

static const double pi = 3.14159265358979324;

static void the_picture_is_that_of_the_cut_data(void)
{
  /* axis, which side stays */
  for (int k = 0; k < 12; ++k)
  {
    const int axis = k / 2 % 3, upper = k & 1, parallel = k < 6;
    scene* const cut = make_whole(parallel);
    size_t first[3] = { 0, 0, 0 }, count[3] = { N, N, N };
    first[axis] = upper ? CUT : 0;
    count[axis] = upper ? N - CUT : CUT + 1;
    scene* const less = make_scene(parallel, first, count);
    const double at = cut->volume.index_to_world[4 * axis + 3] + CUT;
    double plane[4] = { 0, 0, 0, upper ? -at : at };
    plane[axis] = upper ? 1 : -1;
    /* a plane's length does not matter */
    add_plane(cut, 3 * plane[0], 3 * plane[1], 3 * plane[2], 3 * plane[3]);
    const chi_occlusion_image a = render(cut), b = render(less);
    scene* const whole = make_whole(parallel);
    const chi_occlusion_image c = render(whole);
    /* Positions are floats of up to 40 voxels, 4e-6, times the steepest opacity; some sums round so
     */
    CHECK(difference(&a, &b) < 1e-4);
    CHECK(difference(&a, &c) > 0.1);
    free_scene(whole);
    free_scene(less);
    free_scene(cut);
  }
}

static void an_oblique_cut_leaves_the_length_that_geometry_says(void)
{
  scene* const s = make_whole(1);
  s->frame.surface = NULL;
  s->opacity[0] = s->opacity[1] = 0.02f;
  const double sigma = -log(1 - 0.02), half = 0.5 * (N - 1);
  /* two planes; z runs from -100 - half to -100 + half */
  add_plane(s, 0.5, 0.2, 1, 100 + 3);
  add_plane(s, 0.3, -0.4, -1, -100 + 9);
  const chi_occlusion_image image = render(s);
  double worst = 0;
  int cut = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    const double x = -30 + (i % WIDTH + 0.5) * 60 / WIDTH, y = -30 + (i / WIDTH + 0.5) * 60 / WIDTH;
    const double low = fmax(-half, -3 - 0.5 * x - 0.2 * y);
    const double high = fmin(half, 9 + 0.3 * x - 0.4 * y);
    const double length = fabs(x) < half && fabs(y) < half && high > low ? high - low : 0;
    const double exact = 1 - exp(-sigma * length);
    worst = fmax(worst, fabs((double)image.rgba[4 * i + 3] - exact));
    cut += length > 0 && length < 2 * half;
  }
  CHECK(worst < 2e-5); /* entry and exit are floats of up to 40 slices: 4e-6 each; 40 sums */
  CHECK(cut > 1000);
  free_scene(s);
}

/* What planes of one slab make of a face that lies obliquely to them: the optical depth, of unit
 * extinction, that a direction meets in front of the middle of a slab, which lies `depth` slabs
 * behind the face. A column of a slab counts by what it holds, its last one by half of it, wherever
 * in it the matter lies. From slab to slab the face is left behind by `pace`: 1 - gradient of the
 * face x slope of the direction. */
static double depth_in_columns(double depth, double pace)
{
  double sum = 0.5 * fmin(fmax(depth + 0.5, 0), 1);
  for (double far = depth + 0.5 - pace; far > 0; far -= pace)
  {
    sum += fmin(far, 1);
  }
  return sum;
}

/* Colour of white matter behind a face `phase` behind a slice, lit as above. */
static double color_behind_face(double sigma, double phase, const double gradient[2])
{
  double clear = 1, color = 0;
  for (int slab = 0; slab < 64; ++slab)
  {
    const double through = exp(-sigma * (slab ? 1 : 1 - phase));
    const double depth = slab - 2 + 0.5 - phase; /* matter reads its light two voxels in front */
    double light = 0;
    for (int m = 0; m < 16; ++m) /* theory/occlusion.md, Eq. 2 */
    {
      const double mu = 1 - (1 - cos(0.25 * pi)) * (m + 0.5) / 16;
      const double slope = sqrt(1 - mu * mu) / mu, azimuth = m * pi * (3 - sqrt(5)) + 4.8;
      const double pace = 1 + slope * (cos(azimuth) * gradient[0] - sin(azimuth) * gradient[1]);
      light += exp(-sigma / mu * depth_in_columns(depth, pace)) / 16;
    }
    color += clear * (1 - through) * light;
    clear *= through;
  }
  return color;
}

/* theory/occlusion.md, "Stripes on oblique faces": why there are any, and how many. */
static void an_oblique_face_has_the_stripes_of_its_columns_and_no_more(void)
{
  static const double tilt[3][2] = { { 0.02, 0.01 }, { 0.36, 0.25 }, { -0.3, 0.8 } };
  for (int k = 0; k < 9; ++k)
  {
    const double* const a = tilt[k % 3];
    const double sigma = 0.5 + 0.5 * (k / 3);
    scene* const s = make_whole(1);
    s->frame.surface = NULL;
    s->params.bias = -1;
    s->params.half_size = 0;
    s->opacity[0] = s->opacity[1] = (float)(1 - exp(-sigma));
    memset(s->rgb, 0, sizeof s->rgb);
    s->rgb[0] = s->rgb[3] = 1;
    add_plane(s, -a[0], -a[1], -1, -100); /* in front of it, at depth 100 + a x, nothing is left */
    const chi_occlusion_image image = render(s);
    const double half = 0.5 * (N - 1), first = 100 - half * fmin(fabs(a[0]) + fabs(a[1]), 1);
    double worst = 0, low = 1, high = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      const double x = -30 + (i % WIDTH + 0.5) * 60 / WIDTH,
                   y = -30 + (i / WIDTH + 0.5) * 60 / WIDTH;
      if (fmax(fabs(x), fabs(y)) < 6)
      {
        const double face = 100 + a[0] * x + a[1] * y - first;
        const double expected = color_behind_face(sigma, face - floor(face), a);
        worst = fmax(worst, fabs((double)image.rgba[4 * i] - expected));
        low = fmin(low, (double)image.rgba[4 * i]);
        high = fmax(high, (double)image.rgba[4 * i]);
      }
    }
    /* Between columns light is read bilinearly: a step of thickness is bent by the gradient twice,
     * and a chord over one pixel of 0.83 misses an eighth of the bend, 0.09 at gradient 0.85, of
     * planes that are seen with exp(-2 sigma) at most: 0.09 x 0.37 = 8/255, at one phase in three
     * planes or fewer. Found: 0.6. */
    CHECK(worst < 1.0 / 255);
    /* the largest of the closed form over all phases up to 45 degrees, at sigma 1.25: 4.9 */
    CHECK(high - low < 5.0 / 255);
    CHECK(high - low > 0.4 / 255); /* else the closed form says nothing here */
    free_scene(s);
  }
}

static void skipping_changes_no_pixel(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_whole(parallel);
    scene* const t = make_whole(parallel);
    for (int k = 0; k < 2; ++k)
    {
      scene* const u = k ? t : s;
      u->opacity[1] = 0.9f;
      u->params.skip = k;
      add_plane(u, 0.5, 0.2, 1, 100 + 3);
      add_plane(u, 0.1, -1, 0.3, 12 + 30);
    }
    const chi_occlusion_image a = render(s), b = render(t);
    CHECK(difference(&a, &b) <= 1.0 / 255); /* the bound */
    free_scene(t);
    free_scene(s);
  }
}

static void planes_that_cut_all_or_nothing(void)
{
  scene* const s = make_whole(0);
  scene* const t = make_whole(0);
  add_plane(t, 0, 0, 1, 500);
  const chi_occlusion_image a = render(s), b = render(t);
  CHECK(difference(&a, &b) < 1e-6);
  add_plane(t, 0, 0, -1, -500);
  const chi_occlusion_image none = render(t);
  chi_occlusion_stats stats;
  chi_occlusion_get_stats(t->engine, &stats);
  double most = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    most = fmax(most, (double)none.rgba[4 * i + 3]);
  }
  CHECK(most == 0 && stats.samples == 0);
  t->frame.volume = NULL; /* geometry shades itself as if there were no volume */
  t->params.sample_distance = 1;
  const chi_occlusion_image alone = render(t);
  CHECK(alone.visibility[WIDTH / 2 * WIDTH + 22] < 0.95f);
  free_scene(t);
  free_scene(s);
}

static void a_moved_plane_renders_anew_and_an_equal_one_does_not(void)
{
  scene* const s = make_whole(1);
  chi_occlusion_stats stats;
  add_plane(s, 1, 0, 0, 0);
  render(s);
  double copy[4];
  memcpy(copy, s->planes, sizeof copy);
  s->frame.clip_planes = copy;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused);
  copy[3] = 1;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(!stats.reused && stats.reused_classification);
  free_scene(s);
}

static void bad_planes_are_refused(void)
{
  scene* const s = make_whole(1);
  add_plane(s, 0, 0, 0, 1);
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->planes[0] = NAN;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->planes[0] = 1;
  s->frame.clip_plane_count = CHI_MAX_CLIP_PLANES + 1;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->frame.clip_plane_count = 1;
  s->frame.clip_planes = NULL;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  free_scene(s);
}

int main(void)
{
  the_picture_is_that_of_the_cut_data();
  an_oblique_cut_leaves_the_length_that_geometry_says();
  an_oblique_face_has_the_stripes_of_its_columns_and_no_more();
  skipping_changes_no_pixel();
  planes_that_cut_all_or_nothing();
  a_moved_plane_renders_anew_and_an_equal_one_does_not();
  bad_planes_are_refused();
  return chi_test_report();
}
