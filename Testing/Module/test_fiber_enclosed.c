/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What fiber surfaces enclose, as cells: volumes in closed form, the rule of even and odd, shared
 * faces, data that are carried, hostile hosts. */

#include "fiber_surface.h"

static const double pi = 3.14159265358979323846;

typedef struct enclosed
{
  chi_fiber_enclosed_sizes sizes;
  double (*points)[3], (*values)[2];
  int64_t (*cells)[4];
  int64_t *offsets, *ids;
} enclosed;

static void drop_enclosed(enclosed* e)
{
  free(e->points);
  free(e->values);
  free(e->cells);
  free(e->offsets);
  free(e->ids);
  memset(e, 0, sizeof *e);
}

static chi_status write_enclosed(
  enclosed* e, const chi_exec* exec, const chi_fiber* fiber, const chi_array_view* values)
{
  const size_t n = e->sizes.points, m = e->sizes.cells;
  e->points = must_alloc(n * sizeof *e->points);
  e->values = must_alloc(n * sizeof *e->values);
  e->cells = must_alloc(m * sizeof *e->cells);
  e->offsets = must_alloc((m + 1) * sizeof *e->offsets);
  e->ids = must_alloc(m * sizeof *e->ids);
  const chi_fiber_enclosed_outputs out = { .struct_size = sizeof out,
    .points = e->points,
    .point_type = CHI_F64,
    .offsets = e->offsets,
    .connectivity = (int64_t*)e->cells,
    .cell_ids = e->ids };
  const chi_status status = chi_fiber_enclosed_write(exec, fiber, &out);
  return status == CHI_OK && values
    ? chi_fiber_enclosed_attribute(exec, fiber, values, e->values, sizeof *e->values)
    : status;
}

static enclosed enclosed_with(
  const chi_exec* exec, const chi_grid_view* grid, const fields* f, const lines* l)
{
  enclosed e = { 0 };
  chi_fiber* fiber = NULL;
  const chi_fiber_params params = params_of(f, l);
  CHECK(chi_fiber_create(exec, &fiber) == CHI_OK);
  CHECK(chi_fiber_extract(exec, fiber, grid, &params) == CHI_OK);
  CHECK(chi_fiber_enclose(exec, fiber, &e.sizes) == CHI_OK);
  CHECK(write_enclosed(&e, exec, fiber, &f->view) == CHI_OK);
  chi_fiber_destroy(exec, fiber);
  return e;
}

static enclosed enclosed_by_lines(const chi_grid_view* grid, const fields* f, const lines* l)
{
  return enclosed_with(NULL, grid, f, l);
}

static double cell_volume(const enclosed* e, size_t c)
{
  double u[3][3];
  for (int k = 0; k < 3; ++k)
  {
    for (int a = 0; a < 3; ++a)
    {
      u[k][a] = e->points[e->cells[c][k + 1]][a] - e->points[e->cells[c][0]][a];
    }
  }
  return (u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
           u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
           u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0])) /
    6;
}

typedef struct face
{
  int64_t id[3];
  int turn; /* 1 or -1 by the order of its corners */
} face;

static int compare_faces(const void* x, const void* y)
{
  const face *const p = (const face*)x, *const q = (const face*)y;
  for (int k = 0; k < 3; ++k)
  {
    if (p->id[k] != q->id[k])
    {
      return p->id[k] < q->id[k] ? -1 : 1;
    }
  }
  return 0;
}

static face make_face(int64_t a, int64_t b, int64_t c)
{
  face f = { { a, b, c }, 1 };
  for (int k = 0; k < 3; ++k)
  {
    const int i = k == 1 ? 1 : 0;
    if (f.id[i] > f.id[i + 1])
    {
      const int64_t swap = f.id[i];
      f.id[i] = f.id[i + 1];
      f.id[i + 1] = swap;
      f.turn = -f.turn;
    }
  }
  return f;
}

/* Faces that remain when those run through one way and the other cancel. */
static size_t find_rim(const enclosed* e, face** rim)
{
  static const int corners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  const size_t n = 4 * e->sizes.cells;
  face* const faces = must_alloc(n * sizeof *faces);
  for (size_t i = 0; i < n; ++i)
  {
    const int64_t* const id = e->cells[i / 4];
    const int* const k = corners[i % 4];
    faces[i] = make_face(id[k[0]], id[k[1]], id[k[2]]);
  }
  qsort(faces, n, sizeof *faces, compare_faces);
  size_t kept = 0;
  for (size_t i = 0; i < n;)
  {
    int balance = 0;
    const face f = faces[i];
    for (; i < n && compare_faces(faces + i, &f) == 0; ++i)
    {
      balance += faces[i].turn;
    }
    if (balance)
    {
      faces[kept] = f;
      faces[kept++].turn = balance;
    }
  }
  *rim = faces;
  return kept;
}

