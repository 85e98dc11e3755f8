/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fiber surfaces whose shape, area or closedness is known. */

#include "fiber_surface.h"

static const double pi = 3.14159265358979323846;

/* A cube [low, high]^3 of n^3 cells as an image. */
static chi_grid_view cube_of(size_t n, double low, double high)
{
  const double h = (high - low) / (double)n;
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { n + 1, n + 1, n + 1 },
    .index_to_world = { h, 0, 0, low, 0, h, 0, low, 0, 0, h, low, 0, 0, 0, 1 } };
}

static void x_and_y(const double x[3], double value[2])
{
  value[0] = x[0];
  value[1] = x[1];
}

static void ring(const double x[3], double value[2])
{
  value[0] = sqrt(x[0] * x[0] + x[1] * x[1]);
  value[1] = x[2];
}

static void waves(const double x[3], double value[2])
{
  value[0] = sin(3 * x[0] + x[1]) + 0.5 * cos(4 * x[2]);
  value[1] = cos(2 * x[1] - x[2]) + 0.5 * sin(5 * x[0]);
}

/* Of small whole numbers, so that many lie on lines and corners of a polygon of whole numbers. */
static void steps(const double x[3], double value[2])
{
  value[0] = round(3 * x[0] + 0.3 * x[1]);
  value[1] = round(3 * x[1] - 0.4 * x[2] * x[2]);
}

