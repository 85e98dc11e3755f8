/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* One straight line, tubed: the area of the prism around it has a closed form. Every public header is
 * included, so that one that is not installed is missed. */

#include <chiaroscuro/chi.h>
#include <chiaroscuro/chi_camera.h>
#include <chiaroscuro/chi_occlusion.h>
#include <chiaroscuro/chi_spline.h>
#include <chiaroscuro/chi_surface.h>
#include <chiaroscuro/chi_transfer.h>
#include <chiaroscuro/chi_tube.h>
#include <chiaroscuro/chi_volume.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
  SIDES = 8
};

static double triangle_area(const double* p, const int64_t* id)
{
  double u[3], v[3];
  for (int k = 0; k < 3; ++k)
  {
    u[k] = p[3 * id[1] + k] - p[3 * id[0] + k];
    v[k] = p[3 * id[2] + k] - p[3 * id[0] + k];
  }
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2];
  const double z = u[0] * v[1] - u[1] * v[0];
  return 0.5 * sqrt(x * x + y * y + z * z);
}

int main(void)
{
  const double position[2][3] = { { 1, 2, 3 }, { 1, 2, 5 } };
  const int64_t offsets[2] = { 0, 2 };
  const chi_lines_view lines = { { position, 2, sizeof position[0], CHI_F64 }, offsets, NULL, 1 };
  const chi_spline_params fit = { .struct_size = sizeof fit, .method = CHI_SPLINE_POLYLINE };
  const chi_tube_params params = { .struct_size = sizeof params,
    .radius = 0.25,
    .sides = SIDES,
    .cells = CHI_TUBE_TRIANGLES,
    .chord_tolerance = 0.01,
    .angular_tolerance_rad = 0.1 };
  chi_spline* spline = NULL;
  chi_tube* tube = NULL;
  if (chi_spline_create(NULL, &spline) != CHI_OK || chi_tube_create(NULL, &tube) != CHI_OK ||
    chi_spline_fit(NULL, spline, &lines, &fit) != CHI_OK ||
    chi_tube_plan(NULL, tube, spline, &lines, &params) != CHI_OK)
  {
    fprintf(stderr, "the tube could not be planned\n");
    return EXIT_FAILURE;
  }
  chi_tube_sizes sizes;
  chi_tube_get_sizes(tube, &sizes);
  double* const points = (double*)malloc(sizes.points * 3 * sizeof *points);
  int64_t* const connectivity = (int64_t*)malloc(sizes.connectivity * sizeof *connectivity);
  const chi_tube_outputs out = { .struct_size = sizeof out,
    .points = points,
    .point_type = CHI_F64,
    .connectivity = connectivity };
  if (!points || !connectivity || chi_tube_sweep(NULL, tube, &out) != CHI_OK)
  {
    fprintf(stderr, "the tube could not be swept\n");
    return EXIT_FAILURE;
  }
  double area = 0;
  for (size_t i = 0; i < sizes.cells; ++i)
  {
    area += triangle_area(points, connectivity + 3 * i);
  }
  /* a prism of length 2 over a regular octagon; offsets from the axis are floats */
  const double expected = 2 * SIDES * 2 * 0.25 * sin(3.14159265358979324 / SIDES);
  chi_tube_destroy(NULL, tube);
  chi_spline_destroy(NULL, spline);
  free(points);
  free(connectivity);
  printf("version %d, area %.9g, expected %.9g\n", (int)chi_version(), area, expected);
  return fabs(area - expected) <= 1e-6 * expected ? EXIT_SUCCESS : EXIT_FAILURE;
}
