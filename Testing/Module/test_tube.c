/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#define _POSIX_C_SOURCE 200809L /* setenv */

#include <chiaroscuro/chi_tube.h>

#include "chi_test.h"

static const double pi = 3.14159265358979324;

/* A surface made in one call from `lines` lines of `n` points each. */
typedef struct surface
{
  chi_spline* spline;
  chi_tube* tube;
  chi_tube_sizes sizes;
  double (*points)[3];
  float (*normals)[3];
  float* parameter;
  int64_t *line_ids, *offsets, *connectivity;
  chi_lines_view view;
  int64_t line_offsets[64];
  chi_status status;
} surface;

static chi_tube_params default_params(double radius)
{
  const chi_tube_params p = { .struct_size = sizeof p,
    .radius = radius,
    .sides = 8,
    .cells = CHI_TUBE_TRIANGLES,
    .cap = CHI_TUBE_CAP_FLAT,
    .chord_tolerance = 1e-3 * radius,
    .angular_tolerance_rad = 0.2 };
  return p;
}

static void make(surface* s, const chi_exec* exec, const double (*x)[3], size_t lines, size_t n,
  int32_t method, double tolerance, const chi_tube_params* params)
{
  memset(s, 0, sizeof *s);
  for (size_t i = 0; i <= lines; ++i)
  {
    s->line_offsets[i] = (int64_t)(i * n);
  }
  s->view =
    (chi_lines_view){ { x, lines * n, sizeof x[0], CHI_F64 }, s->line_offsets, NULL, lines };
  const chi_spline_params fit = {
    .struct_size = sizeof fit, .tolerance = tolerance, .method = method
  };
  CHECK(chi_spline_create(exec, &s->spline) == CHI_OK);
  CHECK(chi_tube_create(exec, &s->tube) == CHI_OK);
  CHECK(chi_spline_fit(exec, s->spline, &s->view, &fit) == CHI_OK);
  s->status = chi_tube_plan(exec, s->tube, s->spline, &s->view, params);
  CHECK(s->status == CHI_OK);
  chi_tube_get_sizes(s->tube, &s->sizes);
  s->points = malloc((s->sizes.points + 1) * sizeof *s->points);
  s->normals = malloc((s->sizes.points + 1) * sizeof *s->normals);
  s->parameter = malloc((s->sizes.points + 1) * sizeof *s->parameter);
  s->line_ids = malloc((s->sizes.cells + 1) * sizeof *s->line_ids);
  s->offsets = malloc((s->sizes.cells + 1) * sizeof *s->offsets);
  s->connectivity = malloc((s->sizes.connectivity + 1) * sizeof *s->connectivity);
  const chi_tube_outputs out = { .struct_size = sizeof out,
    .points = s->points,
    .point_type = CHI_F64,
    .normals = (float*)s->normals,
    .parameter = s->parameter,
    .line_ids = s->line_ids,
    .offsets = s->offsets,
    .connectivity = s->connectivity };
  CHECK(chi_tube_sweep(exec, s->tube, &out) == CHI_OK);
}

static void drop(surface* s, const chi_exec* exec)
{
  chi_tube_destroy(exec, s->tube);
  chi_spline_destroy(exec, s->spline);
  free(s->points);
  free(s->normals);
  free(s->parameter);
  free(s->line_ids);
  free(s->offsets);
  free(s->connectivity);
}

/* First vertex with the same position bit for bit. */
static size_t* merged(const surface* s)
{
  size_t* const id = malloc(s->sizes.points * sizeof *id);
  for (size_t i = 0; i < s->sizes.points; ++i)
  {
    id[i] = i;
    for (size_t j = 0; j < i; ++j)
    {
      if (memcmp(s->points[i], s->points[j], sizeof s->points[i]) == 0)
      {
        id[i] = j;
        break;
      }
    }
  }
  return id;
}

