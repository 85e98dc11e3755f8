/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Run time against error of tetrahedra: methods of pre-integration against the exact slow path, a
 * homogeneous cube against its closed form, and both by the published projection ("published", and
 * the method); 256^2 pixels, one thread, errors in units of 1/255. */
#include "chi_bench.h"
#include "tet_frame.h"
#include "tet_reference.h"
#include "tet_tiny.h"

#include <math.h>
#include <string.h>

enum
{
  SIZE = 256
};

/* The fastest of frames of a view that is drawn anew: all stages of a view, none of the mesh. */
static double time_frame(chi_tet* tet, scene* s)
{
  double best = INFINITY;
  const double distance = s->camera.world_to_eye[11];
  for (int run = 0; run < 2 * CHI_BENCH_RUNS; ++run)
  {
    s->camera.world_to_eye[11] = distance * (run % 2 ? 1 : 1.001);
    const double start = chi_bench_now();
    if (chi_tet_render(NULL, tet, &s->frame) != CHI_OK)
    {
      exit(EXIT_FAILURE);
    }
    const double time = chi_bench_now() - start;
    best = time < best ? time : best;
  }
  return best; /* the last one stood where the first view was */
}

static void print_errors(const char* name, const char* method, const char* parameter, size_t count,
  double time, double mean, double most)
{
  printf(
    "tet_error,%s,%s,%s,%zu,1,%.0f,%.5f,mean of 255\n", name, method, parameter, count, time, mean);
  printf("tet_error,%s,%s,%s,%zu,1,%.0f,%.5f,largest of 255\n", name, method, parameter, count,
    time, most);
  fflush(stdout);
}

static chi_tet* make_renderer(void)
{
  chi_tet* tet;
  if (chi_tet_create(NULL, &tet) != CHI_OK)
  {
    exit(EXIT_FAILURE);
  }
  return tet;
}

static void bench_homogeneous(size_t n, int view, int parallel)
{
  static const char* const names[] = { "axis", "oblique", "close", "inside" };
  tet_mesh* const mesh = tet_mesh_cubes(n, TET_CONSTANT);
  scene s;
  make_scene(&s, mesh, view, parallel, SIZE);
  char name[64], parameter[32];
  snprintf(name, sizeof name, "cube %s %s", names[view], parallel ? "parallel" : "perspective");
  snprintf(parameter, sizeof parameter, "n = %zu", n);
  for (int32_t projection = CHI_TET_PROJECTION_EXACT; projection <= CHI_TET_PROJECTION_PUBLISHED;
       ++projection)
  {
    s.params.projection = projection;
    chi_tet* const tet = make_renderer();
    const double time = time_frame(tet, &s);
    chi_tet_image image;
    chi_tet_get_image(tet, &image);
    double sum = 0, most = 0;
    int64_t count = 0;
    for (int i = 0; i < SIZE * SIZE; ++i)
    {
      const double length = tet_reference_cube_length(&s.camera, i % SIZE + 0.5, i / SIZE + 0.5);
      if (length > 0.15) /* as the issue has it */
      {
        const double error = 255 * fabs((double)image.rgba[4 * i + 3] + expm1(-0.3 * length));
        sum += error;
        most = error > most ? error : most;
        ++count;
      }
    }
    print_errors(name, projection ? "published partial" : "partial", parameter, mesh->count, time,
      count ? sum / (double)count : 0, most);
    chi_tet_destroy(NULL, tet);
  }
  tet_mesh_free(mesh);
}

static void bench_colors(
  const char* name, const tet_mesh* mesh, const chi_camera* camera, const tet_transfer* transfer)
{
  static const char* const names[] = { "automatic", "none", "partial", "full" };
  scene s;
  make_scene(&s, mesh, TET_VIEW_AXIS, 0, SIZE);
  s.camera = *camera;
  s.frame.transfer = &transfer->view;
  chi_preintegration* owner;
  chi_preintegration_params params;
  chi_preintegration_default_params(&params);
  params.method = CHI_PREINTEGRATION_PARTIAL;
  if (chi_preintegration_create(NULL, &owner) != CHI_OK ||
    chi_preintegration_update(NULL, owner, &transfer->view, &params) != CHI_OK)
  {
    exit(EXIT_FAILURE);
  }
  chi_segment_tables tables;
  chi_preintegration_get_tables(owner, &tables);
  const tet_reference_scene exact = { .camera = camera,
    .points = (const double(*)[3])mesh->points,
    .vertices = (const uint32_t(*)[4])mesh->vertices,
    .count = mesh->count,
    .scalars = mesh->scalars,
    .tables = &tables };
  double* const wanted = (double*)malloc(SIZE * SIZE * 4 * sizeof(double));
  tet_reference_render(&exact, wanted, NULL);
  static const int32_t last = CHI_PREINTEGRATION_FULL;
  for (int32_t way = CHI_PREINTEGRATION_NONE; way <= 2 * last; ++way) /* then all published */
  {
    const int32_t method = way > last ? way - last : way;
    s.params.pre_integration = method;
    s.params.projection = way > last ? CHI_TET_PROJECTION_PUBLISHED : CHI_TET_PROJECTION_EXACT;
    chi_tet* const tet = make_renderer();
    const double time = time_frame(tet, &s);
    chi_tet_image image;
    chi_tet_get_image(tet, &image);
    double sum = 0, most = 0;
    int64_t count = 0;
    for (int i = 0; i < SIZE * SIZE; ++i)
    {
      for (int k = 0; k < 3 && wanted[4 * i + 3] > 0; ++k)
      {
        const double error = 255 * fabs((double)image.rgba[4 * i + k] - wanted[4 * i + k]);
        sum += error;
        most = error > most ? error : most;
        ++count;
      }
    }
    char label[64];
    snprintf(label, sizeof label, "%s%s", way > last ? "published " : "", names[method]);
    print_errors(name, label, "", mesh->count, time, sum / (double)count, most);
    chi_tet_destroy(NULL, tet);
  }
  free(wanted);
  chi_preintegration_destroy(NULL, owner);
}