/* By even and odd. */
static int is_inside(const lines* l, const double x[2])
{
  int odd = 0;
  for (size_t i = 0; i < l->view.line_count; ++i)
  {
    for (int64_t k = l->offsets[i]; k + 1 < l->offsets[i + 1]; ++k)
    {
      const double *const p = l->xyz + 3 * k, *const q = p + 3;
      if ((p[1] > x[1]) != (q[1] > x[1]))
      {
        odd ^= p[0] + (x[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > x[0];
      }
    }
  }
  return odd;
}

static double outline_distance(const lines* l, const double x[2])
{
  double least = INFINITY;
  for (size_t i = 0; i < l->view.line_count; ++i)
  {
    for (int64_t k = l->offsets[i]; k + 1 < l->offsets[i + 1]; ++k)
    {
      const double *const p = l->xyz + 3 * k, *const q = p + 3;
      const double d[2] = { q[0] - p[0], q[1] - p[1] }, square = d[0] * d[0] + d[1] * d[1];
      double t = square > 0 ? ((x[0] - p[0]) * d[0] + (x[1] - p[1]) * d[1]) / square : 0;
      t = t < 0 ? 0 : t > 1 ? 1 : t;
      least = fmin(least, hypot(x[0] - p[0] - t * d[0], x[1] - p[1] - t * d[1]));
    }
  }
  return least;
}

/* What all results promise: right-handed cells of the mesh whose volumes are the whole, all points
 * used, the middle of each cell that has any volume inside of the lines, or on them: where values
 * are the same all over a cell. Flat cells join faces that are divided in two ways; values on lines
 * make more of them. */
static void check_enclosed(
  const enclosed* e, const lines* l, size_t cells, double size, double most_flat)
{
  const size_t n = e->sizes.points, m = e->sizes.cells;
  uint8_t* const used = must_alloc(n);
  size_t bad = 0, outside = 0, flat = 0, turned = 0;
  double sum = 0;
  memset(used, 0, n);
  for (size_t c = 0; c < m; ++c)
  {
    double middle[2] = { 0, 0 };
    for (int k = 0; k < 4; ++k)
    {
      const int64_t id = e->cells[c][k];
      bad += id < 0 || (size_t)id >= n;
      used[id] = 1;
      middle[0] += e->values[id][0] / 4;
      middle[1] += e->values[id][1] / 4;
    }
    const double volume = cell_volume(e, c);
    sum += volume;
    turned += volume < -1e-14 * size; /* rounding of coordinates of this size to the third */
    flat += volume < 1e-12 * size;
    outside +=
      volume > 1e-9 * size && !is_inside(l, middle) && !(outline_distance(l, middle) < 1e-13);
    bad += e->offsets[c + 1] != 4 * (int64_t)(c + 1) || e->ids[c] < 0 || (size_t)e->ids[c] >= cells;
  }
  for (size_t i = 0; i < n; ++i)
  {
    bad += !used[i];
  }
  CHECK(bad == 0 && outside == 0 && turned == 0);
  CHECK((double)flat <= most_flat * (double)m);
  CHECK_NEAR(sum, e->sizes.volume, 1e-12 * e->sizes.volume);
  free(used);
}

/* A box [0, 1]^2 x [0, 2], sheared cells by an uneven count. */
static chi_grid_view unit_box(void)
{
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { 6, 5, 4 },
    .index_to_world = { 0.2, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 2 / 3.0, 0, 0, 0, 0, 1 } };
}

static void x_and_y(const double x[3], double value[2])
{
  value[0] = x[0];
  value[1] = x[1];
}

static void volumes_are_area_times_depth(void)
{
  const chi_grid_view grid = unit_box();
  fields f = make_fields(&grid, x_and_y);
  /* a star of 5 corners inside; tips alone are inside of an odd number of turns */
  double star[6][2], area_of_star = 0;
  for (int k = 0; k < 6; ++k)
  {
    star[k][0] = 0.5 + 0.37 * cos(4 * pi * (k % 5) / 5 + 0.3);
    star[k][1] = 0.5 + 0.37 * sin(4 * pi * (k % 5) / 5 + 0.3);
  }
  {
    /* five triangles on the sides of the inner pentagon, of circumradius r = R / phi^2 */
    const double phi = (1 + sqrt(5)) / 2, r = 0.37 / (phi * phi), side = 2 * r * sin(pi / 5);
    const double height = 0.37 - r * cos(pi / 5);
    area_of_star = 5 * 0.5 * side * height;
  }
  const double notched[8][2] = { { 0.1, 0.1 }, { 0.9, 0.15 }, { 0.85, 0.9 }, { 0.5, 0.3 },
    { 0.45, 0.8 }, { 0.3, 0.35 }, { 0.2, 0.95 }, { 0.1, 0.1 } };
  double area_of_notched = 0;
  for (int k = 0; k < 7; ++k)
  {
    area_of_notched += (notched[k][0] * notched[k + 1][1] - notched[k][1] * notched[k + 1][0]) / 2;
  }
  /* corners and sides exactly on values of points and on sides of cells */
  const double on_values[5][2] = { { 0.25, 0.25 }, { 0.75, 0.25 }, { 0.75, 0.75 }, { 0.25, 0.75 },
    { 0.25, 0.25 } };
  const double all[5][2] = { { -1, -1 }, { 2, -1 }, { 2, 3 }, { -1, 3 }, { -1, -1 } };
  const double outside[5][2] = { { 2, 2 }, { 3, 2 }, { 3, 3 }, { 2, 3 }, { 2, 2 } };
  const double just[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0, 0 } };
  const double squares[10][2] = { { 0.1, 0.1 }, { 0.6, 0.1 }, { 0.6, 0.6 }, { 0.1, 0.6 },
    { 0.1, 0.1 }, { 0.3, 0.3 }, { 0.9, 0.3 }, { 0.9, 0.9 }, { 0.3, 0.9 }, { 0.3, 0.3 } };
  const double back[6][2] = { { 0.2, 0.2 }, { 0.8, 0.2 }, { 0.8, 0.8 }, { 0.8, 0.2 }, { 0.2, 0.8 },
    { 0.2, 0.2 } };
  const double line[4][2] = { { 0.2, 0.2 }, { 0.8, 0.8 }, { 0.5, 0.5 }, { 0.2, 0.2 } };
  const size_t two[2] = { 5, 5 };
  lines shapes[9] = { make_line(6, (const double(*)[2])star), make_line(8, notched),
    make_line(5, on_values), make_line(5, all), make_line(5, outside), make_line(5, just),
    make_lines(2, two, squares), make_line(6, back), make_line(4, line) };
  const double areas[9] = { area_of_star, area_of_notched, 0.25, 1, 0, 1, 0.25 + 0.36 - 0.18, 0.18,
    0 };
  for (int k = 0; k < 9; ++k)
  {
    enclosed e = enclosed_by_lines(&grid, &f, shapes + k);
    check_enclosed(&e, shapes + k, 60, 2, 0.25);
    CHECK_NEAR(e.sizes.volume, 2 * areas[k], 1e-14); /* places are rounded, their sizes are 1 */
    CHECK((e.sizes.cells == 0) == (areas[k] == 0));
    drop_enclosed(&e);
    drop_lines(shapes + k);
  }
  free(f.values);
}