/* Each edge of the triangles is used once in either direction; triangles that merging leaves
 * without area (beside the axis of a sharp corner, where its two rings meet) are none. */
static void check_watertight(const surface* s)
{
  size_t* const id = merged(s);
  size_t edges = 0;
  size_t(*edge)[2] = malloc(s->sizes.connectivity * sizeof *edge);
  for (size_t c = 0; c < s->sizes.cells; ++c)
  {
    const int64_t* const v = s->connectivity + 3 * c;
    const size_t corner[3] = { id[v[0]], id[v[1]], id[v[2]] };
    CHECK(s->offsets[c + 1] - s->offsets[c] == 3);
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
    {
      continue;
    }
    for (size_t k = 0; k < 3; ++k)
    {
      edge[edges][0] = corner[k];
      edge[edges++][1] = corner[(k + 1) % 3];
    }
  }
  size_t open = 0;
  for (size_t a = 0; a < edges; ++a)
  {
    int same = 0, opposite = 0;
    for (size_t b = 0; b < edges; ++b)
    {
      same += edge[a][0] == edge[b][0] && edge[a][1] == edge[b][1];
      opposite += edge[a][0] == edge[b][1] && edge[a][1] == edge[b][0];
    }
    open += same != 1 || opposite != 1;
  }
  CHECK(open == 0);
  free(edge);
  free(id);
}

static double area(const surface* s, double* volume)
{
  double sum = 0;
  *volume = 0;
  for (size_t c = 0; c < s->sizes.cells; ++c)
  {
    const double* const p[3] = { s->points[s->connectivity[3 * c]],
      s->points[s->connectivity[3 * c + 1]], s->points[s->connectivity[3 * c + 2]] };
    double u[3], v[3];
    for (int k = 0; k < 3; ++k)
    {
      u[k] = p[1][k] - p[0][k];
      v[k] = p[2][k] - p[0][k];
    }
    const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
      u[0] * v[1] - u[1] * v[0] };
    sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    *volume += (n[0] * p[0][0] + n[1] * p[0][1] + n[2] * p[0][2]) / 6;
  }
  return sum;
}

static void a_straight_line_is_a_prism_of_two_rings(void)
{
  double x[50][3];
  for (int i = 0; i < 50; ++i)
  {
    x[i][0] = x[i][1] = x[i][2] = i / sqrt(3.0);
  }
  for (int32_t sides = 3; sides <= 12; ++sides)
  {
    chi_tube_params p = default_params(2);
    p.sides = sides;
    surface s;
    make(&s, NULL, (const double(*)[3])x, 1, 50, CHI_SPLINE_PROGRESSIVE, 1e-6, &p);
    CHECK(s.sizes.rings == 2);
    double volume;
    const double found = area(&s, &volume), n = sides;
    const double side = 2 * pi * 2 * 49 * (n / pi) * sin(pi / n); /* polygon's perimeter x length */
    const double cap = 0.5 * n * 4 * sin(2 * pi / n);
    CHECK_NEAR(found, side + 2 * cap, 1e-9 * found);
    CHECK_NEAR(volume, cap * 49, 1e-9 * volume); /* positive: faces look outwards */
    check_watertight(&s);
    drop(&s, NULL);
  }
}

static void a_tube_is_watertight_with_any_cap_and_corner(void)
{
  /* a bend, a sharp corner, a near reversal (an exact one would lay two rings on each other) */
  const double x[][3] = { { 0, 0, 0 }, { 3, 0, 0 }, { 3, 3, 0 }, { 4, 0.2, 1 }, { 4, 6, 1 },
    { 4.1, 2, 1 }, { 9, 2, 3 } };
  for (int cap = CHI_TUBE_CAP_FLAT; cap <= CHI_TUBE_CAP_ROUND; ++cap)
  {
    for (int method = CHI_SPLINE_PROGRESSIVE; method <= CHI_SPLINE_POLYLINE; ++method)
    {
      chi_tube_params p = default_params(0.3);
      p.cap = cap;
      surface s;
      make(&s, NULL, x, 1, 7, method, 0.01, &p);
      check_watertight(&s);
      for (size_t i = 0; i < s.sizes.points; ++i)
      {
        const float* const n = s.normals[i];
        CHECK_NEAR(sqrt((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])), 1, 1e-5);
        CHECK(isfinite(s.points[i][0] + s.points[i][1] + s.points[i][2]));
      }
      drop(&s, NULL);
    }
  }
}

