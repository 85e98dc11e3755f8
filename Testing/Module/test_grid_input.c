/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What of a grid is left out and counted, input that is refused, hosts that refuse, scalars. */

#include "grid_lattice.h"

static const double eps = 2.220446049250313e-16;

static void what_is_left_out_is_counted(void)
{
  mesh* const m = new_mesh();
  for (int i = 0; i < 12; ++i)
  {
    add_point(m, i & 1, i >> 1 & 1, i >> 2);
  }
  add_point(m, NAN, 0, 0);
  add_point(m, 0, INFINITY, 0);
  add_point(m, 0, 0, 2e100);
  static const int64_t cube[8] = { 0, 1, 3, 2, 4, 5, 7, 6 }, next[8] = { 4, 5, 7, 6, 8, 9, 11, 10 };
  add_cell(m, 12, 8, cube);
  add_cell(m, 9, 4, cube);
  add_cell(m, 0, 0, cube);
  add_cell(m, 1, 1, cube);
  add_cell(m, 4, 5, cube);
  add_cell(m, 23, 8, cube);
  add_cell(m, 71, 4, cube);
  add_cell(m, 41, 8, cube);
  add_cell(m, 200, 3, cube);
  for (int64_t bad = 12; bad < 15; ++bad)
  {
    add_cell(m, 10, 4, (const int64_t[4]){ 0, 1, 2, bad });
  }
  for (int k = 0; k < 3; ++k)
  {
    add_cell(m, 12, 8, next);
  }
  add_cell(m, 10, 4, (const int64_t[4]){ 0, 1, 3, 2 }); /* flat */
  add_cell(m, 10, 4, (const int64_t[4]){ 0, 1, 1, 4 }); /* collapsed */
  chi_grid_view view = view_of(m);
  uint8_t ghosts[17] = { 0 };
  ghosts[12] = CHI_GRID_DUPLICATE_CELL;
  ghosts[13] = CHI_GRID_HIDDEN_CELL;
  view.cell_ghosts = ghosts;
  uint8_t hidden[15] = { 0 };
  hidden[9] = CHI_GRID_HIDDEN_POINT;
  hidden[3] = 1; /* a duplicate point is none of it */
  view.point_ghosts = hidden;
  split s;
  CHECK(make_split(&s, NULL, &view) == CHI_OK);
  check_split(&s);
  const chi_grid_counts* const c = &s.counts;
  CHECK(c->cells == 17 && c->points == 15);
  CHECK(c->tetrahedra == 7 && c->flat_cells == 1 && c->collapsed_tetrahedra == 1);
  CHECK(c->single_cells == 1);
  CHECK(c->ghost_cells == 1 && c->blanked_cells == 2); /* a cell, and one at a hidden point */
  CHECK(c->lower_dimensional_cells == 5);
  CHECK(c->unsupported_cells == 3 && c->first_unsupported_type == 71);
  CHECK(c->non_finite_cells == 3 && c->first_bad_cell == -1);
  CHECK_NEAR(c->volume, 1, 8 * eps);
  const double bounds[6] = { 0, 1, 0, 1, 0, 1 };
  CHECK(memcmp(bounds, c->bounds, sizeof bounds) == 0);
  drop_split(&s);
  drop_view(&view);
  free(m);

  chi_grid_view image = image_of(3, 3, 3);
  uint8_t blank[8] = { 0, CHI_GRID_HIDDEN_CELL, 0, 0, 0, 0, CHI_GRID_DUPLICATE_CELL, 0 };
  image.cell_ghosts = blank;
  CHECK(make_split(&s, NULL, &image) == CHI_OK);
  check_split(&s);
  CHECK(s.counts.tetrahedra == 36 && s.counts.blanked_cells == 1 && s.counts.ghost_cells == 1);
  drop_split(&s);
  image.index_to_world[3] = NAN;
  CHECK(make_split(&s, NULL, &image) == CHI_OK);
  CHECK(s.counts.tetrahedra == 0 && s.counts.non_finite_cells == 6);
  drop_split(&s);
}

