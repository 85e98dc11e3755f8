/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Transfer functions drawn by shapes: at a place, and as tables. */

#include "chi_test.h"

#include <chiaroscuro/chi_transfer_shapes.h>

#define ROUNDING 1e-15 /* a few roundings of numbers about 1 */

static chi_transfer_shape shape(int32_t kind, double opacity)
{
  return (chi_transfer_shape){ .struct_size = sizeof(chi_transfer_shape),
    .kind = kind,
    .rgba = { 1, 0.5, 0.25, opacity },
    .low = { 1, 10 },
    .high = { 3, 30 },
    .top = { 0, 4 },
    .center = { 2, 20 },
    .sigma = { 0.5, 4 } };
}

static double opacity_at(const chi_transfer_shape* s, double x, double y)
{
  double rgba[4] = { -1, -1, -1, -1 };
  CHECK(chi_transfer_shapes_map(s, 1, x, y, rgba) == CHI_OK);
  return rgba[3];
}

static void a_rectangle_is_hard_or_soft(void)
{
  chi_transfer_shape s = shape(CHI_SHAPE_RECTANGLE, 0.8);
  CHECK_NEAR(opacity_at(&s, 1.01, 29), 0.8, ROUNDING);
  CHECK(opacity_at(&s, 0.99, 20) == 0 && opacity_at(&s, 3.01, 20) == 0);
  CHECK(
    opacity_at(&s, 2, 9.9) == 0 && opacity_at(&s, 2, 30.1) == 0 && opacity_at(&s, NAN, 20) == 0);
  s.softness = 0.5;
  CHECK_NEAR(opacity_at(&s, 2, 20), 0.8, ROUNDING);
  CHECK_NEAR(opacity_at(&s, 1.25, 20), 0.4, ROUNDING);       /* a quarter in of the half width */
  CHECK_NEAR(opacity_at(&s, 1.25, 10 + 2.5), 0.2, ROUNDING); /* and of the half height */
}

static void a_trapezoid_widens_upwards(void)
{
  chi_transfer_shape s = shape(CHI_SHAPE_TRAPEZOID, 1);
  CHECK(opacity_at(&s, 1.1, 10) == 1 && opacity_at(&s, 0.9, 10) == 0);
  CHECK(opacity_at(&s, 0.6, 20) == 1 && opacity_at(&s, 0.4, 20) == 0); /* 0.5 ... 3.5 */
  CHECK(opacity_at(&s, 0.1, 30) == 1 && opacity_at(&s, 2, 30.1) == 0);
  s.softness = 1; /* Kniss's triangle: from one point, and a tent across */
  s.low[0] = s.high[0] = 2;
  CHECK_NEAR(opacity_at(&s, 2, 20), 1, ROUNDING);
  CHECK_NEAR(opacity_at(&s, 1.5, 20), 0.5, ROUNDING);
  CHECK(opacity_at(&s, 2, 10) == 1 && opacity_at(&s, 2.1, 10) == 0);
}

static void a_gaussian_has_its_deviations_and_correlation(void)
{
  chi_transfer_shape s = shape(CHI_SHAPE_GAUSSIAN, 0.5);
  CHECK_NEAR(opacity_at(&s, 2, 20), 0.5, ROUNDING);
  CHECK_NEAR(opacity_at(&s, 2.5, 20), 0.5 * exp(-0.5), ROUNDING);
  CHECK_NEAR(opacity_at(&s, 2, 12), 0.5 * exp(-2), ROUNDING);
  s.correlation = 0.5; /* along the diagonal of both deviations: (1 - c) 2 / (1 - c^2) = 4 / 3 */
  CHECK_NEAR(opacity_at(&s, 2.5, 24), 0.5 * exp(-0.5 * 4.0 / 3), ROUNDING);
}