static void what_is_wholly_inside_is_passed(void)
{
  const chi_grid_view grid = image_of(5, 4, 4);
  fields f = make_fields(&grid, mixed_waves);
  const double all[5][2] = { { -9, -9 }, { 9, -9 }, { 9, 9 }, { -9, 8 }, { -9, -9 } };
  /* its two triangles meet in a line that passes no values */
  const double wide[4][2] = { { -90, -9 }, { 90, -9 }, { 0, 90 }, { -90, -9 } };
  lines l[2] = { make_line(4, wide), make_line(5, all) };
  enclosed e = enclosed_by_lines(&grid, &f, l);
  CHECK(e.sizes.cells == 6 * 36 && e.sizes.whole_cells == e.sizes.cells);
  CHECK(e.sizes.points == 80 && e.sizes.pieces == 1);
  CHECK_NEAR(e.sizes.volume, 36 * 0.25, 1e-13);
  drop_enclosed(&e);
  e = enclosed_by_lines(&grid, &f, l + 1);
  CHECK(e.sizes.whole_cells > 0 && e.sizes.pieces == 2);
  CHECK_NEAR(e.sizes.volume, 36 * 0.25, 1e-13);
  drop_enclosed(&e);
  drop_lines(l);
  drop_lines(l + 1);
  free(f.values);
}

