/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Segments of rays along which the scalar is linear. psi: ways to compute it, in this program's own
 * kernel, with the widest vectors of this machine. Segments: run time against the error of whole
 * rays, by method and size of the full table. Tables: what a new transfer function costs. Prints
 * CSV.
 */

#include "chi_bench.h"
#include "segment_rays.h"
#include "simd/chi_segment.inl"

#include <math.h>

enum
{
  COUNT = 1 << 14, /* segments: within the second cache */
  REPEATS = 60,
  ENTRIES = 1024
};

/* 1: psi ************************************************************************************** */

static vf psi_quadrature(const float* table, vf front, vf back)
{
  (void)table;
  return segment_psi(front, back);
}

/* 128 x 128 entries over gamma, bilinear. */
static vf psi_table(const float* table, vf front, vf back)
{
  const float last = CHI_PSI_SIZE - 1;
  vf x = front / (1.0f + front) * last, y = back / (1.0f + back) * last;
  const vi i = vi_min(vf_int(x), vi_set(CHI_PSI_SIZE - 2));
  const vi j = vi_min(vf_int(y), vi_set(CHI_PSI_SIZE - 2));
  x -= vi_float(i);
  y -= vi_float(j);
  const vi at = i + j * CHI_PSI_SIZE, all = vi_set(-1);
  const vf a = vf_gather(table, at, 4, all), b = vf_gather(table + 1, at, 4, all);
  const vf c = vf_gather(table + CHI_PSI_SIZE, at, 4, all);
  const vf d = vf_gather(table + CHI_PSI_SIZE + 1, at, 4, all);
  const vf low = a + x * (b - a), high = c + x * (d - c);
  return low + y * (high - low);
}

/* e^(x^2) erfc(x), x >= 0: a polynomial in 1 / (1 + x / 2) fitted to 1e-7. */
static vf scaled_erfc(vf x)
{
  static const float c[] = { -0.0496598937f, 0.243225367f, -0.411705981f, 0.203989611f,
    0.0155755264f, 0.188625327f, 0.245722077f, 0.282133462f, 0.282094569f };
  const vf t = 1.0f / (1.0f + 0.5f * x);
  vf sum = vf_set(c[0]);
  for (int k = 1; k < 9; ++k)
  {
    sum = sum * t + c[k];
  }
  return sum * t;
}

/* e^(-x^2) times the integral of e^(t^2) to x >= 0: a quotient of polynomials fitted to 1e-6. */
static vf dawson(vf x)
{
  static const float p[] = { 1.16959865e-4f, 4.80496615e-4f, 0.00582994099f, 0.0395771952f,
    0.077460333f, 0.999992401f };
  static const float q[] = { 2.33932827e-4f, 8.39745288e-4f, 0.0113950605f, 0.0618670153f,
    0.269573525f, 0.743990624f, 1 };
  x = vf_min(x, vf_set(1000)); /* 1 / (2 x) from there on, within a float */
  const vf s = x * x;
  vf above = vf_set(p[0]), below = vf_set(q[0]);
  for (int k = 1; k < 6; ++k)
  {
    above = above * s + p[k];
  }
  for (int k = 1; k < 7; ++k)
  {
    below = below * s + q[k];
  }
  return x * above / below;
}

/* Completing the square leaves two error functions, or Dawson's where extinction falls; with nearly
 * constant extinction they cancel, and quadrature takes over. */
static vf psi_closed(const float* table, vf front, vf back)
{
  (void)table;
  const vf half_rise = (back - front) * 0.5f;
  const vf size = vf_max(half_rise, -half_rise), root = vf_sqrt(size);
  const vf a = 0.5f * front / root, b = 0.5f * back / root;
  const vf t = vf_exp_neg((front + back) * -0.5f);
  const vf rising = (scaled_erfc(a) - t * scaled_erfc(b)) * 0.88622693f;
  const vf falling = dawson(a) - t * dawson(b);
  const vf closed = vf_select(half_rise > 0.0f, rising, falling) / root;
  const vi flat = size < 0.02f * (front + back);
  return vi_any(flat) ? vf_select(flat, segment_psi(front, back), closed) : closed;
}

typedef vf (*psi_method)(const float* table, vf front, vf back);