static void a_reversal_keeps_its_tube(void)
{
  const double x[][3] = { { 0, 0, 0 }, { 2, 0, 0 }, { 1, 0, 0 }, { 1, 3, 0 } };
  for (int method = CHI_SPLINE_PROGRESSIVE; method <= CHI_SPLINE_POLYLINE; ++method)
  {
    chi_tube_params p = default_params(0.1);
    p.cap = CHI_TUBE_CAP_NONE;
    surface s;
    make(&s, NULL, x, 1, 4, method, 0.01, &p);
    double reach = 0;
    for (size_t i = 0; i < s.sizes.points; ++i)
    {
      CHECK(isfinite(s.points[i][0] + s.points[i][1] + s.points[i][2]));
      CHECK(isfinite(s.normals[i][0] + s.normals[i][1] + s.normals[i][2]));
      reach = fmax(reach, s.points[i][0]);
    }
    CHECK(reach > 1.98); /* the tip is there, to within the tolerance */
    drop(&s, NULL);
  }
}

static void make_helix(double (*x)[3], size_t n, double a, double b, double turns)
{
  for (size_t i = 0; i < n; ++i)
  {
    const double t = 2 * pi * turns * (double)i / (double)(n - 1);
    x[i][0] = a * cos(t);
    x[i][1] = a * sin(t);
    x[i][2] = b * t;
  }
}

static void a_helix_has_its_radius_and_turns_by_its_torsion(void)
{
  enum
  {
    N = 2001
  };
  static double x[N][3];
  const double a = 2, b = 0.7, turns = 1.5, r = 0.25;
  make_helix(x, N, a, b, turns);
  chi_tube_params p = default_params(r);
  p.cap = CHI_TUBE_CAP_NONE;
  p.angular_tolerance_rad = 0.02;
  p.chord_tolerance = 1e-6;
  surface s;
  make(&s, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-7, &p);
  /* Every vertex lies r from the helix: nearest point by Newton from its own angle. */
  double worst = 0;
  for (size_t i = 0; i < s.sizes.points; ++i)
  {
    const double* const q = s.points[i];
    double t = 2 * pi * turns * (double)s.parameter[i];
    for (int k = 0; k < 20; ++k)
    {
      const double f = a * (q[0] * sin(t) - q[1] * cos(t)) + b * (b * t - q[2]);
      const double df = a * (q[0] * cos(t) + q[1] * sin(t)) + b * b;
      t -= f / df;
    }
    const double d =
      sqrt(pow(q[0] - a * cos(t), 2) + pow(q[1] - a * sin(t), 2) + pow(q[2] - b * t, 2));
    worst = fmax(worst, fabs(d - r));
  }
  CHECK(worst < 1.2e-6); /* chords 1e-6, fit 1e-7, the radius is a float */
  /* A rotation-minimising frame turns against Frenet's by -torsion x length. do Carmo 1976, 1-5. */
  const double speed2 = a * a + b * b, torsion = b / speed2;
  double angle[2];
  for (int end = 0; end < 2; ++end)
  {
    const size_t ring = end ? s.sizes.rings - 1 : 0;
    const double t = end ? 2 * pi * turns : 0, root = sqrt(speed2);
    const double normal[3] = { -cos(t), -sin(t), 0 };
    const double binormal[3] = { b * sin(t) / root, -b * cos(t) / root, a / root };
    const double center[3] = { a * cos(t), a * sin(t), b * t };
    double n = 0, bi = 0;
    for (int k = 0; k < 3; ++k)
    {
      n += (s.points[8 * ring][k] - center[k]) * normal[k];
      bi += (s.points[8 * ring][k] - center[k]) * binormal[k];
    }
    angle[end] = atan2(bi, n);
  }
  const double expected = -torsion * 2 * pi * turns * sqrt(speed2);
  const double turned = remainder(angle[1] - angle[0] - expected, 2 * pi);
  /* double reflection is of fourth order: (0.02 rad)^4 a ring, 600 rings: 1e-4 */
  CHECK_NEAR(turned, 0, 1e-4);
  drop(&s, NULL);
}