static void ring(const double x[3], double value[2])
{
  value[0] = sqrt(x[0] * x[0] + x[1] * x[1]);
  value[1] = x[2];
}

static void a_circle_encloses_a_torus_of_second_order(void)
{
  double errors[3];
  for (int k = 0; k < 3; ++k)
  {
    const size_t n = (size_t)8 << k;
    const double h = 2 / (double)n;
    const chi_grid_view grid = { .struct_size = sizeof(chi_grid_view),
      .kind = CHI_GRID_IMAGE,
      .dimensions = { n + 1, n + 1, n + 1 },
      .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 } };
    fields f = make_fields(&grid, ring);
    lines l = make_circle(0.55, 0.05, 0.3, 16u << k, k == 1);
    enclosed e = enclosed_by_lines(&grid, &f, &l);
    check_enclosed(&e, &l, n * n * n, 1, 0.01);
    /* the surface encloses as much */
    const chi_fiber_params params = params_of(&f, &l);
    surface s = surface_of(&grid, &params);
    CHECK_NEAR(enclosed_by(&s), e.sizes.volume, 1e-12);
    face* rim;
    CHECK(find_rim(&e, &rim) >= s.sizes.triangles);
    free(rim);
    drop_surface(&s);
    errors[k] = fabs(e.sizes.volume - 2 * pi * pi * 0.55 * 0.09);
    drop_enclosed(&e);
    drop_lines(&l);
    free(f.values);
  }
  CHECK(errors[0] / errors[1] > 3 && errors[1] / errors[2] > 3); /* 4 in the limit */
}

/* A rectangle around all values beside some lines encloses what they do not. */
static lines with_frame(const lines* l)
{
  const size_t count = (size_t)l->offsets[l->view.line_count];
  size_t* const counts = must_alloc((l->view.line_count + 1) * sizeof *counts);
  double(*const points)[2] = must_alloc((count + 5) * sizeof *points);
  static const double frame[5][2] = { { -99, -98 }, { 97, -96 }, { 95, 94 }, { -93, 92 },
    { -99, -98 } };
  for (size_t i = 0; i < l->view.line_count; ++i)
  {
    counts[i] = (size_t)(l->offsets[i + 1] - l->offsets[i]);
  }
  counts[l->view.line_count] = 5;
  for (size_t i = 0; i < count + 5; ++i)
  {
    points[i][0] = i < count ? l->xyz[3 * i] : frame[i - count][0];
    points[i][1] = i < count ? l->xyz[3 * i + 1] : frame[i - count][1];
  }
  lines all = make_lines(l->view.line_count + 1, counts, (const double(*)[2])points);
  free(points);
  free(counts);
  return all;
}

static void steps(const double x[3], double value[2])
{
  value[0] = round(3 * sin(x[0] + 0.3 * x[1]));
  value[1] = round(3 * cos(x[1] - 0.4 * x[2]));
}

static lines random_lines(uint32_t* seed, int is_whole)
{
  const size_t line_count = 1 + (size_t)(3 * chi_test_random(seed));
  size_t counts[4], total = 0;
  double points[64][2];
  for (size_t i = 0; i < line_count; ++i)
  {
    const size_t first = total;
    counts[i] = 4 + (size_t)(6 * chi_test_random(seed));
    for (size_t k = 0; k < counts[i]; ++k, ++total)
    {
      for (int a = 0; a < 2; ++a)
      {
        const double x = (is_whole ? 8 : 3) * (chi_test_random(seed) - 0.5);
        points[total][a] = is_whole ? round(x) : x;
      }
    }
    memcpy(points[total - 1], points[first], sizeof points[first]);
  }
  return make_lines(line_count, counts, (const double(*)[2])points);
}

