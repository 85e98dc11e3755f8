/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The occlusion engine: run time against error of V on the judged scenes in perspective, what the
 * number of slices changes, and frames of Marschner-Lobb with a moving camera.
 *
 *   bench_occlusion [brain128.raw]        the file that scenes.py writes; without it, no brain
 *   bench_occlusion --frames              the moving frames alone, for a profile
 *
 * Prints CSV. The error is that of visibility against the exact cone, at bias 0 (see
 * occlusion_reference.h); times are of whole frames in which only the bias moves by nothing.
 */

#include "occlusion_bench_scenes.h"

#include "chi_bench.h"

#include <math.h>
#include <string.h>

/* A scene with its judged points and exact visibilities. */
typedef struct judged_scene
{
  const char* name;
  reference_volume volume;
  reference_view view;
  reference_points points;
  reference_rays rays;
  double range;
  double *exact, *work;
  float* visibility;
} judged_scene;

static void solve(void* data, size_t begin, size_t end)
{
  const judged_scene* const s = (const judged_scene*)data;
  for (size_t i = begin; i < end; ++i)
  {
    s->exact[i] =
      reference_visibility(&s->volume, NULL, &s->view, &s->rays, s->points.position + 3 * i);
  }
}

static void judged_free(judged_scene* s)
{
  reference_points_free(&s->points);
  reference_volume_free(&s->volume);
  free(s->exact);
  free(s->work);
  free(s->visibility);
}

static int judge(judged_scene* s, const char* name, reference_kind kind, const char* raw,
  double angle_deg, chi_bench_pool* threads)
{
  *s = (judged_scene){ .name = name,
    .view = angle_deg > 0 ? reference_perspective_view(angle_deg) : reference_parallel_view(),
    .rays = { angle_deg > 0 ? 512 : 1024, angle_deg > 0 ? 0.5 : 0.25, 0.78539816339744831 },
    .range = kind == REFERENCE_HALF_PLANE ? 8
      : kind == REFERENCE_BALLS           ? 4.5
                                          : 0.6 };
  if (!reference_scene(&s->volume, kind, raw) ||
    !reference_points_create(&s->points, &s->volume, kind, &s->view, 1))
  {
    return 0;
  }
  s->exact = malloc(s->points.count * sizeof(double));
  s->work = malloc(s->points.count * sizeof(double));
  s->visibility = malloc(s->points.count * sizeof(float));
  if (!s->exact || !s->work || !s->visibility)
  {
    return 0;
  }
  chi_bench_for(threads, s->points.count, solve, s);
  return 1;
}

/* Shortest of several frames without probes; what moves is too little to matter, but does move. */
static double time_frames(const chi_exec* exec, chi_occlusion* engine, reference_frame* f)
{
  double best = INFINITY;
  for (int run = 0; run < CHI_BENCH_RUNS + 1; ++run)
  {
    f->params.bias = run & 1 ? 1e-9 : 0;
    const double t0 = chi_bench_now();
    if (chi_occlusion_render(exec, engine, &f->frame) != CHI_OK)
    {
      return INFINITY;
    }
    best = fmin(best, chi_bench_now() - t0);
  }
  return best;
}

static void measure(const chi_exec* exec, chi_occlusion* engine, reference_frame* f,
  judged_scene* s, const char* method, int threads)
{
  const double ns = time_frames(exec, engine, f);
  f->params.bias = 0;
  if (reference_probe(exec, engine, f, &s->view, &s->points, s->visibility) != CHI_OK)
  {
    return;
  }
  const reference_error e = reference_compare(s->visibility, s->exact, s->points.count, s->work);
  const double values[2] = { e.mean, e.p99 };
  static const char* const kinds[2] = { "mean_dV", "p99_dV" };
  for (int k = 0; k < 2; ++k)
  {
    printf("occlusion,%s,%s,%d,%zu,%d,%.0f,%.5f,%s\n", s->name, method, f->params.directions,
      s->volume.n[0] * s->volume.n[1] * s->volume.n[2], threads, ns, values[k], kinds[k]);
  }
  fflush(stdout);
}

