/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Masks of voxels and cells: what they take is as if it were not in the data. */

#include "occlusion_blobs.h"

enum
{
  VOXELS = N * N * N,
  HIDDEN = 2
};

static const double sigma = 0.020202707317519466; /* -ln(1 - 0.02) */

static int on(size_t i, size_t j, size_t k, uint32_t seed)
{
  uint32_t state = (uint32_t)(i + 131 * j + 17161 * k) * 2654435761u + seed;
  chi_test_random(&state);
  return chi_test_random(&state) < 0.5;
}

/* A binary mask of the blobs: f(i, j, k) of every voxel. */
static void mask_with(scene* s, chi_mask_view* view, uint8_t* values)
{
  *view = (chi_mask_view){
    .struct_size = sizeof *view, .values = values, .type = CHI_U8, .stride = 1, .version = 1
  };
  s->frame.mask = view;
}

static void a_mask_of_a_box_of_voxels_is_that_box_cropped(void)
{
  static uint8_t values[VOXELS];
  for (int k = 0; k < 6; ++k)
  {
    const size_t first[3] = { 11, 8, 14 }, last[3] = { 24, 30, 27 };
    const double low[3] = { 10.5, 7.5, 13.5 }, high[3] = { 24.5, 30.5, 27.5 };
    scene* const masked = make_whole(k & 1);
    scene* const cropped = make_whole(k & 1);
    for (size_t n = 0; n < VOXELS; ++n)
    {
      const size_t at[3] = { n % N, n / N % N, n / (N * N) };
      int inside = 1;
      for (int a = 0; a < 3; ++a)
      {
        inside &= at[a] >= first[a] && at[a] <= last[a];
      }
      values[n] = (uint8_t)(inside == (k < 4)) * 7;
    }
    chi_mask_view view;
    chi_crop_view crops;
    mask_with(masked, &view, values);
    crop(cropped, &crops, low, high,
      k < 4 ? UINT32_C(1) << 13 : CHI_CROP_ALL_REGIONS & ~(UINT32_C(1) << 13));
    if (k & 2)
    {
      look_askew(masked);
      look_askew(cropped);
      masked->frame.surface = cropped->frame.surface = NULL;
    }
    const chi_occlusion_image a = render(masked), b = render(cropped);
    /* Positions are floats of up to 40 voxels, 4e-6, times the steepest opacity; some sums round so
     */
    CHECK_NEAR(difference(&a, &b), 0, 1e-4);
    free_scene(cropped);
    free_scene(masked);
  }
}

static void masked_nearest_samples_are_the_cut_data(void)
{
  /* of cells, so that both end half a sample beyond the outermost ones */
  static uint8_t values[VOXELS];
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    const size_t first[3] = { 9, 5, 0 }, count[3] = { 21, 30, N };
    scene* const masked = make_whole(parallel);
    scene* const less = make_scene(parallel, first, count);
    for (size_t n = 0; n < VOXELS; ++n)
    {
      const size_t i = n % N, j = n / N % N;
      values[n] = i >= 9 && i < 30 && j >= 5 && j < 35;
    }
    chi_mask_view view;
    mask_with(masked, &view, values);
    masked->volume.is_cell_data = less->volume.is_cell_data = 1;
    masked->volume.interpolation = less->volume.interpolation = CHI_NEAREST;
    const chi_occlusion_image a = render(masked), b = render(less);
    /* Boundaries of voxels are floats of 40: 4e-6 of a voxel; a ray through an edge may change
     * sides there, of few of the 5000 */
    int differ = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      double most = fabs((double)a.visibility[i] - (double)b.visibility[i]);
      for (int c = 0; c < 4; ++c)
      {
        most = fmax(most, fabs((double)a.rgba[4 * i + c] - (double)b.rgba[4 * i + c]));
      }
      differ += most > 1e-4;
    }
    CHECK(differ == 0);
    free_scene(less);
    free_scene(masked);
  }
}

/* Length of a ray in the cells of a grid that stay, in units of t: cell by cell. Cell (i, j, k)
 * begins at index position (i, j, k) - offset; the ray ends at the volume's box. */