static void chords_of_an_arc_err_as_much_to_both_sides(void)
{
  enum
  {
    N = 801
  };
  static double x[N][3];
  make_helix(x, N, 1, 0, 0.75);
  chi_tube_params p = default_params(0.01);
  p.cap = CHI_TUBE_CAP_NONE;
  p.angular_tolerance_rad = 1.5;
  p.chord_tolerance = 1e-3;
  const double fit = 1e-5;
  surface s;
  make(&s, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, fit, &p);
  double last[3] = { 0, 0, 0 }, outside = 0, inside = 0;
  for (size_t k = 0; k < s.sizes.rings; ++k)
  {
    double c[3] = { 0, 0, 0 };
    for (size_t j = 0; j < 8; ++j)
    {
      for (int a = 0; a < 3; ++a)
      {
        c[a] += s.points[8 * k + j][a] / 8;
      }
    }
    outside = fmax(outside, hypot(c[0], c[1]) - 1);
    if (k > 0)
    {
      inside = fmax(inside, 1 - hypot(c[0] + last[0], c[1] + last[1]) / 2);
    }
    memcpy(last, c, sizeof last);
  }
  CHECK(outside <= p.chord_tolerance + fit && outside > 0.8 * p.chord_tolerance);
  CHECK(inside <= p.chord_tolerance + fit && inside > 0.8 * p.chord_tolerance);
  /* The longest chord that errs by e to both sides is 4 sqrt(e); its ends are found to 1/16, and
   * the line's own, which stay on the curve, cost half a step each. */
  CHECK((double)s.sizes.rings < 1.0625 * 1.5 * pi / (4 * sqrt(p.chord_tolerance)) + 3);
  drop(&s, NULL);
}

static void a_torus_knot_closes_without_a_seam(void)
{
  enum
  {
    N = 301
  };
  static double x[N][3];
  for (int i = 0; i < N; ++i)
  {
    const double t = 2 * pi * (i % (N - 1)) / (N - 1);
    x[i][0] = (2 + cos(3 * t)) * cos(2 * t);
    x[i][1] = (2 + cos(3 * t)) * sin(2 * t);
    x[i][2] = sin(3 * t);
  }
  for (int frame = CHI_TUBE_ROTATION_MINIMISING; frame <= CHI_TUBE_FRENET; ++frame)
  {
    chi_tube_params p = default_params(0.1);
    p.frame = frame;
    p.chord_tolerance = 2e-3;
    surface s;
    make(&s, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-3, &p);
    CHECK(s.sizes.points == 8 * (s.sizes.rings - 1)); /* no cap, no double ring */
    check_watertight(&s);
    /* Between neighbouring rings a vertex moves along, not around: by less than a quarter of the
     * ring's side. The knot's whole defect is spread over some 100 rings. */
    const size_t rings = s.sizes.rings - 1;
    double worst = 0, least = 1;
    for (size_t k = 0; k < rings; ++k)
    {
      double center[2][3] = { { 0 } }, around = 0, along = 0;
      for (int j = 0; j < 8; ++j)
      {
        for (int c = 0; c < 3; ++c)
        {
          center[0][c] += s.points[8 * k + j][c] / 8;
          center[1][c] += s.points[8 * ((k + 1) % rings) + j][c] / 8;
        }
      }
      for (int c = 0; c < 3; ++c)
      {
        const double from = s.points[8 * k][c] - center[0][c];
        const double to = s.points[8 * ((k + 1) % rings)][c] - center[1][c];
        around += (to - from) * (to - from);
        along += to * from / (0.1 * 0.1);
      }
      worst = fmax(worst, sqrt(around));
      least = fmin(least, along);
    }
    if (frame == CHI_TUBE_ROTATION_MINIMISING)
    {
      CHECK(worst < 0.25 * 0.1 * 2 * sin(pi / 8) + 0.2 * 0.1); /* plus the tilt of 0.2 rad a ring */
    }
    else
    {
      CHECK(least > 0.5); /* Frenet's frame turns, by the torsion, but never flips */
    }
    drop(&s, NULL);
  }
}

