/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * What each kind of skipping gains: Marschner-Lobb 256^3 at 512^2, 16 directions at half size, on
 * three transfer functions, plain, and with a clip plane and a surface through the middle.
 *
 * Prints CSV. Frames with all kinds and without one of them take turns, the camera one degree on
 * each time; the error is the speed-up (error_kind speedup), or the largest difference of the
 * picture to that of the work in full, of full scale (max_to_full_work).
 */

#include "occlusion_bench_scenes.h"

#include "chi_bench.h"

#include <string.h>

enum
{
  SIZE = 256,
  PIXELS = 512,
  FRAMES = 2
};

typedef struct kind
{
  const char* name;
  int32_t flag;
} kind;

static const kind kinds[] = { { "bricks", CHI_SKIP_BRICKS },
  { "saturated-rays", CHI_SKIP_SATURATED_RAYS }, { "behind-geometry", CHI_SKIP_BEHIND_GEOMETRY },
  { "clipped", CHI_SKIP_CLIPPED }, { "footprint", CHI_SKIP_FOOTPRINT },
  { "saturated-light", CHI_SKIP_SATURATED_LIGHT }, { "unreached-light", CHI_SKIP_UNREACHED_LIGHT },
  { "unchanged", CHI_SKIP_UNCHANGED }, { "all", CHI_SKIP_EVERY_KIND } };

static double render(const chi_exec* exec, chi_occlusion* engine, reference_frame* f, int32_t skip)
{
  f->params.skip = skip;
  const double t0 = chi_bench_now();
  return chi_occlusion_render(exec, engine, &f->frame) == CHI_OK ? chi_bench_now() - t0 : NAN;
}

static int keep(const chi_occlusion* engine, float* out)
{
  chi_occlusion_image image;
  chi_occlusion_get_image(engine, &image);
  if (image.rgba)
  {
    memcpy(out, image.rgba, 4 * PIXELS * PIXELS * sizeof *out);
  }
  return image.rgba != NULL;
}

static double difference(const float* a, const float* b)
{
  double worst = 0;
  for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
  {
    worst = fmax(worst, fabs((double)a[i] - (double)b[i]));
  }
  return worst;
}

static void print(const char* scene, const char* method, double ns, double error, const char* kind)
{
  printf("occlusion_skip,%s,%s,16,%d,2,%.0f,%.5g,%s\n", scene, method, SIZE * SIZE * SIZE, ns,
    error, kind);
}

static int measure(const chi_exec* exec, reference_frame* f, const char* scene, float* pictures)
{
  float *const full = pictures, *const now = pictures + 4 * PIXELS * PIXELS;
  chi_occlusion* engine = NULL;
  if (chi_occlusion_create(exec, &engine) != CHI_OK)
  {
    return 0;
  }
  int ok = render(exec, engine, f, CHI_SKIP_NOTHING) > 0 && keep(engine, full);
  for (size_t k = 0; ok && k < sizeof kinds / sizeof kinds[0]; ++k)
  {
    const int32_t without = CHI_SKIP_EVERY_KIND & ~kinds[k].flag;
    double with_ns = INFINITY, without_ns = INFINITY;
    for (int frame = 0; ok && frame < FRAMES; ++frame)
    {
      /* the last frame of each is the first view; there only "unchanged" sees the same twice */
      const int still = kinds[k].flag == CHI_SKIP_UNCHANGED;
      f->camera = bench_moving_view(still ? 0 : FRAMES - 1 - frame, SIZE, PIXELS).camera;
      double ns = render(exec, engine, f, CHI_SKIP_EVERY_KIND);
      ns = still ? render(exec, engine, f, CHI_SKIP_EVERY_KIND) : ns;
      with_ns = fmin(with_ns, ns);
      without_ns = fmin(without_ns, render(exec, engine, f, without));
      ok = ns > 0;
    }
    ok = ok && keep(engine, now);
    char method[64];
    snprintf(method, sizeof method, "chi-without-%s", kinds[k].name);
    print(scene, method, without_ns, without_ns / with_ns, "speedup");
    print(scene, method, without_ns, difference(full, now), "max_to_full_work");
    if (kinds[k].flag == CHI_SKIP_EVERY_KIND)
    {
      print(scene, "chi", with_ns, 1, "speedup");
    }
    fflush(stdout);
  }
  chi_occlusion_destroy(exec, engine);
  return ok;
}

int main(void)
{
  static const char* const names[3] = { "dense", "skin", "vessels" };
  static const bench_matter matters[3] = { BENCH_DENSE, BENCH_SKIN, BENCH_VESSELS };
  chi_bench_pool two = { 2 };
  const chi_exec exec = chi_bench_exec(&two);
  uint8_t* const scalars = bench_marschner_lobb(SIZE);
  reference_frame* const f = malloc(sizeof *f);
  float* const pictures = malloc(8 * PIXELS * PIXELS * sizeof *pictures);
  float* const depth = malloc(PIXELS * PIXELS * sizeof *depth);
  int ok = scalars && f && pictures && depth;
  printf(CHI_BENCH_HEADER);
  for (int k = 0; ok && k < 6; ++k)
  {
    char name[64];
    snprintf(name, sizeof name, "ml256-%s%s", names[k % 3], k < 3 ? "" : "-cut-and-surface");
    bench_frame(f, scalars, SIZE, PIXELS, matters[k % 3]);
    const double side = SIZE - 1, clip[4] = { 1, 0, 0, -0.3 * side }; /* a third is cut away */
    if (k >= 3)
    {
      /* A plane across the view through the volume's centre, in the left half of the window. */
      const double* const m = f->camera.world_to_eye;
      const double middle = 0.5 * side;
      const double at = -(middle * (m[8] + m[9] - m[10]) + m[11]);
      for (int i = 0; i < PIXELS * PIXELS; ++i)
      {
        depth[i] = i % PIXELS < PIXELS / 2 ? (float)at : INFINITY;
      }
      f->surface =
        (chi_surface_view){ .struct_size = sizeof f->surface, .depth = depth, .version = 1 };
      f->frame.surface = &f->surface;
      f->frame.clip_planes = clip;
      f->frame.clip_plane_count = 1;
    }
    ok = measure(&exec, f, name, pictures);
  }
  free(scalars);
  free(f);
  free(pictures);
  free(depth);
  return !ok;
}
