/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fiber surfaces under hostile hosts and input: what is refused, what is left out and counted, what
 * does not change the result. */

#include "fiber_surface.h"

/* So that bricks differ. */
static void slow(const double x[3], double value[2])
{
  value[0] = 0.2 * x[0] + 0.01 * x[1];
  value[1] = 0.08 * x[2] + 0.02 * sin(x[1]);
}

static surface surface_with(
  const chi_exec* exec, const chi_grid_view* grid, const chi_fiber_params* params)
{
  surface s = { 0 };
  chi_fiber* fiber = NULL;
  CHECK(chi_fiber_create(exec, &fiber) == CHI_OK);
  CHECK(chi_fiber_extract(exec, fiber, grid, params) == CHI_OK);
  CHECK(write_surface(&s, exec, fiber, params) == CHI_OK);
  chi_fiber_destroy(exec, fiber);
  return s;
}

static void any_schedule_gives_the_same_bits(void)
{
  const chi_grid_view image = image_of(40, 30, 20);
  mesh* const m = make_mixed(8, 0.2, 3);
  const chi_grid_view mixed = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &mixed };
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  for (int k = 0; k < 2; ++k)
  {
    fields f = make_fields(grids[k], mixed_waves);
    lines l = make_line(5, fiber_square);
    chi_fiber_params params = params_of(&f, &l);
    params.find_components = 1;
    surface a = surface_with(NULL, grids[k], &params);
    surface b = surface_with(&backwards, grids[k], &params);
    CHECK(a.sizes.triangles > 1000 && same_surface(&a, &b));
    CHECK(memcmp(a.components, b.components, a.sizes.triangles * sizeof *a.components) == 0);
    drop_surface(&a);
    drop_surface(&b);
    drop_lines(&l);
    free(f.values);
  }
  chi_grid_view view = mixed;
  drop_view(&view);
  free(m);
}

static void skipping_changes_nothing_and_is_counted(void)
{
  const chi_grid_view image = image_of(20, 18, 16);
  mesh* const m = tetrahedra_of(&image);
  chi_grid_view list = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &list };
  for (int k = 0; k < 2; ++k)
  {
    fields f = make_fields(grids[k], slow);
    lines l = make_circle(0.9, 1.3, 0.3, 30, 0);
    chi_fiber_params params = params_of(&f, &l);
    surface all = surface_of(grids[k], &params);
    CHECK(all.sizes.triangles > 100);
    CHECK(all.sizes.skipped[0] > 0 && all.sizes.skipped[2] == 0);
    for (int32_t off = 1; off < 8; ++off)
    {
      params.no_skipping = off;
      surface s = surface_of(grids[k], &params);
      CHECK(same_surface(&all, &s));
      CHECK(!(off & CHI_FIBER_SKIP_BRICKS) || s.sizes.skipped[0] == 0);
      CHECK(!(off & CHI_FIBER_SKIP_RUNS) || s.sizes.skipped[1] == 0);
      drop_surface(&s);
    }
    drop_surface(&all);
    drop_lines(&l);
    /* far away from all values each run lies on one side of all lines */
    l = make_circle(9, 30, 0.1, 4, 0);
    const chi_fiber_params far = params_of(&f, &l);
    surface none = surface_of(grids[k], &far);
    CHECK(none.sizes.triangles == 0 && none.sizes.points == 0);
    CHECK(none.sizes.skipped[1] == (20 * 18 * 16 + 255) / 256);
    drop_surface(&none);
    drop_lines(&l);
    free(f.values);
  }
  drop_view(&list);
  free(m);
}

