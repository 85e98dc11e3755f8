/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * How time and memory of the occlusion engine grow: Marschner-Lobb 128^3 ... 512^3 of 8 bits as
 * fog, 256^2 ... 1024^2 pixels, 16 directions at half size.
 *
 * Prints CSV: the time of a moving frame with the nanoseconds for each slice and pixel visited
 * (ns_a_sample), and the working memory besides input, in MiB and as a share of 64 MiB + 4 bytes a
 * pixel and direction (MiB, share_of_allowed_bytes).
 */

#include "occlusion_bench_scenes.h"

#include "chi_bench.h"
#include "counting_host.h"

enum
{
  DIRECTIONS = 16
};

static void print(int size, int pixels, const char* how, double ns, double error, const char* kind)
{
  printf("occlusion_scaling,fog,chi-ordinates-%s,%d^3 %d^2,%lld,2,%.0f,%.4g,%s\n", how, size,
    pixels, (long long)size * size * size, ns, error, kind);
  fflush(stdout);
}

static int measure(
  const chi_exec* threads, const uint8_t* scalars, int size, int pixels, int with_surface)
{
  counting_host host = { .exec = threads };
  const chi_exec exec = counting_exec(&host);
  reference_frame* const f = malloc(sizeof *f);
  const size_t count = (size_t)pixels * (size_t)pixels;
  float* const depth = malloc(count * sizeof *depth);
  chi_occlusion* engine = NULL;
  double best = INFINITY;
  chi_occlusion_stats stats = { 0 };
  int ok = f && depth && chi_occlusion_create(&exec, &engine) == CHI_OK;
  if (ok)
  {
    bench_frame(f, scalars, size, pixels, BENCH_FOG);
    const double* const m = f->camera.world_to_eye;
    const double middle = 0.5 * (size - 1), at = -(middle * (m[8] + m[9] - m[10]) + m[11]);
    for (size_t i = 0; i < count; ++i)
    {
      depth[i] = (float)at;
    }
    f->surface =
      (chi_surface_view){ .struct_size = sizeof f->surface, .depth = depth, .version = 1 };
    f->frame.surface = with_surface ? &f->surface : NULL;
  }
  for (int frame = 0; ok && frame < (size > 256 ? 3 : 5); ++frame)
  {
    f->camera = bench_moving_view(frame, size, pixels).camera;
    const double t0 = chi_bench_now();
    ok = chi_occlusion_render(&exec, engine, &f->frame) == CHI_OK;
    best = frame ? fmin(best, chi_bench_now() - t0) : best; /* the first also reads the volume */
  }
  chi_occlusion_get_stats(engine, &stats);
  if (ok)
  {
    const char* const how = with_surface ? "half-surface" : "half";
    const double allowed = 67108864.0 + 4.0 * (double)count * DIRECTIONS;
    print(size, pixels, how, best, best / (double)stats.samples, "ns_a_sample");
    print(size, pixels, how, best, (double)host.peak / 1048576, "MiB");
    print(size, pixels, how, best, (double)host.peak / allowed, "share_of_allowed_bytes");
  }
  chi_occlusion_destroy(&exec, engine);
  free(f);
  free(depth);
  return ok;
}

int main(void)
{
  chi_bench_pool two = { 2 };
  const chi_exec exec = chi_bench_exec(&two);
  int ok = 1;
  printf(CHI_BENCH_HEADER);
  for (int size = 128; ok && size <= 512; size *= 2)
  {
    uint8_t* const scalars = bench_marschner_lobb(size);
    ok = scalars != NULL;
    for (int pixels = 256; ok && pixels <= 1024; pixels *= 2)
    {
      ok = measure(&exec, scalars, size, pixels, 0);
    }
    ok = ok && measure(&exec, scalars, size, 1024, 1);
    free(scalars);
  }
  return !ok;
}