/* Every way to break a cell names it, and nothing else is reported. */
static void broken_cells_are_named(void)
{
  for (int way = 0; way < 15; ++way)
  {
    mesh* const m = make_mixed(2, 0, 1);
    const int64_t box[] = { 0, 1, 4, 3, 9, 10, 13, 12 };
    const int64_t stream[] = { 6, 4, 0, 9, 12, 3, 4, 1, 4, 13, 10, 4, 0, 1, 10, 9, 4, 3, 12, 13, 4,
      4, 0, 3, 4, 1, 4, 9, 10, 13, 12 };
    const size_t length = sizeof stream / sizeof stream[0], bad = m->cells;
    add_polyhedron(m, 8, box, length, stream);
    add_cell(m, 12, 8, box);
    chi_grid_view view = view_of(m);
    int64_t* const offsets = (int64_t*)view.offsets;
    int64_t* const ids = (int64_t*)view.connectivity + offsets[bad];
    int64_t* const faces = (int64_t*)view.faces;
    chi_grid_counts counts;
    CHECK(chi_grid_count(NULL, &view, &counts) == CHI_OK);
    int64_t named = (int64_t)bad;
    switch (way)
    {
      case 0:
        ids[3] = (int64_t)m->points;
        break;
      case 1:
        ids[3] = -1;
        break;
      case 2:
        offsets[bad + 1] = offsets[bad] - 1;
        break;
      case 3:
        view.connectivity_count -= 1;
        named = (int64_t)bad + 1;
        break;
      case 4:
        ((uint8_t*)view.cell_types)[bad] = 25; /* of twenty points */
        break;
      case 5:
        ((int64_t*)view.face_offsets)[bad] = -1;
        break;
      case 6:
        ((int64_t*)view.face_offsets)[bad] = (int64_t)length;
        break;
      case 7:
        faces[0] = 3;
        break;
      case 8:
        faces[0] = INT64_MAX;
        break;
      case 9:
        faces[1] = 2;
        break;
      case 10:
        faces[1] = INT64_MIN;
        break;
      case 11:
        faces[0] = 7;
        break;
      case 12:
        faces[length - 1] = (int64_t)m->points;
        break;
      case 13:
        faces[2] = -1;
        break;
      default:
        offsets[0] = -1;
        named = 0;
        break;
    }
    CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_INVALID_ARGUMENT);
    CHECK(counts.first_bad_cell == named && counts.tetrahedra == 0 && counts.volume == 0);
    counts.tetrahedra = 1;
    uint32_t vertices[4];
    const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices };
    CHECK(chi_grid_split(NULL, &view, &counts, &out) == CHI_ERROR_INVALID_ARGUMENT);
    view.connectivity_count += way == 3;
    drop_view(&view);
    free(m);
  }
}