static void what_has_not_changed_is_kept(void)
{
  chi_grid_view grid = image_of(12, 9, 10);
  grid.version = 5;
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square), other = make_line(4, fiber_square);
  chi_fiber_params params = params_of(&f, &l);
  params.fields_version = 3;
  chi_fiber* fiber = NULL;
  chi_fiber_sizes sizes;
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  const struct
  {
    const lines* l;
    uint64_t grid, fields;
    int32_t no_skipping;
    int64_t kept;
  } calls[] = { { &l, 5, 3, 0, 0 }, { &l, 5, 3, 0, 2 }, { &other, 5, 3, 0, 1 }, { &l, 5, 3, 0, 1 },
    { &l, 5, 4, 0, 0 }, { &l, 6, 4, 0, 0 }, { &l, 6, 4, CHI_FIBER_SKIP_UNCHANGED, 0 },
    { &l, 6, 0, 0, 0 }, { &l, 6, 0, 0, 0 } };
  surface first = surface_of(&grid, &params);
  for (size_t k = 0; k < sizeof calls / sizeof *calls; ++k)
  {
    grid.version = calls[k].grid;
    params.fields_version = calls[k].fields;
    params.polygon = calls[k].l->view;
    params.no_skipping = calls[k].no_skipping;
    CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
    surface s;
    CHECK(write_surface(&s, NULL, fiber, &params) == CHI_OK);
    CHECK(s.sizes.skipped[2] == calls[k].kept);
    CHECK(same_surface(&s, &first) == (calls[k].l == &l));
    drop_surface(&s);
  }
  params.split_corners = 1;
  params.fields_version = 4;
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
  params.no_normals = 1;
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
  chi_fiber_get_sizes(fiber, &sizes);
  CHECK(sizes.skipped[2] == 1 && sizes.points > first.sizes.points);
  chi_fiber_destroy(NULL, fiber);
  drop_surface(&first);
  drop_lines(&l);
  drop_lines(&other);
  free(f.values);
}

static void polygons_of_no_use_give_nothing_or_are_refused(void)
{
  const chi_grid_view grid = image_of(9, 8, 7);
  fields f = make_fields(&grid, mixed_waves);
  const double points[6][2] = { { 0.1, 0.2 }, { 0.1, 0.2 }, { 0.5, 0.3 }, { 0.5, 0.3 },
    { 0.5, 0.3 }, { 0.2, 0.6 } };
  lines l = make_line(6, points);
  chi_fiber_params params = params_of(&f, &l);
  surface s = surface_of(&grid, &params);
  CHECK(s.sizes.segments == 2 && s.sizes.empty_segments == 3 && s.sizes.triangles > 0);
  for (size_t t = 0; t < s.sizes.triangles; ++t)
  {
    CHECK(s.segments[t] == 1 || s.segments[t] == 4); /* those of no length keep their ids */
  }
  drop_surface(&s);
  drop_lines(&l);

  /* there and back: closed, of no area, both sides of one strip */
  const double back[3][2] = { { 0.1, 0.2 }, { 0.5, 0.3 }, { 0.1, 0.2 } };
  l = make_line(3, back);
  params.polygon = l.view;
  s = surface_of(&grid, &params);
  check_surface(&s, 8 * 7 * 6);
  CHECK(s.sizes.segments == 2 && s.sizes.triangles > 0 && s.sizes.triangles % 2 == 0);
  drop_surface(&s);
  drop_lines(&l);

  const size_t counts[4] = { 0, 1, 1, 0 };
  l = make_lines(4, counts, points);
  params.polygon = l.view;
  s = surface_of(&grid, &params);
  CHECK(s.sizes.segments == 0 && s.sizes.triangles == 0 && s.sizes.points == 0);
  drop_surface(&s);
  drop_lines(&l);
  l = make_lines(0, counts, points);
  params.polygon = l.view;
  s = surface_of(&grid, &params);
  CHECK(s.sizes.triangles == 0);
  drop_surface(&s);
  drop_lines(&l);

  chi_fiber* fiber = NULL;
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  l = make_line(5, fiber_square);
  params.polygon = l.view;
  const double wild[3] = { NAN, INFINITY, 1e101 };
  for (int k = 0; k < 3; ++k)
  {
    const double kept = l.xyz[4];
    l.xyz[4] = wild[k];
    CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_ERROR_INVALID_ARGUMENT);
    l.xyz[4] = kept;
  }
  int64_t ids[4] = { 0, 1, 9, 2 };
  params.polygon.connectivity = ids;
  params.polygon.offsets = (const int64_t[2]){ 0, 4 };
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_ERROR_INVALID_ARGUMENT);
  ids[2] = 4;
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &params) == CHI_OK);
  chi_fiber_destroy(NULL, fiber);
  drop_lines(&l);
  free(f.values);
}