static void place_and_scale_do_not_matter(void)
{
  enum
  {
    N = 60
  };
  static double x[N][3], y[N][3];
  make_helix(x, N, 2, 0.5, 1);
  chi_tube_params p = default_params(0.2);
  surface s, t;
  make(&s, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-4, &p);
  for (int k = 0; k < 4; ++k)
  {
    const double scale = k == 0 ? 1e-6 : k == 1 ? 1e6 : 1, shift = k == 2 ? 1e8 : 0;
    for (int i = 0; i < N; ++i)
    {
      for (int c = 0; c < 3; ++c)
      {
        y[i][c] = scale * x[i][k == 3 ? (c + 1) % 3 : c] + shift;
      }
    }
    chi_tube_params q = p;
    q.radius *= scale;
    q.chord_tolerance *= scale;
    make(&t, NULL, (const double(*)[3])y, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-4 * scale, &q);
    CHECK(t.sizes.points == s.sizes.points && t.sizes.cells == s.sizes.cells);
    CHECK(memcmp(t.connectivity, s.connectivity, s.sizes.connectivity * sizeof(int64_t)) == 0);
    /* Up to a rotation of the polygon: centres of the rings agree, and every vertex lies on the
     * other tube, r from its axis. */
    const double bound = (k == 2 ? 1e-7 : 1e-9) * scale * 5;
    for (size_t ring = 0; ring < s.sizes.rings && t.sizes.points == s.sizes.points; ++ring)
    {
      double center[2][3] = { { 0 } };
      for (int j = 0; j < 8; ++j)
      {
        for (int c = 0; c < 3; ++c)
        {
          center[0][c] += s.points[8 * ring + (size_t)j][k == 3 ? (c + 1) % 3 : c] / 8;
          center[1][c] += (t.points[8 * ring + (size_t)j][c] - shift) / 8;
        }
      }
      for (int c = 0; c < 3; ++c)
      {
        CHECK_NEAR(center[1][c], scale * center[0][c], bound);
      }
    }
    drop(&t, NULL);
  }
  drop(&s, NULL);
}