static double length_in_cells(const double p[3], const double d[3], const size_t cells[3],
  const uint8_t* stays, double offset, const double box[2])
{
  double length = 0;
  for (size_t n = 0; n < cells[0] * cells[1] * cells[2]; ++n)
  {
    if (!stays[n])
    {
      continue;
    }
    const size_t at[3] = { n % cells[0], n / cells[0] % cells[1], n / (cells[0] * cells[1]) };
    double from = 0, to = 1;
    for (int a = 0; a < 3; ++a)
    {
      const double low = fmax((double)at[a] - offset, box[0]);
      const double high = fmin((double)at[a] + 1 - offset, box[1]);
      const double t0 = (low - p[a]) / d[a], t1 = (high - p[a]) / d[a];
      from = fmax(from, fmin(t0, t1));
      to = fmin(to, fmax(t0, t1));
    }
    length += to > from ? to - from : 0;
  }
  return length;
}

/* What is left of a small volume, one case of flags at a time, against brute force. */
static void in_fog_every_mask_leaves_the_length_that_its_cells_have(void)
{
  enum
  {
    M = 10,
    P = M + 1
  };
  static uint8_t values[M * M * M], points[P * P * P], cells[M * M * M], stays[M * M * M];
  const double steps[3] = { 0, 0.4, 1.5 }; /* up to two voxels along every axis */
  for (int k = 0; k < 12; ++k)
  {
    const int what = k % 6, cell_data = what >= 3;
    const size_t first[3] = { 14, 15, 16 }, count[3] = { M, M, M };
    scene* const s = make_scene(k & 1, first, count);
    s->frame.surface = NULL;
    s->opacity[0] = s->opacity[1] = 0.02f;
    s->volume.is_cell_data = cell_data;
    s->params.sample_distance = steps[k % 3];
    look_askew(s);
    const size_t np = cell_data ? P : M; /* points along each axis */
    const size_t nc = what == 0 ? M : np - 1;
    chi_mask_view view = { .struct_size = sizeof view,
      .type = CHI_U8,
      .stride = 1,
      .point_bits = HIDDEN,
      .cell_bits = HIDDEN,
      .version = 1 };
    memset(points, 1, sizeof points); /* other bits hide nothing */
    memset(cells, 1, sizeof cells);
    for (size_t n = 0; n < M * M * M; ++n)
    {
      values[n] = (uint8_t)on(n % M, n / M % M, n / (M * M), (uint32_t)k);
    }
    for (size_t n = 0; n < nc * nc * nc; ++n)
    {
      cells[n] = (uint8_t)(on(n, 3, 1, (uint32_t)k) ? 1 : HIDDEN);
    }
    for (size_t n = 0; n < np * np * np; n += 37)
    {
      points[n] = HIDDEN | 1;
    }
    view.values = what == 0 || what == 3 || what == 5 ? values : NULL;
    view.cell_flags = what == 1 || what == 4 ? cells : NULL;
    view.point_flags = what == 2 || what == 5 ? points : NULL;
    for (size_t n = 0; n < nc * nc * nc; ++n)
    {
      const size_t at[3] = { n % nc, n / nc % nc, n / (nc * nc) };
      stays[n] = !(view.values && !values[n]) && !(view.cell_flags && (cells[n] & HIDDEN));
      for (int corner = 0; corner < 8 && view.point_flags; ++corner)
      {
        const size_t x = at[0] + (size_t)(corner & 1), y = at[1] + (size_t)(corner >> 1 & 1);
        stays[n] &= !(points[x + np * (y + np * (at[2] + (size_t)(corner >> 2)))] & HIDDEN);
      }
    }
    s->frame.mask = &view;
    const chi_occlusion_image image = render(s);
    const double offset = cell_data || what == 0 ? 0.5 : 0;
    const double box[2] = { cell_data ? -0.5 : 0, cell_data ? M - 0.5 : M - 1 };
    const size_t size[3] = { nc, nc, nc };
    double worst = 0, most = 0;
    for (int i = 0; i < PIXELS; i += 3)
    {
      double p[3], d[3];
      const double scale = askew_ray(s, i, p, d);
      const double length = length_in_cells(p, d, size, stays, offset, box);
      const double exact = 1 - exp(-sigma * length * scale);
      worst = fmax(worst, fabs((double)image.rgba[4 * i + 3] - exact));
      most = fmax(most, exact);
    }
    CHECK(most > 0.05);
    /* positions are floats of up to 140, 8e-6, at some 20 faces a ray */
    CHECK_NEAR(worst, 0, 3e-5);
    free_scene(s);
  }
}

