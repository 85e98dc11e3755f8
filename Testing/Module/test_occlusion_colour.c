/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Integration of the transfer function between slices: opacity and colour, for any distance. */

#include "chi_test.h"
#include "occlusion_ramp.h"

static const float* render(chi_occlusion* engine, const reference_frame* f)
{
  chi_occlusion_image image = { 0 };
  const chi_status status = chi_occlusion_render(NULL, engine, &f->frame);
  CHECK(status == CHI_OK);
  chi_occlusion_get_image(engine, &image);
  CHECK(image.rgba != NULL);
  return status == CHI_OK ? image.rgba : NULL;
}

static chi_occlusion* engine_create(void)
{
  chi_occlusion* engine = NULL;
  CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
  return engine;
}

/* The picture's mean and largest error at one setting. */
static void measure(chi_occlusion* engine, const ramp_scene* r, int rule, double distance,
  const double exact[4], double error[2])
{
  r->f->params.color_integration = rule;
  r->f->params.sample_distance = distance;
  const float* const rgba = render(engine, r->f);
  error[0] = error[1] = INFINITY;
  if (rgba)
  {
    ramp_error(rgba, exact, 4, error);
  }
}

/* Along the ray scalars rise by 1 / depth a voxel. */
static void exact_of(const ramp_scene* r, double exact[4])
{
  ramp_integrate(r->f, 0, 1.02, 1.0 / r->depth, exact);
}

/* Peak of sigma 1/200 of the range, optical depth 3 a voxel, on a ramp of 64 voxels: three sigma
 * from slice to slice, and a third of a turn of the colours. */
static void a_thin_peak_keeps_its_colour_at_one_slice_a_voxel(void)
{
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  if (ramp_create(&r, 64, 0))
  {
    double exact[4], pre[2], middle[2], fine[2];
    ramp_peak(r.f, 3, 1.0 / 200, 40);
    exact_of(&r, exact);
    measure(engine, &r, CHI_COLOR_PREINTEGRATED, 1, exact, pre);
    measure(engine, &r, CHI_COLOR_MIDDLE, 1, exact, middle);
    measure(engine, &r, CHI_COLOR_MIDDLE, 1.0 / 16, exact, fine);
    printf("thin peak, mean and largest error of 255: pre-integrated %.2f %.2f, middle %.2f %.2f, "
           "middle of 16 times finer slices %.2f %.2f\n",
      pre[0], pre[1], middle[0], middle[1], fine[0], fine[1]);
    /* half a step of 8 bits in the mean */
    CHECK(pre[0] <= 0.5 && pre[1] <= 1.5);
    CHECK(middle[0] > 20 * pre[0]); /* what the rule is for */
    CHECK(fine[0] <= 0.5);          /* the reference is where finer slices lead */
  }
  ramp_free(&r);
  chi_occlusion_destroy(NULL, engine);
}

/* An even slab of colours that run from one end to the other: C = c0 (1 - e^-T) + (c1 - c0) ((1 -
 * e^-T) / T - e^-T), T its optical depth. Its faces are ramps of one entry of 4096. */