/* Random lines, crossing and touching, on values in general position and on whole numbers. */
static void inside_and_outside_are_everything(void)
{
  const chi_grid_view image = image_of(6, 5, 4);
  mesh* const m = make_mixed(4, 0.2, 23);
  mesh* const t = tetrahedra_of(&image);
  chi_grid_view mixed = view_of(m), list = view_of(t);
  const chi_grid_view* const grids[3] = { &image, &mixed, &list };
  const size_t cells[3] = { 60, m->cells, t->cells };
  const double sizes[3] = { 60 * 0.25, 64 + volume_on_top(m), 60 * 0.25 };
  uint32_t seed = 7;
  size_t filled = 0;
  for (int k = 0; k < 36; ++k)
  {
    const int g = k % 3, is_whole = k / 3 % 2;
    fields f = make_fields(grids[g], is_whole ? steps : mixed_waves);
    lines l = random_lines(&seed, is_whole), outer = with_frame(&l);
    enclosed a = enclosed_by_lines(grids[g], &f, &l), b = enclosed_by_lines(grids[g], &f, &outer);
    CHECK_NEAR(a.sizes.volume + b.sizes.volume, sizes[g], 1e-12 * sizes[g]);
    filled += a.sizes.cells > 0;
    check_enclosed(&a, &l, cells[g], sizes[g], is_whole ? 0.3 : 0.01);
    check_enclosed(&b, &outer, cells[g], sizes[g], is_whole ? 0.3 : 0.01);
    face* rim;
    const size_t count = find_rim(&a, &rim);
    size_t torn = 0;
    for (size_t i = 0; i < count && g != 1; ++i)
    {
      /* in the lattice's walls or on the lines' surface */
      double off = 0, wall[6] = { 0, 0, 0, 0, 0, 0 };
      for (int c = 0; c < 3; ++c)
      {
        const double* const x = a.points[rim[i].id[c]];
        const double low[3] = { 1, 2, 3 }, high[3] = { 3.5, 3, 9 };
        off = fmax(off, outline_distance(&l, a.values[rim[i].id[c]]));
        for (int d = 0; d < 6; ++d)
        {
          wall[d] = fmax(wall[d], fabs(x[d / 2] - (d % 2 ? high : low)[d / 2]));
        }
      }
      double nearest = off;
      for (int d = 0; d < 6; ++d)
      {
        nearest = fmin(nearest, wall[d]);
      }
      torn += nearest > 1e-13; /* values and coordinates up to 9 */
    }
    CHECK(torn == 0);
    free(rim);
    drop_enclosed(&a);
    drop_enclosed(&b);
    drop_lines(&l);
    drop_lines(&outer);
    free(f.values);
  }
  CHECK(filled > 30);
  drop_view(&mixed);
  drop_view(&list);
  free(m);
  free(t);
}

static int same_enclosed(const enclosed* a, const enclosed* b)
{
  const size_t n = a->sizes.points, m = a->sizes.cells;
  return n == b->sizes.points && m == b->sizes.cells && a->sizes.volume == b->sizes.volume &&
    memcmp(a->points, b->points, n * sizeof *a->points) == 0 &&
    memcmp(a->values, b->values, n * sizeof *a->values) == 0 &&
    memcmp(a->cells, b->cells, m * sizeof *a->cells) == 0 &&
    memcmp(a->ids, b->ids, m * sizeof *a->ids) == 0;
}

static void any_schedule_gives_the_same_bits(void)
{
  const chi_grid_view image = image_of(24, 20, 12);
  mesh* const m = make_mixed(8, 0.2, 3);
  chi_grid_view mixed = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &mixed };
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  for (int k = 0; k < 2; ++k)
  {
    fields f = make_fields(grids[k], mixed_waves);
    lines l = make_circle(0.1, 0, 0.5, 30, 0); /* several batches */
    enclosed a = enclosed_by_lines(grids[k], &f, &l);
    enclosed b = enclosed_with(&backwards, grids[k], &f, &l);
    CHECK(a.sizes.cells > 3000 && same_enclosed(&a, &b));
    drop_enclosed(&a);
    drop_enclosed(&b);
    drop_lines(&l);
    free(f.values);
  }
  drop_view(&mixed);
  free(m);
}

/* Bits too: those of the surface are made in the same way. */
static void the_surface_is_its_rim(void)
{
  const chi_grid_view grid = image_of(9, 8, 7);
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square);
  const chi_fiber_params params = params_of(&f, &l);
  surface s = surface_of(&grid, &params);
  enclosed e = enclosed_by_lines(&grid, &f, &l);
  size_t found = 0;
  for (size_t i = 0; i < s.sizes.points; ++i)
  {
    for (size_t k = 0; k < e.sizes.points; ++k)
    {
      if (memcmp(s.points[i], e.points[k], sizeof s.points[i]) == 0)
      {
        ++found;
        break;
      }
    }
  }
  CHECK(s.sizes.points > 100 && found == s.sizes.points);
  drop_surface(&s);
  drop_enclosed(&e);
  drop_lines(&l);
  free(f.values);
}