static void skipping_and_schedules_change_nothing(void)
{
  static uint8_t values[VOXELS];
  for (int k = 0; k < 4; ++k)
  {
    scene* const s = make_whole(k & 1);
    scene* const t = make_whole(k & 1);
    for (size_t n = 0; n < VOXELS; ++n)
    {
      const size_t i = n % N, j = n / N % N, l = n / (N * N);
      /* coarse and fine parts, so that bricks of every kind occur */
      values[n] = (uint8_t)(i > 25 ? j > 12 : j < 20 ? l < 19 : on(i, j, l, 5));
    }
    chi_mask_view view;
    mask_with(s, &view, values);
    mask_with(t, &view, values);
    s->opacity[1] = t->opacity[1] = 0.9f;
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

static void all_or_nothing_masked(void)
{
  static uint8_t values[VOXELS];
  scene* const s = make_whole(0);
  scene* const t = make_whole(0);
  chi_occlusion_stats plain, stats;
  const chi_occlusion_image a = render(s);
  chi_occlusion_get_stats(s->engine, &plain);
  memset(values, 1, sizeof values);
  chi_mask_view view;
  mask_with(t, &view, values);
  chi_occlusion_image b = render(t);
  chi_occlusion_get_stats(t->engine, &stats);
  CHECK(memcmp(a.rgba, b.rgba, 4 * PIXELS * sizeof(float)) == 0);
  CHECK(stats.samples == plain.samples && stats.occupied_bricks == plain.occupied_bricks);
  memset(values, 0, sizeof values);
  ++view.version;
  for (int skip = 0; skip < 2; ++skip)
  {
    t->params.skip = skip;
    b = render(t);
    chi_occlusion_get_stats(t->engine, &stats);
    double most = 0, darkest = 1;
    for (int i = 0; i < PIXELS; ++i)
    {
      most = fmax(most, (double)b.rgba[4 * i + 3]);
      darkest = fmin(darkest, (double)b.visibility[i]);
    }
    CHECK(most == 0 && stats.samples == 0 && stats.occupied_bricks == 0);
    CHECK(darkest < 0.95); /* the near surface still shades the far one */
  }
  free_scene(t);
  free_scene(s);
}

static void masked_bricks_are_skipped(void)
{
  static uint8_t values[VOXELS];
  scene* const s = make_whole(1);
  chi_occlusion_stats stats;
  s->frame.surface = NULL;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  const int64_t samples = stats.samples;
  for (size_t n = 0; n < VOXELS; ++n)
  {
    values[n] = n % N >= N / 2;
  }
  chi_mask_view view;
  mask_with(s, &view, values);
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.samples < samples * 6 / 10); /* half of the voxels are left, and their bricks' rims */
  free_scene(s);
}

static void every_type_and_stride_gives_the_same_picture(void)
{
  static double wide[2 * VOXELS];
  static uint8_t values[VOXELS];
  scene* const s = make_whole(0);
  chi_mask_view view;
  for (size_t n = 0; n < VOXELS; ++n)
  {
    values[n] = (uint8_t)on(n % N / 3, n / N % N / 3, n / (N * N) / 3, 9);
  }
  mask_with(s, &view, values);
  const chi_occlusion_image first = render(s);
  static float expected[4 * PIXELS];
  memcpy(expected, first.rgba, sizeof expected);
  for (chi_type type = CHI_F32; type <= CHI_U64; ++type)
  {
    for (size_t n = 0; n < VOXELS; ++n)
    {
      char* const at = (char*)(wide + 2 * n);
      const float f = values[n] ? 0.5f : n & 1 ? NAN : -3;
      const double g = values[n] ? 1e-30 : -1;
      const uint64_t integer = values[n] ? 5 : 0; /* little endian, as the kernels */
      memcpy(at,
        type == CHI_F32     ? (const void*)&f
          : type == CHI_F64 ? (const void*)&g
                            : &integer,
        chi_type_size(type));
    }
    view.values = wide;
    view.type = type;
    view.stride = 2 * sizeof(double);
    ++view.version;
    const chi_occlusion_image image = render(s);
    CHECK(memcmp(expected, image.rgba, sizeof expected) == 0);
  }
  free_scene(s);
}

static void another_mask_renders_anew_and_the_same_does_not(void)
{
  static uint8_t values[VOXELS];
  scene* const s = make_whole(1);
  chi_mask_view view, copy;
  chi_occlusion_stats stats;
  values[20 + N * (20 + N * 20)] = 1;
  mask_with(s, &view, values);
  render(s);
  copy = view;
  s->frame.mask = &copy;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused);
  ++copy.version;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(!stats.reused && stats.reused_bricks && !stats.reused_classification);
  s->frame.mask = NULL;
  render(s);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(!stats.reused && stats.samples > 10000);
  s->frame.mask = &copy;
  copy.type = 99;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  copy.type = CHI_U16;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  free_scene(s);
}