static void a_slab_of_running_colour_has_its_closed_form(void)
{
  static const double depths[4] = { 0.05, 0.7, 3, 9 };
  static const int entries[3] = { 40, 300, 1200 };
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  const int created = ramp_create(&r, 24, 0);
  for (int k = 0; created && k < 12; ++k)
  {
    const double total = depths[k % 4], rest = exp(-total);
    const int width = entries[k / 4];
    const double length = (double)width / (REFERENCE_ENTRIES - 1) * r.depth;
    const int first = 1500;
    if (total / length > 16) /* an opaque unit distance is 16.6: more does not exist */
    {
      continue;
    }
    double exact[4], error[2];
    for (int i = 0; i < REFERENCE_ENTRIES; ++i)
    {
      const double s = fmin(fmax((double)(i - first) / width, 0), 1);
      const double rgb[3] = { s, 1 - s, 0.25 + 0.5 * s };
      /* half an entry at both faces: the slab is as thick as it says */
      const int inside = i >= first && i <= first + width, face = i == first || i == first + width;
      ramp_entry(r.f, i, inside ? (face ? 0.5 : 1) * total / length : 0, rgb);
    }
    ++r.f->transfer.version;
    const double c0[3] = { 0, 1, 0.25 }, c1[3] = { 1, 0, 0.75 };
    for (int c = 0; c < 3; ++c)
    {
      exact[c] = c0[c] * (1 - rest) + (c1[c] - c0[c]) * ((1 - rest) / total - rest);
    }
    exact[3] = 1 - rest;
    measure(engine, &r, CHI_COLOR_PREINTEGRATED, 1, exact, error);
    /* The slab covers up to 7 slices of 170 entries; rays end at alpha 0.998 (0.51/255). What the
     * fits to optical depths leave is 0.6/255 where all of them lie in one segment. */
    if (error[1] > 1.2)
    {
      printf("slab of %d entries, depth %.2f: mean %.3f, largest %.3f of 255\n", width, total,
        error[0], error[1]);
    }
    CHECK(error[1] <= 1.2);
  }
  if (created)
  {
    ramp_free(&r);
  }
  chi_occlusion_destroy(NULL, engine);
}

/* Smooth transfer functions, steep ramps: from two voxels to a sixteenth the picture is the same.
 */
static void the_sample_distance_does_not_show(void)
{
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  if (ramp_create(&r, 64, 0))
  {
    double exact[4];
    ramp_peak(r.f, 0.5, 1.0 / 12, 3);
    exact_of(&r, exact);
    for (double distance = 2; distance > 0.05; distance *= 0.5)
    {
      double error[2];
      measure(engine, &r, CHI_COLOR_PREINTEGRATED, distance, exact, error);
      printf(
        "sample distance %.4f: mean %.3f, largest %.3f of 255\n", distance, error[0], error[1]);
      CHECK(error[1] <= 0.5 + 0.51); /* the middle's colour where it suffices; alpha 0.998 */
    }
  }
  ramp_free(&r);
  chi_occlusion_destroy(NULL, engine);
}

/* Far views turn the sample distance, and the segments' lengths along the ray, into odd numbers. */
static void the_thin_peak_looks_alike_from_aside(void)
{
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  if (ramp_create(&r, 64, 10))
  {
    double error[2] = { 0, 0 };
    const double* const m = r.f->camera.world_to_eye;
    /* of the scalar along the line of sight, index space */
    const double rise = (-m[8] * ramp_side[0] - m[9] * ramp_side[1] + m[10]) / r.depth;
    double exact[4];
    ramp_peak(r.f, 3, 1.0 / 200, 40);
    ramp_integrate(r.f, 0.4, 0.6, rise, exact);
    for (double distance = 0.6; distance < 2; distance += 0.37)
    {
      measure(engine, &r, CHI_COLOR_PREINTEGRATED, distance, exact, error);
      printf("from aside, sample distance %.2f: mean %.3f, largest %.3f of 255\n", distance,
        error[0], error[1]);
      CHECK(error[0] <= 2); /* at 1.7 voxels, five sigma a segment in four parts */
    }
  }
  ramp_free(&r);
  chi_occlusion_destroy(NULL, engine);
}