static void an_edge_of_the_polygon_is_a_planar_strip(void)
{
  const chi_grid_view grid = cube_of(5, 0, 1);
  fields f = make_fields(&grid, x_and_y);
  const double points[3][2] = { { 0.17, 0.23 }, { 0.61, 0.87 }, { 0.9, 0.4 } };
  lines l = make_line(3, points);
  const chi_fiber_params params = params_of(&f, &l);
  surface s = surface_of(&grid, &params);
  check_surface(&s, 125);
  CHECK(s.sizes.segments == 2);
  double area[2] = { 0, 0 };
  for (size_t t = 0; t < s.sizes.triangles; ++t)
  {
    double n[3];
    area_vector(&s, t, n);
    area[s.segments[t]] += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  /* the depth is 1; rounding of coordinates of size 1 and sums of some 200 triangles */
  CHECK_NEAR(area[0], hypot(0.44, 0.64), 1e-13);
  CHECK_NEAR(area[1], hypot(0.29, 0.47), 1e-13);
  double off = 0, turned = 0, parameter = 0;
  const double *const p = points[0], *const q = points[1];
  const double d[2] = { q[0] - p[0], q[1] - p[1] }, length = hypot(d[0], d[1]);
  for (size_t i = 0; i < 3 * s.sizes.triangles; ++i)
  {
    const int64_t id = s.triangles[i / 3][i % 3];
    const double e[2] = { s.points[id][0] - p[0], s.points[id][1] - p[1] };
    const double t = (d[0] * e[0] + d[1] * e[1]) / (length * length);
    if (s.segments[i / 3] == 0 && t < 0.99) /* its inside is on its left; the corner is shared */
    {
      off = fmax(off, fabs(d[0] * e[1] - d[1] * e[0]));
      turned = fmax(turned, fabs(s.normals[id][0] - d[1] / length));
      parameter = fmax(parameter, fabs(t - s.parameter[id]));
    }
  }
  CHECK(off < 1e-15);
  CHECK(turned < 1e-7 && parameter < 1e-7); /* of float */
  drop_surface(&s);
  drop_lines(&l);
  free(f.values);
}

static surface torus(size_t n, size_t sides)
{
  const chi_grid_view grid = cube_of(n, -1, 1);
  fields f = make_fields(&grid, ring);
  lines l = make_circle(0.55, 0.05, 0.3, sides, 0);
  const chi_fiber_params params = params_of(&f, &l);
  surface s = surface_of(&grid, &params);
  check_surface(&s, n * n * n);
  drop_lines(&l);
  free(f.values);
  return s;
}

static void a_circle_is_a_torus_of_second_order(void)
{
  double errors[3];
  for (int k = 0; k < 3; ++k)
  {
    const size_t n = (size_t)12 << k;
    surface s = torus(n, (size_t)24 << k); /* the circle's own chords are of second order too */
    errors[k] = fabs(area_of(&s) - 4 * pi * pi * 0.55 * 0.3);
    const edge_counts edges = count_edges(&s);
    CHECK(edges.open == 0 && edges.crowded == 0);
    /* 2 pi^2 R r^2, to as much as the area */
    CHECK_NEAR(enclosed_by(&s), 2 * pi * pi * 0.55 * 0.09, k == 0 ? 0.05 : 0.02);
    double turned = 0;
    for (size_t i = 0; i < s.sizes.points; ++i)
    {
      const double* const x = s.points[i];
      const double r = hypot(x[0], x[1]), u = r - 0.55, v = x[2] - 0.05, length = hypot(u, v);
      const float* const n_i = s.normals[i];
      turned +=
        n_i[0] * u / length * x[0] / r + n_i[1] * u / length * x[1] / r + n_i[2] * v / length;
    }
    CHECK(turned > 0.99 * (double)s.sizes.points); /* outwards, within 8 degrees in the mean */
    drop_surface(&s);
  }
  /* 4 in the limit */
  CHECK(errors[0] / errors[1] > 3 && errors[1] / errors[2] > 3);
}

/* A closed line well within the fields' range on a domain's inside gives a closed surface. */
static void check_closed(const chi_grid_view* grid, size_t cells, field_fn fn, const lines* l)
{
  fields f = make_fields(grid, fn);
  chi_fiber_params params = params_of(&f, l);
  surface s = surface_of(grid, &params);
  check_surface(&s, cells);
  CHECK(s.sizes.triangles > 0);
  CHECK(count_edges(&s).open == 0);
  CHECK(enclosed_by(&s) > 0);
  params.split_corners = 1;
  surface apart = surface_of(grid, &params);
  check_surface(&apart, cells);
  CHECK(apart.sizes.points > s.sizes.points);
  /* the same triangles; sums in the same order */
  CHECK_NEAR(area_of(&apart), area_of(&s), 1e-12 * area_of(&s));
  drop_surface(&apart);
  drop_surface(&s);
  free(f.values);
}

/* Falls off towards the walls of [-1, 1]^3, so that what lies inside stays inside. */
static void hill(const double x[3], double value[2])
{
  const double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  value[0] = 1.4 - r2;
  value[1] = 0.4 * sin(4 * x[0]) + 0.3 * x[2];
}

/* Likewise in whole numbers. */
static void stepped_hill(const double x[3], double value[2])
{
  double smooth[2];
  hill(x, smooth);
  value[0] = round(4 * smooth[0]);
  value[1] = round(6 * smooth[1]);
}

static void closed_polygons_give_closed_surfaces(void)
{
  const chi_grid_view grid = cube_of(11, -1, 1);
  mesh* const m = make_mixed(7, 0.25, 5);
  for (size_t i = 0; i < m->points; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      m->x[i][a] = m->x[i][a] / 3.5 - 1;
    }
  }
  chi_grid_view mixed = view_of(m);
  const double polygons[3][6][2] = { { { 0.8, -0.3 }, { 1.3, -0.2 }, { 1.2, 0.3 }, { 0.9, 0.25 },
                                       { 0.85, 0 }, { 0.8, -0.3 } },
    /* crosses itself, more of it counterclockwise */
    { { 0.7, -0.4 }, { 1.3, 0.3 }, { 0.9, 0.5 }, { 1.2, -0.3 }, { 0.7, -0.3 }, { 0.7, -0.4 } },
    /* runs back on itself */
    { { 0.7, -0.3 }, { 1.3, -0.3 }, { 1.3, 0.3 }, { 1.3, -0.1 }, { 0.7, 0.3 }, { 0.7, -0.3 } } };
  const double whole[3][6][2] = { { { 3, -2 }, { 5, -2 }, { 5, 2 }, { 3, 2 }, { 3, 0 }, { 3, -2 } },
    { { 3, -2 }, { 5, 0 }, { 4, 2 }, { 4, 1 }, { 3, 1 }, { 3, -2 } },
    { { 3, -1 }, { 5, -1 }, { 5, 1 }, { 4, 0 }, { 3, 1 }, { 3, -1 } } };
  for (int k = 0; k < 3; ++k)
  {
    lines l = make_line(6, polygons[k]);
    check_closed(&grid, 1331, hill, &l);
    check_closed(&mixed, m->cells, hill, &l);
    drop_lines(&l);
    l = make_line(6, whole[k]);
    check_closed(&grid, 1331, stepped_hill, &l);
    check_closed(&mixed, m->cells, stepped_hill, &l);
    drop_lines(&l);
  }
  drop_view(&mixed);
  free(m);
}

/* Random whole numbers at every point: lines and corners of the polygon are hit all the time, cells
 * are flat in the fields' plane. What is not at the domain's wall must close. */