static void bad_arguments_are_refused(void)
{
  mesh* const m = make_mixed(2, 0, 1);
  const chi_grid_view good = view_of(m);
  chi_grid_view view = good;
  chi_grid_counts counts, other;
  CHECK(chi_grid_count(NULL, &good, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_grid_count(NULL, NULL, &counts) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(counts.first_bad_cell == -1 && counts.cells == 0);
  for (int way = 0; way < 9; ++way)
  {
    view = good;
    switch (way)
    {
      case 0:
        view.kind = 4;
        break;
      case 1:
        view.kind = -1;
        break;
      case 2:
        view.points.stride = 20;
        break;
      case 3:
        view.points.data = NULL;
        break;
      case 4:
        view.points.type = CHI_I32;
        break;
      case 5:
        view.cell_types = NULL;
        break;
      case 6:
        view.offsets = NULL;
        break;
      case 7:
        view.connectivity = NULL;
        break;
      default:
        view.faces_count = 3;
        break;
    }
    CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_INVALID_ARGUMENT);
    CHECK(counts.first_bad_cell == -1);
  }
  view = image_of(3, 3, 3);
  view.kind = CHI_GRID_CURVILINEAR;
  view.points = good.points;
  view.points.count = 26;
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_INVALID_ARGUMENT);
  double axis[3] = { 0, 1, 2 };
  view.kind = CHI_GRID_RECTILINEAR;
  for (int k = 0; k < 3; ++k)
  {
    view.axes[k] = (chi_array_view){ axis, 3, 1, 8, CHI_F64 };
  }
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_OK);
  view.axes[1].count = 2;
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_INVALID_ARGUMENT);
  view.axes[1].count = 3;
  view.axes[2].type = 11;
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_INVALID_ARGUMENT);
  view = image_of(3, SIZE_MAX / 2, 3);
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_TOO_LARGE);
  view = image_of(65536, 65536, 1);
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_TOO_LARGE);
  view = good;
  view.points = (chi_vec3_view){ m->x, UINT32_MAX, 24, CHI_F64 };
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_ERROR_TOO_LARGE);

  CHECK(chi_grid_count(NULL, &good, &counts) == CHI_OK);
  uint32_t* const vertices = malloc(16 * counts.tetrahedra);
  chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices };
  CHECK(chi_grid_split(NULL, &good, &counts, &out) == CHI_OK);
  CHECK(chi_grid_split(NULL, NULL, &counts, &out) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_grid_split(NULL, &good, NULL, &out) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_grid_split(NULL, &good, &counts, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  for (int way = 0; way < 4; ++way)
  {
    other = counts;
    other.tetrahedra -= way == 0;
    other.points += way == 1;
    other.cells -= way == 2;
    other.extra_points += way == 3;
    CHECK(chi_grid_split(NULL, &good, &other, &out) == CHI_ERROR_INVALID_ARGUMENT);
  }
  out.vertices = NULL;
  CHECK(chi_grid_split(NULL, &good, &counts, &out) == CHI_ERROR_INVALID_ARGUMENT);
  free(vertices);
  view = good;
  drop_view(&view);
  free(m);
}

static void structs_of_other_versions_are_adopted_or_refused(void)
{
  mesh* const m = make_mixed(2, 0, 1);
  chi_grid_view view = view_of(m);
  chi_grid_counts counts;
  CHECK(chi_grid_count(NULL, &view, &counts) == CHI_OK);
  CHECK(counts.struct_size == sizeof counts);
  uint32_t* const vertices = malloc(16 * counts.tetrahedra);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices };
  const void* const given[3] = { &view, &counts, &out };
  const size_t sizes[3] = { sizeof view, sizeof counts, sizeof out };
  /* counts: folded_cells and collapsed_tetrahedra are not needed */
  const size_t least[3] = { sizeof view, offsetof(chi_grid_counts, folded_cells), sizeof out };
  for (int which = 0; which < 3; ++which)
  {
    const size_t lengths[5] = { least[which], sizes[which] + 16, least[which] - 8,
      sizes[which] + 16, sizes[which] };
    for (int k = 0; k < 5; ++k)
    {
      char* const other = calloc(1, lengths[k]);
      memcpy(other, given[which], lengths[k] < sizes[which] ? lengths[k] : sizes[which]);
      const size_t said = k == 4 ? SIZE_MAX - 7 : lengths[k];
      memcpy(other, &said, sizeof said);
      other[lengths[k] - 1] = (char)(k == 3 ? 1 : other[lengths[k] - 1]);
      const void* used[3] = { given[0], given[1], given[2] };
      used[which] = other;
      const chi_status wanted = k < 2 ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT;
      CHECK(chi_grid_split(NULL, (const chi_grid_view*)used[0], (const chi_grid_counts*)used[1],
              (const chi_grid_tetrahedra*)used[2]) == wanted);
      chi_grid_counts again;
      CHECK(which > 0 || chi_grid_count(NULL, (const chi_grid_view*)used[0], &again) == wanted);
      free(other);
    }
  }
  free(vertices);
  drop_view(&view);
  free(m);
}

static void hostile_hosts_are_survived(void)
{
  mesh* const m = make_mixed(4, 0.42, 7);
  chi_grid_view view = view_of(m);
  chi_test_host host = { -1, 1L << 40, 0, 0, 0 };
  const chi_exec exec = { .struct_size = sizeof exec,
    .user = &host,
    .alloc = chi_test_alloc,
    .release = chi_test_release,
    .is_cancelled = chi_test_is_cancelled };
  split s;
  CHECK(make_split(&s, &exec, &view) == CHI_OK);
  drop_split(&s);
  const long allocations = host.allocations, polls = host.polls;
  CHECK(allocations == 3 && polls >= 6 && host.live == 0);
  for (long k = 0; k < allocations; ++k)
  {
    host = (chi_test_host){ k, 1L << 40, 0, 0, 0 };
    CHECK(make_split(&s, &exec, &view) == CHI_ERROR_OUT_OF_MEMORY);
    CHECK(host.live == 0);
    drop_split(&s);
  }
  for (long k = 0; k < polls; ++k)
  {
    host = (chi_test_host){ -1, k, 0, 0, 0 };
    CHECK(make_split(&s, &exec, &view) == CHI_ERROR_CANCELLED);
    CHECK(host.live == 0);
    drop_split(&s);
  }
  float scalar;
  const float value = 3;
  const chi_array_view values = { &value, 1, 1, sizeof value, CHI_F32 };
  for (long k = 0; k < 2; ++k)
  {
    host = (chi_test_host){ -1, k, 0, 0, 0 };
    CHECK(chi_grid_scalars(&exec, NULL, &values, 0, NULL, 0, &scalar) == CHI_ERROR_CANCELLED);
  }
  drop_view(&view);
  free(m);
}