/* Colours stay between those of the transfer function whatever it is, and the alpha is the same. */
static void no_transfer_function_gives_colours_of_its_own(void)
{
  ramp_scene r;
  uint32_t state = 7;
  chi_occlusion* const engine = engine_create();
  const int created = ramp_create(&r, 20, 0);
  for (int k = 0; created && k < 20; ++k)
  {
    static float alpha[RAMP_PICTURE * RAMP_PICTURE];
    for (int i = 0; i < REFERENCE_ENTRIES; ++i)
    {
      const double spike = chi_test_random(&state);
      const double high = pow(10, 4 - 9 * chi_test_random(&state));
      const double rgb[3] = { chi_test_random(&state), chi_test_random(&state), 0.5 };
      ramp_entry(r.f, i, spike < 0.02 * k ? high : 0, rgb);
    }
    ++r.f->transfer.version;
    for (int rule = 1; rule >= 0; --rule)
    {
      r.f->params.color_integration = rule ? CHI_COLOR_MIDDLE : CHI_COLOR_PREINTEGRATED;
      const float* const rgba = render(engine, r.f);
      int good = rgba != NULL, same = good;
      for (int i = 0; rgba && i < RAMP_PICTURE * RAMP_PICTURE; ++i)
      {
        const float a = rgba[4 * i + 3];
        good &= a >= 0 && a <= 1;
        for (int c = 0; c < 3; ++c)
        {
          good &= rgba[4 * i + c] >= 0 && rgba[4 * i + c] <= a + 1e-5f; /* sums of 23 floats */
        }
        /* one blue in all of the function: nothing else may come out */
        good &= fabsf(rgba[4 * i + 2] - 0.5f * a) <= 1e-3f; /* sums of 31 bits of 1e4 to 1e-5 */
        same &= rule || a == alpha[i];
        alpha[i] = a;
      }
      CHECK(good && same);
    }
  }
  if (created)
  {
    ramp_free(&r);
  }
  chi_occlusion_destroy(NULL, engine);
}

/* Light buffers take the same integral: behind a thin peak they are as dark as behind one cut into
 * 16 slices a voxel. */
static void a_thin_peak_reaches_the_light(void)
{
  enum
  {
    PROBES = 64
  };
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  if (ramp_create(&r, 64, 0))
  {
    static double position[3 * PROBES];
    static float visibility[2][PROBES];
    ramp_peak(r.f, 3, 1.0 / 200, 40);
    r.f->params.strength = 1;
    for (int i = 0; i < PROBES; ++i)
    {
      position[3 * i] = 16.5 + i % 8 * 2;
      position[3 * i + 1] = 16.5 + i / 8 * 2;
      position[3 * i + 2] = 256 - 32 + 44; /* twelve voxels behind the peak's middle */
    }
    for (int k = 0; k < 2; ++k)
    {
      r.f->params.sample_distance = k ? 1.0 / 16 : 1;
      r.f->probes = (chi_occlusion_probes){ position, visibility[k], PROBES };
      r.f->frame.probes = &r.f->probes;
      render(engine, r.f);
    }
    double worst = 0, mean = 0;
    for (int i = 0; i < PROBES; ++i)
    {
      worst = fmax(worst, fabs((double)visibility[0][i] - (double)visibility[1][i]));
      mean += (double)visibility[1][i] / PROBES;
    }
    printf("V behind the thin peak: %.4f, one slice a voxel off by at most %.5f\n", mean, worst);
    CHECK(mean > 0.02 && mean < 0.5);
    /* Rows of equal scalar are cut at different phases; the extinction of each segment is exact,
     * and the slab's light moves by one voxel's offset within it: 0.2 % of V. */
    CHECK(worst <= 0.002 * 4);
  }
  ramp_free(&r);
  chi_occlusion_destroy(NULL, engine);
}

static void a_rule_that_does_not_exist_is_refused(void)
{
  ramp_scene r;
  chi_occlusion* const engine = engine_create();
  if (ramp_create(&r, 8, 0))
  {
    r.f->params.color_integration = 2;
    CHECK(chi_occlusion_render(NULL, engine, &r.f->frame) == CHI_ERROR_INVALID_ARGUMENT);
    r.f->params.color_integration = -1;
    CHECK(chi_occlusion_render(NULL, engine, &r.f->frame) == CHI_ERROR_INVALID_ARGUMENT);
  }
  ramp_free(&r);
  chi_occlusion_destroy(NULL, engine);
}

int main(void)
{
  a_thin_peak_keeps_its_colour_at_one_slice_a_voxel();
  a_slab_of_running_colour_has_its_closed_form();
  the_sample_distance_does_not_show();
  the_thin_peak_looks_alike_from_aside();
  no_transfer_function_gives_colours_of_its_own();
  a_thin_peak_reaches_the_light();
  a_rule_that_does_not_exist_is_refused();
  return chi_test_report();
}