static void ties_never_open_a_surface(void)
{
  const chi_grid_view grid = cube_of(6, 0, 6);
  fields f = make_fields(&grid, steps);
  uint32_t seed = 3;
  for (int round_ = 0; round_ < 40; ++round_)
  {
    for (size_t i = 0; i < f.points; ++i)
    {
      const size_t at[3] = { i % 7, i / 7 % 7, i / 49 };
      const int inner = at[0] % 6 && at[1] % 6 && at[2] % 6;
      f.values[2 * i] = inner ? floor(5 * chi_test_random(&seed)) : 9;
      f.values[2 * i + 1] = inner ? floor(5 * chi_test_random(&seed)) : 9;
    }
    double p[6][2];
    for (int k = 0; k < 5; ++k)
    {
      p[k][0] = floor(5 * chi_test_random(&seed));
      p[k][1] = floor(5 * chi_test_random(&seed));
    }
    memcpy(p[5], p[0], sizeof p[0]);
    lines l = make_line(6, (const double(*)[2])p);
    const chi_fiber_params params = params_of(&f, &l);
    surface s = surface_of(&grid, &params);
    check_surface(&s, 216);
    CHECK(count_edges(&s).open == 0);
    drop_surface(&s);
    drop_lines(&l);
  }
  free(f.values);
}

static void a_turned_polygon_gives_the_same_sides(void)
{
  const chi_grid_view grid = cube_of(9, -1, 1);
  fields f = make_fields(&grid, ring);
  for (int clockwise = 0; clockwise < 2; ++clockwise)
  {
    lines l = make_circle(0.55, 0.05, 0.3, 9, clockwise);
    const chi_fiber_params params = params_of(&f, &l);
    surface s = surface_of(&grid, &params);
    CHECK(enclosed_by(&s) > 0);
    CHECK(count_edges(&s).open == 0);
    drop_surface(&s);
    drop_lines(&l);
  }
  free(f.values);
}

/* Against each tetrahedron's own part, cut in the plain way. */
static double plain_area(const split* s, const double* values, const double p[2], const double q[2])
{
  double sum = 0;
  const double d[2] = { q[0] - p[0], q[1] - p[1] }, square = d[0] * d[0] + d[1] * d[1];
  for (size_t t = 0; t < s->counts.tetrahedra; ++t)
  {
    double h[4], at[4], poly[8][4];
    int n = 0, left[4], lefts = 0, rights = 0;
    for (int k = 0; k < 4; ++k)
    {
      const double* const v = values + 2 * s->vertices[t][k];
      h[k] = d[0] * (v[1] - p[1]) - d[1] * (v[0] - p[0]);
      at[k] = (d[0] * (v[0] - p[0]) + d[1] * (v[1] - p[1])) / square;
      lefts += h[k] > 0;
      rights += !(h[k] > 0);
    }
    lefts = rights = 0;
    int right[4];
    for (int k = 0; k < 4; ++k)
    {
      if (h[k] > 0)
      {
        left[lefts++] = k;
      }
      else
      {
        right[rights++] = k;
      }
    }
    for (int i = 0; i < lefts; ++i)
    {
      for (int j = 0; j < rights; ++j)
      {
        /* around: the second left one takes the right ones backwards */
        const int a = left[i], b = right[i & 1 ? rights - 1 - j : j];
        const double w = h[a] / (h[a] - h[b]);
        const double *const x = s->points[s->vertices[t][a]],
                            *const y = s->points[s->vertices[t][b]];
        for (int c = 0; c < 3; ++c)
        {
          poly[n][c] = x[c] + w * (y[c] - x[c]);
        }
        poly[n++][3] = at[a] + w * (at[b] - at[a]);
      }
    }
    for (int end = 0; end < 2; ++end)
    {
      double next[8][4];
      int m = 0;
      for (int k = 0; k < n; ++k)
      {
        const double *const x = poly[k], *const y = poly[(k + 1) % n];
        const double from = end ? 1 - x[3] : x[3], to = end ? 1 - y[3] : y[3];
        if (from >= 0)
        {
          memcpy(next[m++], x, sizeof next[0]);
        }
        if ((from < 0) != (to < 0))
        {
          for (int c = 0; c < 4; ++c)
          {
            next[m][c] = x[c] + from / (from - to) * (y[c] - x[c]);
          }
          ++m;
        }
      }
      memcpy(poly, next, sizeof poly);
      n = m;
    }
    double area[3] = { 0, 0, 0 };
    for (int k = 2; k < n; ++k)
    {
      double u[3], v[3];
      for (int c = 0; c < 3; ++c)
      {
        u[c] = poly[k - 1][c] - poly[0][c];
        v[c] = poly[k][c] - poly[0][c];
      }
      area[0] += u[1] * v[2] - u[2] * v[1];
      area[1] += u[2] * v[0] - u[0] * v[2];
      area[2] += u[0] * v[1] - u[1] * v[0];
    }
    sum += 0.5 * sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
  }
  return sum;
}