static void a_polygon_that_crosses_itself_has_a_hole(void)
{
  double star[10]; /* a pentagram: its middle is outside */
  for (int i = 0; i < 5; ++i)
  {
    star[2 * i] = 2 + sin(i * 4 * 3.14159265358979 / 5);
    star[2 * i + 1] = 20 + 10 * cos(i * 4 * 3.14159265358979 / 5);
  }
  chi_transfer_shape s = shape(CHI_SHAPE_POLYGON, 1);
  s.polygon = star;
  s.polygon_count = 5;
  CHECK(opacity_at(&s, 2, 20) == 0);
  CHECK(opacity_at(&s, 2, 28) == 1 && opacity_at(&s, 2, 31) == 0 && opacity_at(&s, 1, 12) == 0);
}

static void an_image_is_linear_between_its_entries_and_holds_beyond(void)
{
  static const float image[2 * 3 * 4] = { 0, 0, 0, 0, 1, 0, 0, 0.5f, 0, 1, 0, 1, 0, 0, 1, 0.25f, 1,
    1, 1, 0.75f, 0, 0, 0, NAN };
  chi_transfer_shape s = shape(CHI_SHAPE_IMAGE, 1);
  s.rgba[0] = s.rgba[1] = s.rgba[2] = 1;
  s.image = image;
  s.image_size[0] = 3;
  s.image_size[1] = 2;
  CHECK_NEAR(opacity_at(&s, 1.5, 10), 0.25, ROUNDING);
  CHECK_NEAR(opacity_at(&s, 1, 20), 0.125, ROUNDING);
  CHECK_NEAR(opacity_at(&s, -5, 100), 0.25, ROUNDING);
  CHECK_NEAR(opacity_at(&s, 9, 0), 1, 1e-7);      /* more than 1 - 2^-24 would be no extinction */
  CHECK_NEAR(opacity_at(&s, 9, 99), 0, ROUNDING); /* NaN */
  s.rgba[3] = 0.5;
  CHECK_NEAR(opacity_at(&s, 1.5, 10), 0.125, ROUNDING);
}

static void materials_mix_in_any_order(void)
{
  chi_transfer_shape s[3] = { shape(CHI_SHAPE_RECTANGLE, 0.5), shape(CHI_SHAPE_GAUSSIAN, 0.75),
    shape(CHI_SHAPE_TRAPEZOID, 0) };
  memcpy(s[1].rgba, (double[3]){ 0, 1, 1 }, 3 * sizeof(double));
  double rgba[4], again[4];
  CHECK(chi_transfer_shapes_map(s, 3, 2, 20, rgba) == CHI_OK);
  CHECK_NEAR(rgba[3], 1 - 0.5 * 0.25, ROUNDING);
  CHECK_NEAR(rgba[0], 1.0 / 3, 1e-7); /* extinctions are as ln 2 to ln 4 */
  CHECK_NEAR(rgba[1], (0.5 + 2 * 1) / 3, 1e-7);
  const chi_transfer_shape turned[3] = { s[2], s[1], s[0] };
  CHECK(chi_transfer_shapes_map(turned, 3, 2, 20, again) == CHI_OK);
  for (int c = 0; c < 4; ++c)
  {
    CHECK_NEAR(again[c], rgba[c], ROUNDING);
  }
  CHECK(chi_transfer_shapes_map(NULL, 0, 2, 20, rgba) == CHI_OK && rgba[0] == 0 && rgba[3] == 0);
}

enum
{
  NX = 61,
  NY = 41
};

