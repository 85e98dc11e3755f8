/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Whole pictures against the exact slow path: limits are those of issue 6, in units of 1/255.
 * Prints what it measures. */
#include "chi_test.h"
#include "tet_reference.h"
#include "tet_scenes.h"

#include <chiaroscuro/chi_tet.h>

enum
{
  SIZE = 256
};

typedef struct limits
{
  double mean, most;
} limits;

/* Mean and largest error of red, green and blue over the pixels that the mesh covers. */
static void compare(const tet_mesh* mesh, const chi_camera* camera, const tet_transfer* transfer,
  int32_t method, const char* name, limits limit)
{
  chi_preintegration* tables_of;
  CHECK(chi_preintegration_create(NULL, &tables_of) == CHI_OK);
  chi_preintegration_params asked;
  chi_preintegration_default_params(&asked);
  asked.method = CHI_PREINTEGRATION_PARTIAL;
  CHECK(chi_preintegration_update(NULL, tables_of, &transfer->view, &asked) == CHI_OK);
  chi_segment_tables tables;
  chi_preintegration_get_tables(tables_of, &tables);
  const tet_reference_scene exact = { .camera = camera,
    .points = (const double(*)[3])mesh->points,
    .vertices = (const uint32_t(*)[4])mesh->vertices,
    .count = mesh->count,
    .scalars = mesh->scalars,
    .tables = &tables };
  double* const wanted = (double*)malloc(SIZE * SIZE * 4 * sizeof(double));
  tet_reference_render(&exact, wanted, NULL);

  const chi_grid_view grid = tet_mesh_grid(mesh);
  const chi_array_view scalars = { mesh->scalars, mesh->point_count, 1, sizeof(float), CHI_F32 };
  const chi_tet_field field = { .struct_size = sizeof field, .scalars = &scalars, .version = 1 };
  chi_tet_params params;
  chi_tet_default_params(&params);
  params.pre_integration = method;
  const chi_tet_frame frame = { .struct_size = sizeof frame,
    .camera = camera,
    .grid = &grid,
    .field = &field,
    .transfer = &transfer->view,
    .params = &params };
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &frame) == CHI_OK);
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
  int64_t violations = -1;
  CHECK(chi_tet_count_violations(NULL, tet, &frame, &violations) == CHI_OK);
  printf("%-36s mean %.4f  largest %.3f  violations %lld\n", name, sum / (double)count, most,
    (long long)violations);
  CHECK(sum / (double)count <= limit.mean);
  CHECK(most <= limit.most);
  CHECK(violations == 0);
  chi_tet_destroy(NULL, tet);
  chi_preintegration_destroy(NULL, tables_of);
  free(wanted);
}

static void the_test_signal_is_drawn_exactly(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(16, TET_MARSCHNER_LOBB);
  const chi_camera camera = tet_view(TET_VIEW_SIGNAL, 0, SIZE);
  static tet_transfer transfer;
  tet_transfer_signal(&transfer, 1);
  /* the largest errors have no limit in the issue; theirs is twice what is measured, 1.1 and 5.2 of
   * partial, where colours bend inside of cells, 0.1 of full */
  compare(
    mesh, &camera, &transfer, CHI_PREINTEGRATION_PARTIAL, "signal, partial", (limits){ 0.05, 2.5 });
  compare(mesh, &camera, &transfer, CHI_PREINTEGRATION_FULL, "signal, full", (limits){ 0.05, 0.2 });
  tet_transfer_signal(&transfer, 10);
  compare(
    mesh, &camera, &transfer, CHI_PREINTEGRATION_FULL, "signal x 10, full", (limits){ 0.05, 0.5 });
  tet_mesh_free(mesh);
}

/* sigma 1/200 of the range, an optical depth of 3 over the length of a cell, 1/8, at the peak */
static void a_narrow_peak_survives(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(16, TET_OBLIQUE_RAMP);
  const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, SIZE);
  static tet_transfer transfer;
  tet_transfer_peak(&transfer, 1.0 / 200, 24);
  compare(mesh, &camera, &transfer, CHI_PREINTEGRATION_FULL, "peak, full", (limits){ 0.1, 1 });
  compare(mesh, &camera, &transfer, CHI_PREINTEGRATION_AUTO, "peak, automatic", (limits){ 0.1, 1 });
  tet_mesh_free(mesh);
}

int main(void)
{
  the_test_signal_is_drawn_exactly();
  a_narrow_peak_survives();
  return chi_test_report();
}