static void measure_scene(judged_scene* s, chi_bench_pool* p)
{
  static const char* const slices[3] = { "", "-2-slices", "-4-slices" };
  const chi_exec exec = chi_bench_exec(p);
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* engine = NULL;
  if (!f || chi_occlusion_create(&exec, &engine) != CHI_OK)
  {
    free(f);
    return;
  }
  for (int half = 0; half < 2; ++half)
  {
    for (int directions = 4; directions <= 64; directions *= 2)
    {
      for (int k = 0; k < (directions == 16 ? 3 : 1); ++k)
      {
        char method[64];
        snprintf(method, sizeof method, "chi-ordinates-%s%s", half ? "half" : "full", slices[k]);
        reference_frame_init(f, &s->volume, &s->view, s->range);
        f->params.directions = directions;
        f->params.half_size = half;
        f->params.sample_distance = 1.0 / (1 << k);
        measure(&exec, engine, f, s, method, p->threads);
      }
    }
  }
  for (int taps = 16; taps <= 64; taps *= 4)
  {
    reference_frame_init(f, &s->volume, &s->view, s->range);
    f->params.method = CHI_OCCLUSION_PUBLISHED;
    f->params.directions = taps;
    f->params.half_size = 0;
    f->params.sample_distance = 1;
    measure(&exec, engine, f, s, "chi-published-full", p->threads);
  }
  chi_occlusion_destroy(&exec, engine);
  free(f);
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Pictures and V of 250, 500 and 1000 slices against 2000, at a bias of 1.5 voxels; errors in units
 * of 1/255, over the covered pixels and the judged points. */
static void compare_slices(judged_scene* s, chi_bench_pool* p)
{
  const chi_exec exec = chi_bench_exec(p);
  const size_t pixels = REFERENCE_SIZE * REFERENCE_SIZE, count = s->points.count;
  reference_frame* const f = malloc(sizeof *f);
  float* const finest = malloc((4 * pixels + count) * sizeof *finest);
  double* const d = malloc((4 * pixels + count) * sizeof *d);
  chi_occlusion* engine = NULL;
  chi_status status = chi_occlusion_create(&exec, &engine);
  for (int slices = 2000; f && finest && d && status == CHI_OK && slices >= 250; slices /= 2)
  {
    reference_frame_init(f, &s->volume, &s->view, s->range);
    f->params.sample_distance = (REFERENCE_SIZE - 1.0) / slices;
    const double ns = time_frames(&exec, engine, f);
    f->params.bias = 1.5;
    status = reference_probe(&exec, engine, f, &s->view, &s->points, s->visibility);
    chi_occlusion_image image;
    chi_occlusion_get_image(engine, &image);
    if (status != CHI_OK || slices == 2000)
    {
      if (status == CHI_OK)
      {
        memcpy(finest, image.rgba, 4 * pixels * sizeof *finest);
        memcpy(finest + 4 * pixels, s->visibility, count * sizeof *finest);
      }
      continue;
    }
    for (int light = 0; light < 2; ++light)
    {
      size_t n = 0;
      for (size_t i = 0; i < (light ? count : 4 * pixels); ++i)
      {
        if (light)
        {
          d[n++] = 255 * fabs((double)s->visibility[i] - (double)finest[4 * pixels + i]);
        }
        else if (finest[4 * (i / 4) + 3] > 0)
        {
          d[n++] = 255 * fabs((double)image.rgba[i] - (double)finest[i]);
        }
      }
      double mean = 0;
      for (size_t i = 0; i < n; ++i)
      {
        mean += d[i] / (double)n;
      }
      qsort(d, n, sizeof *d, ascending);
      const double p99 = n ? d[(size_t)(0.99 * (double)(n - 1))] : 0;
      printf("occlusion,%s-slices,chi-ordinates-half,%d,%zu,%d,%.0f,%.4f,mean_255_%s\n", s->name,
        slices, s->volume.n[0] * s->volume.n[1] * s->volume.n[2], p->threads, ns, mean,
        light ? "V" : "picture");
      printf("occlusion,%s-slices,chi-ordinates-half,%d,%zu,%d,%.0f,%.4f,p99_255_%s\n", s->name,
        slices, s->volume.n[0] * s->volume.n[1] * s->volume.n[2], p->threads, ns, p99,
        light ? "V" : "picture");
    }
  }
  chi_occlusion_destroy(&exec, engine);
  free(f);
  free(finest);
  free(d);
}

/* What the light's options cost. */
typedef enum lighting
{
  LIGHT_FROM_THE_EYE,
  LIGHT_30_DEGREES,
  LIGHT_60_DEGREES,
  LIGHT_FROM_TWO_SIDES,
  LIGHT_OF_THREE_COLOURS,
  LIGHTINGS
} lighting;

static const char* set_lighting(chi_occlusion_params* p, lighting option)
{
  static const char* const name[LIGHTINGS] = { "", "-30deg", "-60deg", "-two-lights", "-coloured" };
  static const double tilt[LIGHTINGS] = { 0, 0.57735026918962576, 1.7320508075688772, 0, 0 };
  p->light_direction[0] = tilt[option];
  p->light_direction[2] = 1;
  p->second_light_direction[1] = p->second_light_direction[2] = 1;
  p->second_light_share = option == LIGHT_FROM_TWO_SIDES ? 0.5 : 0;
  p->colored_attenuation = option == LIGHT_OF_THREE_COLOURS;
  p->attenuation[0] = 0.5;
  p->attenuation[1] = 1;
  p->attenuation[2] = 1.5;
  return name[option];
}

static void time_moving(
  int shells, int directions, int half, int threads, const uint8_t* scalars, lighting option)
{
  chi_bench_pool p = { threads };
  const chi_exec exec = chi_bench_exec(&p);
  const size_t n = 256;
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* engine = NULL;
  if (!f || chi_occlusion_create(&exec, &engine) != CHI_OK)
  {
    free(f);
    return;
  }
  bench_frame(f, scalars, 256, 512, shells ? BENCH_SHELLS : BENCH_FOG);
  f->params.directions = directions ? directions : 16;
  f->params.strength = directions ? 1 : 0;
  f->params.half_size = half;
  const char* const suffix = set_lighting(&f->params, option);
  double moving = INFINITY, still = INFINITY;
  chi_occlusion_stats stats = { 0 };
  for (int frame = 0; frame < 8; ++frame)
  {
    f->camera = bench_moving_view(frame, 256, 512).camera;
    double t0 = chi_bench_now();
    if (chi_occlusion_render(&exec, engine, &f->frame) != CHI_OK)
    {
      break;
    }
    moving =
      frame ? fmin(moving, chi_bench_now() - t0) : moving; /* the first also reads the volume */
    chi_occlusion_get_stats(engine, &stats);
    t0 = chi_bench_now();
    if (chi_occlusion_render(&exec, engine, &f->frame) == CHI_OK)
    {
      still = fmin(still, chi_bench_now() - t0);
    }
  }
  char method[64];
  snprintf(method, sizeof method, directions ? "chi-ordinates-%s%s" : "chi-unshaded",
    half ? "half" : "full", suffix);
  printf("occlusion,%s,%s,%d,%zu,%d,%.0f,0,none\n", shells ? "ml256-shells" : "ml256-fog", method,
    directions, n * n * n, threads, moving);
  if (directions == 16 && half && option == LIGHT_FROM_THE_EYE)
  {
    printf("occlusion,%s-unchanged,%s,%d,%zu,%d,%.0f,0,none\n",
      shells ? "ml256-shells" : "ml256-fog", method, directions, n * n * n, threads, still);
  }
  fprintf(stderr,
    "# %s %s%s %d directions, %d threads: %.1f ms, %lld samples (+ %lld skipped), %lld light (+ "
    "%lld "
    "skipped), CPU: samples %.0f ms, light %.0f ms\n",
    shells ? "shells" : "fog", half ? "half" : "full", suffix, directions, threads, 1e-6 * moving,
    (long long)stats.samples, (long long)stats.skipped_samples, (long long)stats.light_updates,
    (long long)stats.skipped_light_updates, 1e3 * stats.seconds_samples, 1e3 * stats.seconds_light);
  fflush(stdout);
  chi_occlusion_destroy(&exec, engine);
  free(f);
}

int main(int argc, char** argv)
{
  chi_bench_pool two = { 2 };
  printf("topic,case,method,parameter,n,threads,min_ns,error,error_kind\n");
  fprintf(stderr, "# instruction set: %s\n", chi_occlusion_instruction_set());
  static const struct
  {
    const char* name;
    reference_kind kind;
    double angle_deg;
  } scenes[7] = { { "half-plane", REFERENCE_HALF_PLANE, 0 }, { "balls", REFERENCE_BALLS, 0 },
    { "half-plane-30deg", REFERENCE_HALF_PLANE, 30 },
    { "half-plane-60deg", REFERENCE_HALF_PLANE, 60 }, { "balls-30deg", REFERENCE_BALLS, 30 },
    { "balls-60deg", REFERENCE_BALLS, 60 }, { "brain", REFERENCE_RAW, 0 } };
  const int frames_alone = argc > 1 && strcmp(argv[1], "--frames") == 0;
  for (int k = 0; k < (frames_alone ? 0 : argc > 1 ? 7 : 6); ++k)
  {
    judged_scene s;
    if (judge(
          &s, scenes[k].name, scenes[k].kind, argc > 1 ? argv[1] : NULL, scenes[k].angle_deg, &two))
    {
      if (s.view.camera.parallel) /* bench_occlusion_error measures these */
      {
        compare_slices(&s, &two);
      }
      else
      {
        measure_scene(&s, &two);
      }
    }
    else
    {
      fprintf(stderr, "# %s: no memory, or the file cannot be read\n", scenes[k].name);
    }
    judged_free(&s);
  }
  uint8_t* const scalars = bench_marschner_lobb(256);
  for (int shells = 0; scalars && shells < 2; ++shells)
  {
    for (int threads = 2; threads >= 1; --threads)
    {
      time_moving(shells, 0, 1, threads, scalars, LIGHT_FROM_THE_EYE);
      time_moving(shells, 8, 1, threads, scalars, LIGHT_FROM_THE_EYE);
      time_moving(shells, 16, 1, threads, scalars, LIGHT_FROM_THE_EYE);
      time_moving(shells, 16, 0, threads, scalars, LIGHT_FROM_THE_EYE);
    }
    for (int option = LIGHT_30_DEGREES; option < LIGHTINGS; ++option)
    {
      time_moving(shells, 16, 1, 2, scalars, (lighting)option);
    }
  }
  const int failed = scalars == NULL;
  free(scalars);
  return failed;
}
