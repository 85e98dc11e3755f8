/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Transfer functions of two quantities, judged by the table of one and by their rows. */

#include "occlusion_shaded.h"

enum
{
  ROWS = 5
};

static float plane[ROWS][ENTRIES][4];

static void use_plane(double low, double high)
{
  the.transfer.plane = plane[0][0];
  the.transfer.plane_count[0] = ENTRIES;
  the.transfer.plane_count[1] = ROWS;
  the.transfer.plane_range[0] = low;
  the.transfer.plane_range[1] = high;
}

/* Rows that are alike are a table of one quantity, of which opacity is linear between entries: a
 * sixteenth of them is as fine as the engine takes it. */
static void a_plane_of_equal_rows_is_the_table_of_one_row(void)
{
  enum
  {
    FINE = 16 * (ENTRIES - 1) + 1
  };
  static float expected[4 * PIXELS * PIXELS], white[3 * FINE], opacity[FINE];
  for (int k = 0; k < 3; ++k)
  {
    uint32_t state = 5;
    scene_init(frames[1]);
    the.frame.shading = NULL;
    the.transfer.range[0] = 0;
    the.transfer.range[1] = k == 1 ? 1000 : 1; /* 1: segments cross less than an entry */
    the.volume.interpolation = k == 2 ? CHI_NEAREST : CHI_LINEAR;
    for (int i = 0; i < COUNT; ++i)
    {
      the.scalars[i] = (float)chi_test_random(&state);
    }
    for (int i = 0; i < ENTRIES; ++i)
    {
      the.opacity[i] = (float)(0.5 * chi_test_random(&state));
      for (int j = 0; j < ROWS; ++j)
      {
        plane[j][i][0] = plane[j][i][1] = plane[j][i][2] = 1;
        plane[j][i][3] = the.opacity[i];
      }
    }
    for (int i = 0; i < FINE; ++i)
    {
      const int at = i < FINE - 1 ? i / 16 : ENTRIES - 2;
      const float f = (float)(i - 16 * at) / 16;
      opacity[i] = the.opacity[at] + f * (the.opacity[at + 1] - the.opacity[at]);
      white[3 * i] = white[3 * i + 1] = white[3 * i + 2] = 1;
    }
    the.transfer.rgb = white;
    the.transfer.opacity = opacity;
    the.transfer.count = FINE;
    memcpy(expected, render(NULL, CHI_OK), sizeof expected);
    use_plane(0, 3);
    const float* const rgba = render(NULL, CHI_OK);
    double largest = 0;
    for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
    {
      largest = fmax(largest, fabs((double)rgba[i] - (double)expected[i]));
    }
    CHECK(expected[4 * (PIXELS / 2 * PIXELS + PIXELS / 2) + 3] > 0.3f);
    CHECK_NEAR(largest, 0, 1e-5); /* roundings of the tables in float */
  }
}

static void a_plane_reads_the_gradient_or_the_second_samples_along_its_rows(void)
{
  static float second[COUNT];
  const double g[3] = { 0.3, -0.5, 0.8 };
  const double magnitude = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int k = 0; k < 2; ++k)
  {
    scene_init(identity);
    the.frame.shading = NULL;
    fill_ramp(g);
    cut_border();
    const double y = k ? 7 : magnitude;
    for (int i = 0; i < COUNT; ++i)
    {
      second[i] = 7;
    }
    for (int j = 0; j < ROWS; ++j)
    {
      for (int i = 0; i < ENTRIES; ++i)
      {
        plane[j][i][0] = (float)j / (ROWS - 1);
        plane[j][i][1] = (float)i / (ENTRIES - 1);
        plane[j][i][2] = 0;
        plane[j][i][3] = 0.02f * (float)j / (ROWS - 1);
      }
    }
    use_plane(0.5 * y, 2.5 * y); /* y lies at a quarter of the rows */
    the.transfer.y_samples = k ? second : NULL;
    the.transfer.unit_distance = 1;
    const float* const p = centre_of(render(NULL, CHI_OK));
    CHECK_NEAR(p[0] / p[3], 0.25, 1e-4);
    /* 19 samples of the cut cube along the axis; opacity 0.005 a unit, corrected for any step */
    const double alpha = 1 - pow(1 - 0.005, 19);
    CHECK_NEAR(p[3], alpha, 2e-5);
    for (int step = 1; step < 4; ++step)
    {
      the.params.sample_distance = 0.13 * step * step;
      CHECK_NEAR(centre_of(render(NULL, CHI_OK))[3], alpha, 2e-5);
    }
    /* where rows are transparent, nothing is drawn, and nothing falls over what is not finite */
    the.transfer.plane_range[0] = y;
    the.transfer.plane_range[1] = 2 * y;
    CHECK(centre_of(render(NULL, CHI_OK))[3] <= 1e-5f);
    use_plane(0, y);
    second[COUNT / 2] = NAN;
    const float* const q = render(NULL, CHI_OK);
    for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
    {
      CHECK(isfinite(q[i]));
    }
  }
}

static void planes_that_make_no_sense_are_refused(void)
{
  const struct
  {
    size_t nx, ny;
    double low, high;
  } bad[] = { { 1, 2, 0, 1 }, { 2, 1, 0, 1 }, { 70000, 2, 0, 1 }, { 4096, 4096, 0, 1 },
    { 2, 2, 1, 1 }, { 2, 2, 0, NAN } };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
  {
    scene_init(identity);
    use_plane(bad[i].low, bad[i].high);
    the.transfer.plane_count[0] = bad[i].nx;
    the.transfer.plane_count[1] = bad[i].ny;
    render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  }
  scene_init(identity);
  use_plane(0, 1);
  the.transfer.rgb = the.transfer.opacity = NULL; /* are not read */
  render(NULL, CHI_OK);
}

int main(void)
{
  a_plane_of_equal_rows_is_the_table_of_one_row();
  a_plane_reads_the_gradient_or_the_second_samples_along_its_rows();
  planes_that_make_no_sense_are_refused();
  return chi_test_report();
}