static void open_lines_are_refused_and_counted(void)
{
  const chi_grid_view grid = image_of(5, 4, 4);
  fields f = make_fields(&grid, mixed_waves);
  const double points[8][2] = { { -0.4, -0.5 }, { 0.6, -0.5 }, { 0.6, 0.4 }, { -0.4, -0.5 },
    { 0, 0 }, { 0.2, 0.1 }, { 0.2, 0.1 }, { 0.3, 0.3 } };
  const size_t counts[2] = { 4, 4 };
  lines l = make_lines(2, counts, points);
  const chi_fiber_params params = params_of(&f, &l);
  const chi_fiber_enclosed_outputs out = { .struct_size = sizeof out };
  chi_fiber_enclosed_sizes sizes;
  chi_fiber* fiber = NULL;
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  CHECK(chi_fiber_enclose(NULL, fiber, &sizes) == CHI_ERROR_NOT_READY);
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
  CHECK(chi_fiber_enclose(NULL, fiber, &sizes) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(sizes.open_segments == 2);
  CHECK(chi_fiber_enclosed_write(NULL, fiber, &out) == CHI_ERROR_NOT_READY);
  CHECK(chi_fiber_enclose(NULL, fiber, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  chi_fiber_destroy(NULL, fiber);
  drop_lines(&l);
  free(f.values);
}

static chi_status try_all(const chi_exec* exec, const chi_grid_view* grid, const fields* f,
  const lines* l, const enclosed* expected)
{
  enclosed e = { 0 };
  chi_fiber* fiber = NULL;
  const chi_fiber_params params = params_of(f, l);
  chi_status status = chi_fiber_create(exec, &fiber);
  status = status == CHI_OK ? chi_fiber_extract(exec, fiber, grid, &params) : status;
  status = status == CHI_OK ? chi_fiber_enclose(exec, fiber, &e.sizes) : status;
  status = status == CHI_OK ? write_enclosed(&e, exec, fiber, &f->view) : status;
  CHECK(status != CHI_OK || same_enclosed(&e, expected));
  chi_fiber_destroy(exec, fiber);
  drop_enclosed(&e);
  return status;
}

static void every_refusal_and_every_cancellation_is_survived(void)
{
  mesh* const m = make_mixed(3, 0.3, 5);
  chi_grid_view grid = view_of(m);
  fields f = make_fields(&grid, mixed_waves);
  /* crosses itself, so that corners are added */
  const double points[5][2] = { { -0.4, -0.5 }, { 0.6, 0.4 }, { 0.6, -0.5 }, { -0.4, 0.4 },
    { -0.4, -0.5 } };
  lines l = make_line(5, points);
  enclosed expected = enclosed_by_lines(&grid, &f, &l);
  CHECK(expected.sizes.cells > 100);
  for (int cancels = 0; cancels < 2; ++cancels)
  {
    int finished = 0;
    for (long at = 0; at < 4000 && !finished; at += cancels ? 1 + at / 32 : 1)
    {
      chi_test_host host = { .refuse_at = cancels ? -1 : at, .cancel_at = cancels ? at : -1 };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release,
        .is_cancelled = cancels ? chi_test_is_cancelled : NULL };
      const chi_status status = try_all(&exec, &grid, &f, &l, &expected);
      finished = cancels ? host.polls <= at : host.allocations <= at;
      CHECK(status ==
        (finished     ? CHI_OK
            : cancels ? CHI_ERROR_CANCELLED
                      : CHI_ERROR_OUT_OF_MEMORY));
      CHECK(host.live == 0);
    }
    CHECK(finished);
  }
  drop_enclosed(&expected);
  drop_lines(&l);
  free(f.values);
  drop_view(&grid);
  free(m);
}

int main(void)
{
  volumes_are_area_times_depth();
  what_is_wholly_inside_is_passed();
  a_circle_encloses_a_torus_of_second_order();
  inside_and_outside_are_everything();
  the_surface_is_its_rim();
  any_schedule_gives_the_same_bits();
  open_lines_are_refused_and_counted();
  every_refusal_and_every_cancellation_is_survived();
  return chi_test_report();
}
