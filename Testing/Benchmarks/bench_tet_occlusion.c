/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Run time against error of occlusion for tetrahedra: numbers of slabs against twice the most,
 * numbers of directions against the most; the test signal, 256^2 pixels, errors in units of 1/255.
 * Without occlusion for comparison. */
#include "chi_bench.h"
#include "tet_frame.h"

#include <math.h>
#include <string.h>

enum
{
  SIZE = 256,
  FLOATS = 4 * SIZE * SIZE,
  MOST_SLABS = 256
};

static int threads = 2;

/* The fastest of frames of a view that is drawn anew. */
static double time_frame(chi_tet* tet, scene* s, float* rgba)
{
  chi_bench_pool pool = { threads };
  const chi_exec exec = chi_bench_exec(&pool);
  double best = INFINITY;
  const double distance = s->camera.world_to_eye[11];
  for (int run = 0; run <= CHI_BENCH_RUNS; ++run)
  {
    s->camera.world_to_eye[11] = distance * (run % 2 ? 1 : 1.001);
    const double start = chi_bench_now();
    if (chi_tet_render(&exec, tet, &s->frame) != CHI_OK)
    {
      exit(EXIT_FAILURE);
    }
    const double time = chi_bench_now() - start;
    best = time < best ? time : best;
  }
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  memcpy(rgba, image.rgba, FLOATS * sizeof(float));
  return best; /* the last one stood where the first view was */
}

static void print_errors(const char* method, int parameter, size_t count, double time,
  const float* rgba, const float* exact)
{
  double sum = 0, most = 0;
  int64_t shown = 0;
  for (int i = 0; i < FLOATS; ++i)
  {
    const double error = 255 * fabs((double)rgba[i] - (double)exact[i]);
    sum += i % 4 < 3 ? error : 0;
    most = i % 4 < 3 && error > most ? error : most;
    shown += i % 4 < 3 && exact[i | 3] > 1.0f / 255;
  }
  printf("tet_occlusion,signal,%s,%d,%zu,%d,%.0f,%.4f,mean of 255\n", method, parameter, count,
    threads, time, sum / (double)shown);
  printf("tet_occlusion,signal,%s,%d,%zu,%d,%.0f,%.4f,largest of 255\n", method, parameter, count,
    threads, time, most);
  fflush(stdout);
}

int main(int argc, char** argv)
{
  const size_t n = argc > 1 ? (size_t)atoi(argv[1]) : 32;
  threads = argc > 2 ? atoi(argv[2]) : threads;
  float* const rgba = (float*)malloc(FLOATS * sizeof(float));
  float* const exact = (float*)malloc(FLOATS * sizeof(float));
  tet_mesh* const mesh = tet_mesh_cubes(n, TET_MARSCHNER_LOBB);
  scene s;
  chi_tet* tet;
  if (!rgba || !exact || !mesh || chi_tet_create(NULL, &tet) != CHI_OK)
  {
    return EXIT_FAILURE;
  }
  make_scene(&s, mesh, TET_VIEW_SIGNAL, 0, SIZE);
  tet_transfer_signal(&s.transfer, 3);
  s.params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  printf(CHI_BENCH_HEADER);
  const double off = time_frame(tet, &s, rgba);
  printf("tet_occlusion,signal,off,0,%zu,%d,%.0f,,\n", mesh->count, threads, off);
  s.params.occlusion_strength = 1;
  s.params.occlusion_slabs = 2 * MOST_SLABS;
  time_frame(tet, &s, exact);
  for (int slabs = 16; slabs <= MOST_SLABS; slabs *= 2)
  {
    s.params.occlusion_slabs = slabs;
    const double time = time_frame(tet, &s, rgba);
    print_errors("slabs", slabs, mesh->count, time, rgba, exact);
  }
  s.params.occlusion_slabs = 128;
  s.params.direction_count = 64;
  time_frame(tet, &s, exact);
  for (int directions = 4; directions <= 32; directions *= 2)
  {
    s.params.direction_count = directions;
    const double time = time_frame(tet, &s, rgba);
    print_errors("directions", directions, mesh->count, time, rgba, exact);
  }
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
  free(rgba);
  free(exact);
  return 0;
}
