/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The core alone: a volume of metaballs, rendered with occlusion to a PPM. occlusion [FILE.ppm] */

#include <chiaroscuro/chi_occlusion.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
  N = 96,   /* samples a side */
  SIZE = 512 /* pixels a side */
};

static float* metaballs(void)
{
  float* const field = malloc((size_t)N * N * N * sizeof *field);
  for (size_t i = 0; field && i < (size_t)N * N * N; ++i)
  {
    const double x = (double)(i % N) / N, y = (double)(i / N % N) / N, z = (double)(i / N / N) / N;
    double sum = 0;
    for (int b = 0; b < 9; ++b)
    {
      const double dx = x - 0.5 - 0.28 * cos(2.4 * b), dy = y - 0.15 - 0.08 * b;
      const double dz = z - 0.5 - 0.28 * sin(2.4 * b);
      sum += 0.008 / (dx * dx + dy * dy + dz * dz + 1e-4);
    }
    field[i] = (float)sum;
  }
  return field;
}

int main(int argc, char* argv[])
{
  float* const field = metaballs();
  if (!field)
  {
    return EXIT_FAILURE;
  }
  const chi_volume_view volume = { .struct_size = sizeof volume,
    .scalars = field,
    .type = CHI_F32,
    .stride = sizeof *field,
    .dimensions = { N, N, N },
    .index_to_world = { 1, 0, 0, -N / 2, 0, 1, 0, -N / 2, 0, 0, 1, -N / 2, 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  /* opaque where the field exceeds 1, with a short ramp; warm inside, cool outside */
  float rgb[256][3], opacity[256];
  for (int i = 0; i < 256; ++i)
  {
    const float s = (float)i / 255 * 4;
    opacity[i] = s < 0.95f ? 0 : s < 1.15f ? (s - 0.95f) * 4 : 0.8f;
    rgb[i][0] = 0.95f;
    rgb[i][1] = 0.85f - 0.1f * s;
    rgb[i][2] = 0.75f - 0.15f * s;
  }
  const chi_transfer_view transfer = { sizeof transfer, &rgb[0][0], opacity, 256, { 0, 4 }, 1, 1 };
  const chi_camera camera = { .struct_size = sizeof camera,
    .world_to_eye = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -240, 0, 0, 0, 1 },
    .window = { -0.27, 0.27, -0.27, 0.27 },
    .width = SIZE,
    .height = SIZE,
    .near_depth = 1 };
  chi_occlusion_params params;
  chi_occlusion_default_params(&params);
  const chi_occlusion_frame frame = { sizeof frame, &camera, &volume, &transfer, NULL, &params, NULL };

  chi_occlusion* occlusion = NULL;
  chi_status status = chi_occlusion_create(NULL, &occlusion);
  status = status == CHI_OK ? chi_occlusion_render(NULL, occlusion, &frame) : status;
  if (status != CHI_OK)
  {
    fprintf(stderr, "%s\n", chi_status_string(status));
    return EXIT_FAILURE;
  }
  chi_occlusion_image image;
  chi_occlusion_get_image(occlusion, &image);
  FILE* const file = fopen(argc > 1 ? argv[1] : "occlusion.ppm", "wb");
  if (!file)
  {
    perror("cannot write the picture");
    return EXIT_FAILURE;
  }
  fprintf(file, "P6\n%d %d\n255\n", SIZE, SIZE);
  for (int y = SIZE - 1; y >= 0; --y) /* row 0 is the lowest */
  {
    for (int x = 0; x < SIZE; ++x)
    {
      const float* const p = image.rgba + 4 * ((size_t)y * SIZE + (size_t)x);
      for (int c = 0; c < 3; ++c)
      {
        const float over_white = p[c] + (1 - p[3]);
        fputc((int)(255 * fminf(fmaxf(over_white, 0), 1) + 0.5f), file);
      }
    }
  }
  fclose(file);
  chi_occlusion_destroy(NULL, occlusion);
  free(field);
  return EXIT_SUCCESS;
}