static void every_tetrahedron_gives_its_part(void)
{
  mesh* const m = make_mixed(5, 0.3, 17);
  chi_grid_view grid = view_of(m);
  fields f = make_fields(&grid, waves);
  split whole;
  CHECK(make_split(&whole, NULL, &grid) == CHI_OK);
  CHECK(whole.counts.extra_points > 0); /* centres of cells, which have the mean of its values */
  double* const values = must_alloc((f.points + whole.counts.extra_points) * 2 * sizeof *values);
  memcpy(values, f.values, f.points * 2 * sizeof *values);
  for (size_t i = 0; i < whole.counts.extra_points; ++i)
  {
    const int64_t first = m->offsets[whole.extra_cells[i]];
    const int64_t count = m->offsets[whole.extra_cells[i] + 1] - first;
    for (size_t c = 0; c < 2; ++c)
    {
      double sum = 0;
      for (int64_t k = first; k < first + count; ++k)
      {
        sum += f.values[2 * (size_t)m->ids[k] + c];
      }
      values[2 * (f.points + i) + c] = sum / (double)count;
    }
  }
  uint32_t seed = 9;
  double(*const p)[2] = must_alloc(31 * sizeof *p);
  for (int k = 0; k < 31; ++k)
  {
    p[k][0] = 3 * chi_test_random(&seed) - 1.5;
    p[k][1] = 3 * chi_test_random(&seed) - 1.5;
  }
  lines l = make_line(31, (const double(*)[2])p); /* three batches of segments */
  const chi_fiber_params params = params_of(&f, &l);
  surface s = surface_of(&grid, &params);
  check_surface(&s, m->cells);
  for (int k = 0; k < 30; ++k)
  {
    double area = 0;
    for (size_t t = 0; t < s.sizes.triangles; ++t)
    {
      double n[3];
      area_vector(&s, t, n);
      area += s.segments[t] == k ? sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) : 0;
    }
    const double plain = plain_area(&whole, values, p[k], p[k + 1]);
    CHECK_NEAR(area, plain, 1e-10 * (1 + plain)); /* slivers of ill-conditioned sections */
  }
  free(p);
  free(values);
  drop_surface(&s);
  drop_split(&whole);
  drop_lines(&l);
  free(f.values);
  drop_view(&grid);
  free(m);
}

static void connected_parts_are_found_and_small_ones_left_out(void)
{
  const chi_grid_view grid = cube_of(16, -1, 1);
  fields f = make_fields(&grid, waves);
  lines l = make_circle(0.3, 0.2, 0.35, 8, 0);
  chi_fiber_params params = params_of(&f, &l);
  params.find_components = 1;
  surface s = surface_of(&grid, &params);
  CHECK(s.sizes.components > 2);
  double* const area = must_alloc(s.sizes.components * sizeof *area);
  memset(area, 0, s.sizes.components * sizeof *area);
  int64_t seen = -1;
  size_t apart = 0;
  int64_t* const of_point = must_alloc(s.sizes.points * sizeof *of_point);
  memset(of_point, 0xff, s.sizes.points * sizeof *of_point);
  for (size_t t = 0; t < s.sizes.triangles; ++t)
  {
    double n[3];
    area_vector(&s, t, n);
    area[s.components[t]] += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    apart += s.components[t] > seen + 1;
    seen = s.components[t] > seen ? s.components[t] : seen;
    for (int k = 0; k < 3; ++k)
    {
      int64_t* const of = of_point + s.triangles[t][k];
      apart += *of >= 0 && *of != s.components[t];
      *of = s.components[t];
    }
  }
  CHECK(apart == 0 && seen + 1 == (int64_t)s.sizes.components);
  double least = INFINITY, sum = 0;
  for (size_t k = 0; k < s.sizes.components; ++k)
  {
    least = fmin(least, area[k]);
    sum += area[k];
  }
  params.minimum_area = least * (1 + 1e-9);
  surface fewer = surface_of(&grid, &params);
  check_surface(&fewer, 4096);
  CHECK(fewer.sizes.left_out == 1 && fewer.sizes.components == s.sizes.components - 1);
  CHECK_NEAR(area_of(&fewer), sum - least, 1e-12 * sum); /* sums in another order */
  params.minimum_area = 1e9;
  surface none = surface_of(&grid, &params);
  CHECK(none.sizes.triangles == 0 && none.sizes.points == 0 && none.sizes.components == 0);
  CHECK(none.sizes.left_out == s.sizes.components);
  free(area);
  free(of_point);
  drop_surface(&none);
  drop_surface(&fewer);
  drop_surface(&s);
  drop_lines(&l);
  free(f.values);
}

int main(void)
{
  an_edge_of_the_polygon_is_a_planar_strip();
  a_circle_is_a_torus_of_second_order();
  closed_polygons_give_closed_surfaces();
  ties_never_open_a_surface();
  a_turned_polygon_gives_the_same_sides();
  every_tetrahedron_gives_its_part();
  connected_parts_are_found_and_small_ones_left_out();
  return chi_test_report();
}