/* Mean of every entry by many more places than the table takes. */
static void tables_have_the_mean_of_hard_shapes_and_the_values_of_soft_ones(void)
{
  static float table[NY][NX][4];
  static double triangle[6] = { 0.53, 11.1, 3.71, 14.9, 1.9, 33.7 };
  const size_t size[2] = { NX, NY };
  const double x_range[2] = { 0, 4 }, y_range[2] = { 5, 35 };
  const double step[2] = { 4.0 / (NX - 1), 30.0 / (NY - 1) };
  for (int32_t kind = CHI_SHAPE_RECTANGLE; kind <= CHI_SHAPE_POLYGON; ++kind)
  {
    chi_transfer_shape s = shape(kind, 1);
    s.polygon = triangle;
    s.polygon_count = 3;
    s.low[0] = 1.013; /* not on an entry */
    CHECK(
      chi_transfer_shapes_table(NULL, &s, 1, size, x_range, y_range, &table[0][0][0]) == CHI_OK);
    double most = 0, inside = 0;
    for (int j = 0; j < NY; ++j)
    {
      for (int i = 0; i < NX; ++i)
      {
        const double x = i * step[0], y = 5 + j * step[1];
        enum
        {
          MANY = 40
        };
        double mean = 0;
        for (int k = 0; k < MANY * MANY; ++k)
        {
          mean += opacity_at(&s, x + ((k % MANY + 0.5) / MANY - 0.5) * step[0],
            y + ((k / MANY + 0.5) / MANY - 0.5) * step[1]);
        }
        mean = kind == CHI_SHAPE_GAUSSIAN ? opacity_at(&s, x, y) : mean / (MANY * MANY);
        most = fmax(most, fabs((double)table[j][i][3] - mean));
        inside += mean;
      }
    }
    CHECK(inside > 100);
    /* of 8 x 8 places one edge can be wrong by a sixteenth, two at a corner by an eighth; a
     * rounding of a float of what is a value */
    CHECK(most <= (kind == CHI_SHAPE_GAUSSIAN ? 1e-7 : 2.0 / 16));
  }
}