__attribute__((noinline)) static void run_psi(
  psi_method method, const float* table, const float* front, const float* back, float* psi)
{
#define RUN(function)                                                                              \
  for (int i = 0; i < COUNT; i += CHI_LANES)                                                       \
  {                                                                                                \
    vf_store(psi + i, function(table, vf_load(front + i), vf_load(back + i)));                     \
  }
  if (method == psi_quadrature)
  {
    RUN(psi_quadrature)
  }
  else if (method == psi_table)
  {
    RUN(psi_table)
  }
  else
  {
    RUN(psi_closed)
  }
#undef RUN
}

static void bench_psi(const float* table)
{
  static float front[COUNT], back[COUNT], psi[COUNT];
  static double exact[COUNT];
  static const double most[] = { 0.02, 0.25, 1.5, 10, 99 };
  static const struct
  {
    const char* name;
    psi_method method;
  } methods[] = { { "chi_quadrature", psi_quadrature }, { "table_128x128", psi_table },
    { "closed_form", psi_closed } };
  uint32_t seed = 3;
  for (int k = 0; k < 5; ++k)
  {
    for (int i = 0; i < COUNT; ++i)
    {
      front[i] = (float)(most[k] * next_random(&seed));
      back[i] = (float)(most[k] * next_random(&seed));
      const double a[4] = { 0, 0, 0, (double)front[i] }, b[4] = { 1, 0, 0, (double)back[i] };
      double sum[4] = { 0, 0, 0, 0 };
      segment_add_linear(a, b, 1, sum);
      exact[i] = sum[0] + exp(-sum[3]);
    }
    for (int m = 0; m < 3; ++m)
    {
      double best = INFINITY, largest = 0, mean = 0;
      for (int r = 0; r < REPEATS; ++r)
      {
        const double start = chi_bench_now();
        run_psi(methods[m].method, table, front, back, psi);
        best = fmin(best, chi_bench_now() - start);
      }
      for (int i = 0; i < COUNT; ++i)
      {
        const double error = fabs((double)psi[i] - exact[i]);
        largest = fmax(largest, error);
        mean += error / COUNT;
      }
      printf("preintegration,psi_tau_to_%g,%s,,%d,1,%.0f,%.3g,max\n", most[k], methods[m].name,
        COUNT, best, largest);
      printf("preintegration,psi_tau_to_%g,%s,,%d,1,%.0f,%.3g,mean\n", most[k], methods[m].name,
        COUNT, best, mean);
    }
  }
}

/* 2: segments ********************************************************************************* */

typedef struct bench
{
  float rgb[ENTRIES][3], opacity[ENTRIES];
  chi_transfer_view transfer;
  chi_preintegration* handle;
  float x0[COUNT], x1[COUNT], length[COUNT], rgba[COUNT][4];
} bench;

/* Of a cell's range and length, as in measure_rays. */
static void make_segments(bench* b, double cell)
{
  uint32_t seed = 5;
  for (int i = 0; i < COUNT; ++i)
  {
    const double from = next_random(&seed), way = (2 * next_random(&seed) - 1) / 16;
    b->x0[i] = (float)(from * (ENTRIES - 1));
    b->x1[i] = (float)(fmin(fmax(from + way, 0), 1) * (ENTRIES - 1));
    b->length[i] = (float)(cell * next_random(&seed));
  }
}

static void measure(bench* b, const chi_exec* exec, int kind, double times, int method,
  const int32_t size[2], double cell)
{
  static const char* const name[] = { "", "chi_none", "chi_partial", "chi_full" };
  const chi_preintegration_params params = {
    .struct_size = sizeof params, .method = method, .full_scalars = size[0], .full_depths = size[1]
  };
  chi_bench_must(
    chi_preintegration_update(exec, b->handle, &b->transfer, &params) == CHI_OK, "update");
  chi_segment_tables tables;
  chi_preintegration_get_tables(b->handle, &tables);
  double error[2], best = INFINITY;
  measure_rays(&tables, cell, error);
  for (int r = 0; r < REPEATS; ++r)
  {
    const double start = chi_bench_now();
    chi_bench_must(
      chi_segment_evaluate(&tables, COUNT, b->x0, b->x1, b->length, b->rgba[0]) == CHI_OK,
      "evaluate");
    best = fmin(best, chi_bench_now() - start);
  }
  char parameter[32] = "";
  if (method == CHI_PREINTEGRATION_FULL)
  {
    snprintf(parameter, sizeof parameter, "%dx%dx%d", size[0], size[0], size[1]);
  }
  for (int k = 0; k < 2; ++k)
  {
    printf("preintegration,%s_x%g,%s,%s,%d,1,%.0f,%.3g,%s\n", kind_name[kind], times, name[method],
      parameter, COUNT, best, error[k], k ? "ray_max_255" : "ray_mean_255");
  }
}