static void radii_follow_the_arrays_and_the_curvature(void)
{
  enum
  {
    N = 40
  };
  double x[2 * N][3], factor[2 * N], of_line[2] = { 1, 3 };
  for (int i = 0; i < N; ++i)
  {
    const double t = 0.5 * pi * i / (N - 1);
    x[i][0] = 0.1 * cos(t); /* a bend of radius 0.1 */
    x[i][1] = 0.1 * sin(t);
    x[i][2] = 0;
    x[N + i][0] = i;
    x[N + i][1] = x[N + i][2] = 5;
    factor[i] = 1;
    factor[N + i] = 1 + 0.1 * i;
  }
  const chi_array_view point = { factor, 2 * N, 1, sizeof(double), CHI_F64 };
  const chi_array_view line = { of_line, 2, 1, sizeof(double), CHI_F64 };
  chi_tube_params p = default_params(0.5);
  p.cap = CHI_TUBE_CAP_NONE;
  p.point_radius = &point;
  p.line_radius = &line;
  p.limit_radius = 1;
  surface s;
  make(&s, NULL, (const double(*)[3])x, 2, N, CHI_SPLINE_PROGRESSIVE, 1e-5, &p);
  CHECK(s.sizes.clamped_radii > 0);
  chi_spline_curve bend;
  chi_spline_get_curve(s.spline, 0, &bend);
  for (size_t i = 0; i < s.sizes.points; ++i)
  {
    if (s.points[i][0] > 0.5 || s.points[i][1] > 1) /* the straight line */
    {
      const double r = hypot(s.points[i][1] - 5, s.points[i][2] - 5);
      CHECK_NEAR(r, 0.5 * 3 * (1 + 0.1 * s.points[i][0]), 1e-5);
      continue;
    }
    double c[3][3];
    chi_spline_evaluate(&bend, (double)s.parameter[i], 2, c);
    const double cross = fabs(c[1][0] * c[2][1] - c[1][1] * c[2][0]);
    const double limit = pow(hypot(c[1][0], c[1][1]), 3) / cross;
    double square = 0;
    for (int k = 0; k < 3; ++k)
    {
      square += pow(s.points[i][k] - c[0][k] - bend.origin[k], 2);
    }
    /* the parameter is a float: 6e-8 of the knots' spacing; the ring lies outside of the bend */
    CHECK(sqrt(square) < limit * (1 + 1e-4) + p.chord_tolerance);
  }
  p.limit_radius = 0;
  surface t;
  make(&t, NULL, (const double(*)[3])x, 2, N, CHI_SPLINE_PROGRESSIVE, 1e-5, &p);
  CHECK(t.sizes.clamped_radii == 0);
  drop(&t, NULL);
  drop(&s, NULL);
}

static void arrays_hold_rings_and_never_overshoot(void)
{
  enum
  {
    N = 100
  };
  double x[N][3], speed[N];
  int32_t id[N];
  for (int i = 0; i < N; ++i)
  {
    x[i][0] = i;
    x[i][1] = x[i][2] = 0;
    speed[i] = i < 50 ? 1 : 2; /* a step */
    id[i] = 1000 + i;
  }
  const chi_array_view view = { speed, N, 1, sizeof(double), CHI_F64 };
  const chi_array_view ids = { id, N, 1, sizeof(int32_t), CHI_I32 };
  const chi_array_view* const arrays[1] = { &view };
  chi_tube_params p = default_params(1);
  p.attributes = arrays;
  p.attribute_count = 1;
  p.attribute_tolerance = 1e-3;
  surface s;
  make(&s, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-6, &p);
  CHECK(s.sizes.rings == 4 && s.sizes.removed_rings == N - 4); /* the step's two ends stay */
  double* const out = malloc(s.sizes.points * sizeof *out);
  int32_t* const out_id = malloc(s.sizes.points * sizeof *out_id);
  CHECK(chi_tube_attribute(NULL, s.tube, CHI_TUBE_SURFACE, &view, out, sizeof *out) == CHI_OK);
  CHECK(chi_tube_attribute(NULL, s.tube, CHI_TUBE_SURFACE, &ids, out_id, sizeof *out_id) == CHI_OK);
  for (size_t i = 0; i < s.sizes.points; ++i)
  {
    CHECK(out[i] >= 1 && out[i] <= 2);
    CHECK(out[i] == (s.points[i][0] < 49.5 ? 1 : 2));
    CHECK(out_id[i] == 1000 + (int)lround(s.points[i][0]));
  }
  free(out);
  free(out_id);
  p.attribute_tolerance = 0;
  surface t;
  make(&t, NULL, (const double(*)[3])x, 1, N, CHI_SPLINE_PROGRESSIVE, 1e-6, &p);
  CHECK(t.sizes.rings == 2);
  drop(&t, NULL);
  drop(&s, NULL);
}