static void tables_have_the_same_bits_under_any_schedule(void)
{
  static float table[2][NY][NX][4];
  static double triangle[6] = { 0.53, 11.1, 3.71, 14.9, 1.9, 33.7 };
  chi_transfer_shape s[4] = { shape(CHI_SHAPE_RECTANGLE, 0.3), shape(CHI_SHAPE_GAUSSIAN, 0.7),
    shape(CHI_SHAPE_POLYGON, 0.5), shape(CHI_SHAPE_TRAPEZOID, 0.2) };
  s[2].polygon = triangle;
  s[2].polygon_count = 3;
  const size_t size[2] = { NX, NY };
  const double x_range[2] = { 0, 4 }, y_range[2] = { 5, 35 };
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  CHECK(
    chi_transfer_shapes_table(NULL, s, 4, size, x_range, y_range, &table[0][0][0][0]) == CHI_OK);
  CHECK(chi_transfer_shapes_table(&backwards, s, 4, size, x_range, y_range, &table[1][0][0][0]) ==
    CHI_OK);
  CHECK(memcmp(table[0], table[1], sizeof table[0]) == 0);
  for (long at = 0; at < 8; ++at)
  {
    chi_test_host host = { .refuse_at = at, .cancel_at = 1000 };
    const chi_exec refusing = { .struct_size = sizeof refusing,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    const chi_status status =
      chi_transfer_shapes_table(&refusing, s, 4, size, x_range, y_range, &table[1][0][0][0]);
    CHECK(status == (host.allocations > at ? CHI_ERROR_OUT_OF_MEMORY : CHI_OK) && host.live == 0);
  }
  chi_test_host host = { .refuse_at = -1, .cancel_at = 0 };
  const chi_exec cancelling = {
    .struct_size = sizeof cancelling, .user = &host, .is_cancelled = chi_test_is_cancelled
  };
  CHECK(chi_transfer_shapes_table(&cancelling, s, 4, size, x_range, y_range, &table[1][0][0][0]) ==
    CHI_ERROR_CANCELLED);
}

static void nonsense_is_refused(void)
{
  static const double polygon[6] = { 0, 0, 1, 0, 0, NAN };
  static const float image[16] = { 0 };
  double rgba[4];
  float table[16];
#define REFUSED(of_kind, change)                                                                   \
  do                                                                                               \
  {                                                                                                \
    chi_transfer_shape s = shape(of_kind, 0.5);                                                    \
    s.polygon = polygon;                                                                           \
    s.polygon_count = 3;                                                                           \
    s.image = image;                                                                               \
    s.image_size[0] = s.image_size[1] = 2;                                                         \
    change;                                                                                        \
    CHECK(chi_transfer_shapes_map(&s, 1, 0, 0, rgba) == CHI_ERROR_INVALID_ARGUMENT);               \
    CHECK(chi_transfer_shapes_table(NULL, &s, 1, (size_t[]){ 2, 2 }, (double[]){ 0, 1 },           \
            (double[]){ 0, 1 }, table) == CHI_ERROR_INVALID_ARGUMENT);                             \
  } while (0)
  REFUSED(5, (void)0);
  REFUSED(-1, (void)0);
  REFUSED(CHI_SHAPE_RECTANGLE, s.struct_size = 8);
  REFUSED(CHI_SHAPE_RECTANGLE, s.rgba[3] = 1.1);
  REFUSED(CHI_SHAPE_RECTANGLE, s.rgba[0] = NAN);
  REFUSED(CHI_SHAPE_RECTANGLE, s.low[0] = 3);
  REFUSED(CHI_SHAPE_RECTANGLE, s.high[1] = INFINITY);
  REFUSED(CHI_SHAPE_RECTANGLE, s.softness = -0.1);
  REFUSED(CHI_SHAPE_TRAPEZOID, s.top[0] = 5);
  REFUSED(CHI_SHAPE_TRAPEZOID, (s.top[0] = s.top[1], s.low[0] = s.high[0]));
  REFUSED(CHI_SHAPE_GAUSSIAN, s.sigma[1] = 0);
  REFUSED(CHI_SHAPE_GAUSSIAN, s.correlation = 1);
  REFUSED(CHI_SHAPE_GAUSSIAN, s.center[0] = NAN);
  REFUSED(CHI_SHAPE_POLYGON, (void)0);
  REFUSED(CHI_SHAPE_POLYGON, s.polygon_count = 2);
  REFUSED(CHI_SHAPE_POLYGON, s.polygon = NULL);
  REFUSED(CHI_SHAPE_IMAGE, s.image = NULL);
  REFUSED(CHI_SHAPE_IMAGE, s.image_size[0] = 1);
  REFUSED(CHI_SHAPE_IMAGE, s.image_size[1] = 1 << 22);
#undef REFUSED
  const chi_transfer_shape s = shape(CHI_SHAPE_GAUSSIAN, 0.5);
  CHECK(chi_transfer_shapes_map(NULL, 1, 0, 0, rgba) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_transfer_shapes_map(&s, 1, 0, 0, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_transfer_shapes_table(NULL, &s, 1, (size_t[]){ 1, 2 }, (double[]){ 0, 1 },
          (double[]){ 0, 1 }, table) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_transfer_shapes_table(NULL, &s, 1, (size_t[]){ 2, 2 }, (double[]){ 1, 1 },
          (double[]){ 0, 1 }, table) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_transfer_shapes_table(NULL, &s, 1, (size_t[]){ 2, 2 }, (double[]){ 0, 1 },
          (double[]){ 0, NAN }, table) == CHI_ERROR_INVALID_ARGUMENT);
}

int main(void)
{
  a_rectangle_is_hard_or_soft();
  a_trapezoid_widens_upwards();
  a_gaussian_has_its_deviations_and_correlation();
  a_polygon_that_crosses_itself_has_a_hole();
  an_image_is_linear_between_its_entries_and_holds_beyond();
  materials_mix_in_any_order();
  tables_have_the_mean_of_hard_shapes_and_the_values_of_soft_ones();
  tables_have_the_same_bits_under_any_schedule();
  nonsense_is_refused();
  return chi_test_report();
}