static void bench_segments(bench* b, const chi_exec* exec)
{
  static const int32_t sizes[][2] = { { 64, 16 }, { 128, 16 }, { 128, 32 }, { 256, 8 }, { 256, 16 },
    { 256, 32 }, { 256, 64 }, { 512, 16 } };
  const double cell = 0.125;
  make_segments(b, cell);
  for (int kind = SMOOTH; kind <= RANDOM; ++kind)
  {
    for (double times = 1; times <= 100; times *= 10)
    {
      fill_transfer(kind, ENTRIES, b->rgb, b->opacity);
      ++b->transfer.version;
      b->transfer.unit_distance = (kind == RANDOM ? 1 : cell / 3) / times;
      for (int method = 1; method <= CHI_PREINTEGRATION_FULL; ++method)
      {
        for (size_t k = 0; k < (method == CHI_PREINTEGRATION_FULL ? 8 : 1); ++k)
        {
          measure(b, exec, kind, times, method, sizes[k], cell);
        }
      }
    }
  }
}

/* 3: tables *********************************************************************************** */

static void bench_tables(bench* b)
{
  static const int32_t sizes[][2] = { { 128, 16 }, { 128, 32 }, { 256, 32 }, { 512, 16 } };
  for (int kind = SMOOTH; kind <= RANDOM; ++kind)
  {
    fill_transfer(kind, ENTRIES, b->rgb, b->opacity);
    for (size_t k = 0; k < 4; ++k)
    {
      for (int threads = 1; threads <= 2; ++threads)
      {
        chi_bench_pool pool = { threads };
        const chi_exec exec = chi_bench_exec(&pool);
        const chi_preintegration_params params = { .struct_size = sizeof params,
          .method = CHI_PREINTEGRATION_FULL,
          .full_scalars = sizes[k][0],
          .full_depths = sizes[k][1] };
        double best = INFINITY;
        for (int r = 0; r < CHI_BENCH_RUNS; ++r)
        {
          ++b->transfer.version;
          const double start = chi_bench_now();
          chi_bench_must(
            chi_preintegration_update(&exec, b->handle, &b->transfer, &params) == CHI_OK, "update");
          best = fmin(best, chi_bench_now() - start);
        }
        printf("preintegration,table_%s,chi_full,%dx%dx%d,%d,%d,%.0f,,\n", kind_name[kind],
          sizes[k][0], sizes[k][0], sizes[k][1], ENTRIES, threads, best);
      }
    }
  }
}

int main(void)
{
  bench* const b = calloc(1, sizeof *b);
  chi_bench_must(b != NULL, "calloc");
  chi_bench_pool pool = { 1 };
  const chi_exec exec = chi_bench_exec(&pool);
  chi_bench_must(chi_preintegration_create(&exec, &b->handle) == CHI_OK, "create");
  b->transfer = (chi_transfer_view){ .struct_size = sizeof b->transfer,
    .rgb = b->rgb[0],
    .opacity = b->opacity,
    .count = ENTRIES,
    .range = { 0, 1 },
    .unit_distance = 1,
    .version = 1 };
  printf(CHI_BENCH_HEADER);
  chi_bench_must(
    chi_preintegration_update(&exec, b->handle, &b->transfer, NULL) == CHI_OK, "update");
  chi_segment_tables tables;
  chi_preintegration_get_tables(b->handle, &tables);
  bench_psi(tables.psi);
  bench_segments(b, &exec);
  bench_tables(b);
  chi_preintegration_destroy(&exec, b->handle);
  free(b);
  return 0;
}