static void lines_outside_or_short_are_counted(void)
{
  const double x[][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 10, 0, 0 }, { 20, 0, 0 }, { 0, 0, 0 },
    { 0.01, 0, 0 } };
  const double box[6] = { -1, 2, -1, 1, -1, 1 };
  chi_tube_params p = default_params(0.1);
  p.clip_box = box;
  p.min_length = 0.1;
  surface s;
  make(&s, NULL, x, 3, 2, CHI_SPLINE_PROGRESSIVE, 1e-6, &p);
  CHECK(s.sizes.curves == 1 && s.sizes.outside_lines == 1 && s.sizes.short_lines == 1);
  drop(&s, NULL);
}

static void schedules_agree_and_refusals_are_reported(void)
{
  enum
  {
    LINES = 40,
    N = 30
  };
  static double x[LINES * N][3], kept[LINES * N][3];
  uint32_t seed = 9;
  for (int i = 0; i < LINES * N; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      x[i][c] = (c == 0) * (i % N) + chi_test_random(&seed);
    }
  }
  memcpy(kept, x, sizeof x);
  chi_tube_params p = default_params(0.1);
  p.cap = CHI_TUBE_CAP_ROUND;
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  surface s, t;
  make(&s, NULL, (const double(*)[3])x, LINES, N, CHI_SPLINE_PROGRESSIVE, 0.05, &p);
  make(&t, &backwards, (const double(*)[3])x, LINES, N, CHI_SPLINE_PROGRESSIVE, 0.05, &p);
  CHECK(s.sizes.points == t.sizes.points);
  CHECK(memcmp(s.points, t.points, s.sizes.points * sizeof *s.points) == 0);
  CHECK(memcmp(s.normals, t.normals, s.sizes.points * sizeof *s.normals) == 0);
  CHECK(memcmp(s.connectivity, t.connectivity, s.sizes.connectivity * sizeof(int64_t)) == 0);
  CHECK(memcmp(x, kept, sizeof x) == 0); /* the input is as it was */
  for (long at = 0; at < 24; ++at)
  {
    chi_test_host host = { .refuse_at = at, .cancel_at = 1 << 30 };
    chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    chi_tube* tube = NULL;
    chi_status status = chi_tube_create(&exec, &tube);
    if (tube)
    {
      status = chi_tube_plan(&exec, tube, s.spline, &s.view, &p);
      CHECK(status == (host.allocations > at ? CHI_ERROR_OUT_OF_MEMORY : CHI_OK));
    }
    else
    {
      CHECK(status == CHI_ERROR_OUT_OF_MEMORY);
    }
    chi_tube_destroy(&exec, tube);
    CHECK(host.live == 0);
    host = (chi_test_host){ .refuse_at = -1, .cancel_at = at };
    exec.is_cancelled = chi_test_is_cancelled;
    CHECK(chi_tube_create(&exec, &tube) == CHI_OK);
    CHECK(chi_tube_plan(&exec, tube, s.spline, &s.view, &p) == CHI_ERROR_CANCELLED);
    chi_tube_destroy(&exec, tube);
    CHECK(host.live == 0);
  }
  drop(&s, NULL);
  drop(&t, &backwards);
}

/* Blocks of rings end anywhere in a line, points are float or double, and processors differ; the
 * surface does not. */
