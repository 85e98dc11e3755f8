/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Signs of determinants against integers of 128 bits. */

#include "chi_test.h"

#include "math/chi_predicates.h"

typedef __int128 wide;

static wide at(const int64_t p[3], const int64_t q[3], int k)
{
  return (wide)p[k] - q[k];
}

static int sign_of(const int64_t a[3], const int64_t b[3], const int64_t c[3], const int64_t d[3])
{
  wide sum = 0;
  for (int k = 0; k < 3; ++k)
  {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    sum += at(d, a, k) * (at(b, a, l) * at(c, a, m) - at(b, a, m) * at(c, a, l));
  }
  return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

/* Points within a step of a plane whose coordinates have up to 38 bits: determinants of doubles
 * are off by far more than 1, while integers of 128 bits hold them. */
static void signs_near_a_plane_are_exact(void)
{
  uint32_t seed = 7;
  int met[3] = { 0, 0, 0 };
  for (int i = 0; i < 20000; ++i)
  {
    int64_t p[4][3];
    double x[4][3];
    const double size = ldexp(1, 4 + i % 35);
    for (int k = 0; k < 3; ++k)
    {
      for (int j = 0; j < 3; ++j)
      {
        p[j][k] = (int64_t)(size * (chi_test_random(&seed) - 0.5));
      }
      /* in the plane: a + (b - a) m + (c - a) n, then beside it */
      p[3][k] = p[0][k] + (p[1][k] - p[0][k]) * (i % 5 - 2) + (p[2][k] - p[0][k]) * (i % 3 - 1);
    }
    p[3][i % 2] += i % 4 == 0 ? 0 : i % 4 == 1 ? 1 : i % 4 == 2 ? -1 : 1000;
    for (int j = 0; j < 4; ++j)
    {
      for (int k = 0; k < 3; ++k)
      {
        x[j][k] = (double)p[j][k];
      }
    }
    const int expected = sign_of(p[0], p[1], p[2], p[3]);
    ++met[expected + 1];
    CHECK(chi_plane_side(x[0], x[1], x[2], x[3]) == expected);
    CHECK(chi_plane_side(x[1], x[0], x[2], x[3]) == -expected);
  }
  CHECK(met[0] > 1000 && met[1] > 1000 && met[2] > 1000);
}

/* A cloud moved by what rounds its coordinates: the sign is that of the rounded ones, and differs
 * between a point and the same beside it by one unit in the last place. */
static void one_unit_in_the_last_place_counts(void)
{
  const double far = 0x1p40;
  const double a[3] = { far, far, far }, b[3] = { far + 1, far, far }, c[3] = { far, far + 1, far };
  const double on[3] = { far + 0.5, far + 0.25, far };
  const double above[3] = { on[0], on[1], nextafter(far, INFINITY) };
  const double below[3] = { on[0], on[1], nextafter(far, 0) };
  CHECK(chi_plane_side(a, b, c, on) == 0);
  CHECK(chi_plane_side(a, b, c, above) == 1);
  CHECK(chi_plane_side(a, b, c, below) == -1);
}

/* A direction is a point infinitely far away. */
static void directions_have_sides(void)
{
  const double a[3] = { 1e7, 3, 5 }, b[3] = { 1e7 + 0.125, 3, 5 }, c[3] = { 1e7, 3.0625, 5 };
  const double along[3] = { 1, 1, 0 }, up[3] = { 1, 1, 0x1p-60 }, down[3] = { 1, -1, -0x1p-1000 };
  CHECK(chi_plane_side_far(a, b, c, along) == 0);
  CHECK(chi_plane_side_far(a, b, c, up) == 1);
  CHECK(chi_plane_side_far(a, b, c, down) == -1);
}

int main(void)
{
  signs_near_a_plane_are_exact();
  one_unit_in_the_last_place_counts();
  directions_have_sides();
  return chi_test_report();
}