static void refused_memory_and_cancelling_are_reported_and_nothing_leaks(void)
{
  static uint8_t values[VOXELS];
  const size_t first[3] = { 14, 15, 16 }, count[3] = { 9, 9, 9 };
  scene* const s = make_scene(0, first, count);
  chi_occlusion_destroy(NULL, s->engine);
  s->engine = NULL;
  chi_mask_view view;
  memset(values, 1, 300);
  mask_with(s, &view, values);
  view.cell_flags = view.values;
  view.cell_bits = HIDDEN;
  chi_test_host host = { .refuse_at = -1, .cancel_at = 1L << 40 };
  const chi_exec exec = { .struct_size = sizeof exec,
    .user = &host,
    .alloc = chi_test_alloc,
    .release = chi_test_release,
    .is_cancelled = chi_test_is_cancelled };
  long allocations = 1, polls = 1;
  for (long k = -1; k < allocations || k < polls; ++k)
  {
    for (int cancel = 0; cancel < 2; ++cancel)
    {
      host = (chi_test_host){ .refuse_at = k < 0 || cancel ? -1 : k + 1,
        .cancel_at = k < 0 || !cancel ? 1L << 40 : k };
      chi_occlusion* engine = NULL;
      CHECK(chi_occlusion_create(&exec, &engine) == CHI_OK);
      const chi_status status = chi_occlusion_render(&exec, engine, &s->frame);
      const int spoiled = k >= 0 && (cancel ? k < polls : k + 1 < allocations);
      CHECK(status == (!spoiled ? CHI_OK : cancel ? CHI_ERROR_CANCELLED : CHI_ERROR_OUT_OF_MEMORY));
      if (k < 0)
      {
        allocations = host.allocations;
        polls = host.polls;
      }
      host.cancel_at = 1L << 40;
      CHECK(chi_occlusion_render(&exec, engine, &s->frame) == CHI_OK); /* still usable */
      chi_occlusion_destroy(&exec, engine);
      CHECK(host.live == 0);
    }
  }
  free_scene(s);
}

int main(void)
{
  a_mask_of_a_box_of_voxels_is_that_box_cropped();
  masked_nearest_samples_are_the_cut_data();
  in_fog_every_mask_leaves_the_length_that_its_cells_have();
  skipping_and_schedules_change_nothing();
  all_or_nothing_masked();
  masked_bricks_are_skipped();
  every_type_and_stride_gives_the_same_picture();
  another_mask_renders_anew_and_the_same_does_not();
  refused_memory_and_cancelling_are_reported_and_nothing_leaks();
  return chi_test_report();
}