enum
{
  FEW = 64,   /* pixels a side of pictures of small cells */
  SAMPLES = 4 /* a side of each, for what they are judged by */
};

/* Means of so many pixels a side. */
static void reduce(const float* from, int times, float* to)
{
  const int width = FEW * times;
  memset(to, 0, 4 * FEW * FEW * sizeof *to);
  for (int i = 0; i < 4 * width * width; ++i)
  {
    const int x = i / 4 % width / times, y = i / 4 / width / times;
    to[4 * (y * FEW + x) + i % 4] += from[i] / (float)(times * times);
  }
}

/* Cells below a pixel: one ray a pixel, splatted, and 16 rays, by which the others are judged. */
static void bench_small(const char* name, const tet_mesh* mesh)
{
  static float wanted[4 * FEW * FEW];
  static tet_transfer transfer;
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, FEW);
  tet_transfer_signal(&transfer, 1);
  s.frame.transfer = &transfer.view;
  static const char* const names[] = { "16 rays", "one ray", "splatted" };
  for (int way = 0; way < 3; ++way)
  {
    const int times = way ? 1 : SAMPLES;
    s.camera.width = s.camera.height = FEW * times;
    s.params.subpixel_splatting = way == 2;
    chi_tet* const tet = make_renderer();
    const double time = time_frame(tet, &s);
    chi_tet_image image;
    chi_tet_get_image(tet, &image);
    if (!way)
    {
      reduce(image.rgba, times, wanted);
    }
    double sum = 0, most = 0;
    for (int i = 0; i < 4 * FEW * FEW && way; ++i)
    {
      const double error = 255 * fabs((double)image.rgba[i] - (double)wanted[i]);
      sum += error;
      most = error > most ? error : most;
    }
    print_errors(name, names[way], "64 x 64", mesh->count, time, sum / (4 * FEW * FEW), most);
    chi_tet_destroy(NULL, tet);
  }
}

int main(void)
{
  printf(CHI_BENCH_HEADER);
  tet_mesh* small = tet_tiny_noise(40, 3);
  bench_small("cells of a pixel", small);
  tet_mesh_free(small);
  small = tet_tiny_dust(100000, 0.002, 0.02, 7);
  bench_small("dust", small);
  tet_mesh_free(small);
  small = tet_tiny_graded(20, 1000, 1);
  bench_small("edges 1000:1", small);
  tet_mesh_free(small);
  static const size_t sizes[] = { 1, 4, 16, 64 };
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k)
  {
    for (int view = TET_VIEW_AXIS; view <= TET_VIEW_INSIDE; ++view)
    {
      for (int parallel = 0; parallel <= (view != TET_VIEW_INSIDE); ++parallel)
      {
        bench_homogeneous(sizes[k], view, parallel);
      }
    }
  }
  static tet_transfer transfer;
  chi_camera camera = tet_view(TET_VIEW_SIGNAL, 0, SIZE);
  tet_mesh* mesh = tet_mesh_cubes(16, TET_MARSCHNER_LOBB);
  tet_transfer_signal(&transfer, 1);
  bench_colors("signal", mesh, &camera, &transfer);
  tet_transfer_signal(&transfer, 10);
  bench_colors("signal x 10", mesh, &camera, &transfer);
  tet_mesh_free(mesh);
  mesh = tet_mesh_cubes(16, TET_OBLIQUE_RAMP);
  camera = tet_view(TET_VIEW_OBLIQUE, 0, SIZE);
  tet_transfer_peak(&transfer, 1.0 / 200, 24);
  bench_colors("narrow peak", mesh, &camera, &transfer);
  tet_mesh_free(mesh);
  return EXIT_SUCCESS;
}