static void wrong_arguments_are_refused(void)
{
  const chi_grid_view grid = image_of(9, 8, 7);
  fields f = make_fields(&grid, mixed_waves);
  lines l = make_line(5, fiber_square);
  const chi_fiber_params good = params_of(&f, &l);
  chi_fiber* fiber = NULL;
  surface s = { 0 };
  uint8_t mask[8 * 7 * 6];
  int64_t one;
  CHECK(chi_fiber_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  CHECK(write_surface(&s, NULL, fiber, &good) == CHI_ERROR_NOT_READY);
  drop_surface(&s);
  CHECK(chi_fiber_mask(NULL, fiber, mask) == CHI_ERROR_NOT_READY);
  CHECK(chi_fiber_nearest(NULL, fiber, &one) == CHI_ERROR_NOT_READY);
  CHECK(chi_fiber_attribute(NULL, fiber, &f.view, &one, 16) == CHI_ERROR_NOT_READY);
  CHECK(chi_fiber_extract(NULL, NULL, &grid, &good) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_extract(NULL, fiber, NULL, &good) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_extract(NULL, fiber, &grid, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  chi_array_view shorter = f.view, unknown = f.view;
  --shorter.count;
  unknown.type = 11;
  for (int k = 0; k < 8; ++k)
  {
    chi_fiber_params bad = good;
    bad.struct_size -= k == 0 ? 8 : 0;
    bad.fields[0] = k == 1 ? NULL : bad.fields[0];
    bad.fields[1] = k == 2 ? &shorter : k == 3 ? &unknown : bad.fields[1];
    bad.components[0] = k == 4 ? 2 : 0;
    bad.components[1] = k == 5 ? -2 : 1;
    bad.minimum_area = k == 6 ? -1 : k == 7 ? NAN : 0;
    CHECK(chi_fiber_extract(NULL, fiber, &grid, &bad) == CHI_ERROR_INVALID_ARGUMENT);
    CHECK(chi_fiber_mask(NULL, fiber, mask) == CHI_ERROR_NOT_READY);
  }
  chi_fiber_params plain = good;
  plain.no_normals = 1;
  CHECK(chi_fiber_extract(NULL, fiber, &grid, &plain) == CHI_OK);
  chi_fiber_sizes sizes;
  chi_fiber_get_sizes(fiber, &sizes);
  float* const normals = must_alloc(3 * sizes.points * sizeof *normals);
  int64_t* const ids = must_alloc(sizes.triangles * sizeof *ids);
  chi_fiber_outputs out = { .struct_size = sizeof out, .normals = normals };
  CHECK(chi_fiber_write(NULL, fiber, &out) == CHI_ERROR_INVALID_ARGUMENT);
  out.normals = NULL;
  out.component_ids = ids;
  CHECK(chi_fiber_write(NULL, fiber, &out) == CHI_ERROR_INVALID_ARGUMENT);
  out.component_ids = NULL;
  CHECK(chi_fiber_write(NULL, fiber, &out) == CHI_OK);
  out.points = normals;
  CHECK(chi_fiber_write(NULL, fiber, &out) == CHI_ERROR_INVALID_ARGUMENT); /* of no type */
  out.struct_size -= 8;
  CHECK(chi_fiber_write(NULL, fiber, &out) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_attribute(NULL, fiber, &shorter, normals, 16) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_attribute(NULL, fiber, &f.view, normals, 15) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_fiber_mask(NULL, fiber, NULL) == CHI_ERROR_INVALID_ARGUMENT);

  mesh* const m = tetrahedra_of(&grid);
  m->ids[4 * 77 + 2] = 100000;
  chi_grid_view broken = view_of(m);
  CHECK(chi_fiber_extract(NULL, fiber, &broken, &good) == CHI_ERROR_INVALID_ARGUMENT);
  chi_fiber_get_sizes(fiber, &sizes);
  CHECK(sizes.first_bad_cell == 77);
  drop_view(&broken);
  free(m);
  free(normals);
  free(ids);
  chi_fiber_destroy(NULL, fiber);
  chi_fiber_destroy(NULL, NULL);
  drop_lines(&l);
  free(f.values);
}

/* Everything that a host may do, on a grid with a list of its own and on an image. */
static chi_status try_all(const chi_exec* exec, const chi_grid_view* grid, size_t cells,
  const chi_fiber_params* params, const fields* f)
{
  chi_fiber* fiber = NULL;
  chi_status status = chi_fiber_create(exec, &fiber);
  if (status != CHI_OK)
  {
    return status;
  }
  status = chi_fiber_extract(exec, fiber, grid, params);
  surface s = { 0 };
  chi_status next = CHI_OK;
  if (status == CHI_OK)
  {
    next = write_surface(&s, exec, fiber, params);
  }
  if (status == CHI_OK && next == CHI_OK)
  {
    uint8_t* const mask = must_alloc(cells);
    next = chi_fiber_mask(exec, fiber, mask);
    free(mask);
  }
  if (status == CHI_OK && next == CHI_OK)
  {
    double* const carried = must_alloc(s.sizes.points * 2 * sizeof *carried);
    next = chi_fiber_attribute(exec, fiber, &f->view, carried, 2 * sizeof *carried);
    free(carried);
  }
  drop_surface(&s);
  chi_fiber_destroy(exec, fiber);
  return status == CHI_OK ? next : status;
}

static void every_refusal_and_every_cancellation_is_survived(void)
{
  const chi_grid_view image = image_of(9, 8, 7);
  mesh* const m = make_mixed(3, 0.3, 5);
  chi_grid_view mixed = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &mixed };
  const size_t cells[2] = { 8 * 7 * 6, m->cells };
  for (int k = 0; k < 2; ++k)
  {
    fields f = make_fields(grids[k], mixed_waves);
    lines l = make_line(5, fiber_square);
    chi_fiber_params params = params_of(&f, &l);
    params.minimum_area = 1e-9;
    int finished = 0;
    for (long at = 0; at < 200 && !finished; ++at)
    {
      chi_test_host host = { .refuse_at = at, .cancel_at = -1 };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release };
      const chi_status status = try_all(&exec, grids[k], cells[k], &params, &f);
      finished = host.allocations <= at;
      CHECK(status == (finished ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY));
      CHECK(host.live == 0);
    }
    CHECK(finished);
    finished = 0;
    for (long at = 0; at < 4000 && !finished; ++at)
    {
      chi_test_host host = { .refuse_at = -1, .cancel_at = at };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release,
        .is_cancelled = chi_test_is_cancelled };
      const chi_status status = try_all(&exec, grids[k], cells[k], &params, &f);
      finished = host.polls <= at;
      CHECK(status == (finished ? CHI_OK : CHI_ERROR_CANCELLED));
      CHECK(host.live == 0);
    }
    CHECK(finished);
    drop_lines(&l);
    free(f.values);
  }
  drop_view(&mixed);
  free(m);
}

int main(void)
{
  any_schedule_gives_the_same_bits();
  skipping_changes_nothing_and_is_counted();
  what_has_not_changed_is_kept();
  polygons_of_no_use_give_nothing_or_are_refused();
  wrong_arguments_are_refused();
  every_refusal_and_every_cancellation_is_survived();
  return chi_test_report();
}