static void instruction_sets_agree_and_floats_are_rounded_doubles(void)
{
  enum
  {
    N = 131,
    SIDES = 11
  };
  static double x[N][3];
  static float points[3][3 * N * SIDES], normals[3][3 * N * SIDES];
  static double precise[3 * N * SIDES];
  const char* const sets[3] = { "generic", "avx2", "avx512" };
  uint32_t seed = 5;
  chi_tube_params p = default_params(0.2);
  p.keep_rings = 1;
  p.sides = SIDES;
  p.cap = CHI_TUBE_CAP_NONE;
  for (size_t n = 2; n <= N; n += n < 28 ? 26 : n < 36 || (n > 60 && n < 68) ? 1 : 5)
  {
    double largest = 0;
    for (size_t i = 0; i < n; ++i)
    {
      for (size_t c = 0; c < 3; ++c)
      {
        x[i][c] = (c == 0) * (double)i + 0.4 * chi_test_random(&seed); /* no corner is sharp */
        largest = fmax(largest, fabs(x[i][c]));
      }
    }
    surface s;
    make(&s, NULL, (const double(*)[3])x, 1, n, CHI_SPLINE_POLYLINE, 0, &p);
    CHECK(s.status == CHI_OK && s.sizes.points == n * SIDES);
    for (int k = 0; k < 3; ++k)
    {
      const chi_tube_outputs out = {
        .struct_size = sizeof out, .points = points[k], .point_type = CHI_F32, .normals = normals[k]
      };
      CHECK(setenv("CHIAROSCURO_ISA", sets[k], 1) == 0);
      CHECK(chi_tube_sweep(NULL, s.tube, &out) == CHI_OK);
      unsetenv("CHIAROSCURO_ISA");
      CHECK(memcmp(points[k], points[0], 3 * n * SIDES * sizeof(float)) == 0);
      CHECK(memcmp(normals[k], normals[0], 3 * n * SIDES * sizeof(float)) == 0);
    }
    const chi_tube_outputs out = {
      .struct_size = sizeof out, .points = precise, .point_type = CHI_F64
    };
    CHECK(chi_tube_sweep(NULL, s.tube, &out) == CHI_OK);
    for (size_t i = 0; i < 3 * n * SIDES; ++i)
    {
      /* the center, both axes, both factors, two products and two sums are rounded: 9 halves of
       * 2^-23 of what is largest */
      CHECK(fabs((double)points[0][i] - precise[i]) <= 4.5 / 8388608 * (largest + 1));
    }
    drop(&s, NULL);
  }
}

static void bad_arguments_are_named(void)
{
  chi_tube* t = NULL;
  const chi_tube_outputs none = { .struct_size = sizeof none };
  CHECK(chi_tube_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_tube_create(NULL, &t) == CHI_OK);
  CHECK(chi_tube_sweep(NULL, t, &none) == CHI_ERROR_NOT_READY);
  const chi_tube_params p = default_params(1);
  CHECK(chi_tube_plan(NULL, t, NULL, NULL, &p) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tube_destroy(NULL, t);
  chi_tube_destroy(NULL, NULL);
  const double x[2][3] = { { 0, 0, 0 }, { 1, 0, 0 } };
  const double negative[2] = { 1, -1 };
  const chi_array_view radius = { negative, 2, 1, sizeof(double), CHI_F64 };
  surface s;
  make(&s, NULL, x, 1, 2, CHI_SPLINE_POLYLINE, 0, &p);
  chi_tube_params bad = p;
  bad.point_radius = &radius;
  CHECK(chi_tube_plan(NULL, s.tube, s.spline, &s.view, &bad) == CHI_ERROR_INVALID_ARGUMENT);
  bad = p;
  bad.radius = 0;
  CHECK(chi_tube_plan(NULL, s.tube, s.spline, &s.view, &bad) == CHI_ERROR_INVALID_ARGUMENT);
  drop(&s, NULL);
}

int main(void)
{
  a_straight_line_is_a_prism_of_two_rings();
  a_tube_is_watertight_with_any_cap_and_corner();
  a_reversal_keeps_its_tube();
  a_helix_has_its_radius_and_turns_by_its_torsion();
  chords_of_an_arc_err_as_much_to_both_sides();
  a_torus_knot_closes_without_a_seam();
  place_and_scale_do_not_matter();
  radii_follow_the_arrays_and_the_curvature();
  arrays_hold_rings_and_never_overshoot();
  lines_outside_or_short_are_counted();
  schedules_agree_and_refusals_are_reported();
  instruction_sets_agree_and_floats_are_rounded_doubles();
  bad_arguments_are_named();
  return chi_test_report();
}