static void scalars_of_any_type_and_of_centres(void)
{
  mesh* const m = make_mixed(4, 0.42, 7);
  chi_grid_view view = view_of(m);
  split s;
  CHECK(make_split(&s, NULL, &view) == CHI_OK);
  const size_t n = m->points, extra = s.counts.extra_points;
  CHECK(extra > 0);
  /* a linear function is met by the means, to float's rounding */
  double* const values = malloc(2 * n * sizeof *values);
  float* const scalars = malloc((n + extra) * sizeof *scalars);
  for (size_t i = 0; i < n; ++i)
  {
    values[2 * i] = 7;
    values[2 * i + 1] = 1 + m->x[i][0] + 2 * m->x[i][1] - 3 * m->x[i][2];
  }
  const chi_array_view array = { values, n, 2, 2 * sizeof *values, CHI_F64 };
  CHECK(chi_grid_scalars(NULL, &view, &array, 1, s.extra_cells, extra, scalars) == CHI_OK);
  for (size_t i = 0; i < n + extra; ++i)
  {
    const double* const x = s.points[i];
    CHECK_NEAR((double)scalars[i], 1 + x[0] + 2 * x[1] - 3 * x[2], 13 * 0.6e-7);
  }
  uint32_t beyond = (uint32_t)m->cells;
  const chi_status refused = CHI_ERROR_INVALID_ARGUMENT;
  CHECK(chi_grid_scalars(NULL, &view, &array, 1, &beyond, 1, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, NULL, &array, 1, s.extra_cells, extra, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, &view, &array, 2, NULL, 0, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, &view, &array, -2, NULL, 0, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, &view, &array, 0, NULL, 1, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, &view, &array, 0, NULL, 0, NULL) == refused);
  CHECK(chi_grid_scalars(NULL, &view, NULL, 0, NULL, 0, scalars) == refused);
  const chi_array_view few = { values, n - 1, 2, 2 * sizeof *values, CHI_F64 };
  CHECK(chi_grid_scalars(NULL, &view, &few, 1, s.extra_cells, extra, scalars) == refused);
  CHECK(chi_grid_scalars(NULL, NULL, &few, 1, NULL, 0, scalars) == CHI_OK); /* of cells, say */
  const int16_t triple[6] = { 3, -4, 12, -32768, 0, 0 };
  const chi_array_view integers = { triple, 2, 3, sizeof triple / 2, CHI_I16 };
  CHECK(chi_grid_scalars(NULL, NULL, &integers, -1, NULL, 0, scalars) == CHI_OK);
  CHECK(scalars[0] == 13 && scalars[1] == 32768);
  CHECK(chi_grid_scalars(NULL, NULL, &integers, 1, NULL, 0, scalars) == CHI_OK);
  CHECK(scalars[0] == -4 && scalars[1] == 0);
  values[1] = NAN;
  CHECK(chi_grid_scalars(NULL, NULL, &array, 1, NULL, 0, scalars) == CHI_OK);
  CHECK(isnan(scalars[0]) && isfinite(scalars[1]));
  free(values);
  free(scalars);
  drop_split(&s);
  drop_view(&view);
  free(m);
}

int main(void)
{
  what_is_left_out_is_counted();
  broken_cells_are_named();
  bad_arguments_are_refused();
  structs_of_other_versions_are_adopted_or_refused();
  hostile_hosts_are_survived();
  scalars_of_any_type_and_of_centres();
  return chi_test_report();
}
