/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous scatterplots on other hosts, with other types, weights and cells, and with nonsense.
 */

#include "scatterplot_scene.h"

#include "grid_lattice.h"

#include <pthread.h>

static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };

static void bent(const double x[3], double value[2])
{
  value[0] = x[0] + 0.3 * x[1] * x[2];
  value[1] = x[1] * x[1] + 0.1 * x[0] + 0.2 * x[2];
}

static void steps(const double x[3], double value[2]) /* constant in half of the cube */
{
  value[0] = x[2] < 0.5 ? 0 : x[2];
  value[1] = x[2] < 0.5 ? 1 : x[0];
}

/* ---- hosts */

typedef struct thread_host
{
  int threads;
  chi_range_fn body;
  void* data;
  size_t count;
  int next;
  pthread_mutex_t lock;
} thread_host;

static void* work(void* at)
{
  thread_host* const h = (thread_host*)at;
  for (;;)
  {
    pthread_mutex_lock(&h->lock);
    const size_t i = (size_t)h->next++;
    pthread_mutex_unlock(&h->lock);
    if (i >= h->count)
    {
      return NULL;
    }
    h->body(h->data, i, i + 1);
  }
}

static void on_threads(void* user, size_t count, chi_range_fn body, void* data)
{
  thread_host* const h = (thread_host*)user;
  pthread_t thread[8];
  h->body = body;
  h->data = data;
  h->count = count;
  h->next = 0;
  pthread_mutex_init(&h->lock, NULL);
  for (int i = 0; i < h->threads; ++i)
  {
    CHECK(pthread_create(thread + i, NULL, work, h) == 0);
  }
  for (int i = 0; i < h->threads; ++i)
  {
    pthread_join(thread[i], NULL);
  }
  pthread_mutex_destroy(&h->lock);
}

static void any_number_of_threads_gives_the_same_bits(void)
{
  for (int list = 0; list < 3; ++list)
  {
    scene* const s = scene_image((size_t[3]){ 20, 17, 19 }, zero, one, bent);
    if (list)
    {
      scene_to_list(s, list == 2 ? 9 : 0);
    }
    chi_scatterplot_params params = scene_params(60, 50, 0.1, 1.2, 0, 1.1);
    chi_scatterplot_result expected, r;
    double* const first = scene_plot(NULL, s, &params, &expected);
    CHECK(expected.is_sorted == (list == 2));
    const chi_exec backwards = { .struct_size = sizeof backwards,
      .parallel_for = chi_test_backwards };
    double* const other = scene_plot(&backwards, s, &params, &r);
    CHECK(memcmp(first, other, 60 * 50 * sizeof *first) == 0);
    free(other);
    for (int k = 0; k < 4; ++k)
    {
      thread_host host = { .threads = (int[]){ 2, 3, 4, 7 }[k] };
      const chi_exec exec = {
        .struct_size = sizeof exec, .user = &host, .parallel_for = on_threads
      };
      double* const density = scene_plot(&exec, s, &params, &r);
      CHECK(memcmp(first, density, 60 * 50 * sizeof *first) == 0);
      CHECK(r.total_mass == expected.total_mass &&
        r.mass_out_of_range == expected.mass_out_of_range &&
        r.singular_mass == expected.singular_mass);
      free(density);
    }
    free(first);
    scene_free(s);
  }
}

static void refused_memory_and_cancelling_are_told(void)
{
  for (int list = 0; list < 3; ++list)
  {
    scene* const s = scene_image((size_t[3]){ 17, 9, 9 }, zero, one, bent);
    if (list)
    {
      scene_to_list(s, 3);
    }
    chi_scatterplot_params params = scene_params(30, 20, 0, 1.3, 0, 1.3);
    params.switches = list == 2 ? CHI_SCATTERPLOT_ALWAYS_SORT : 0;
    double* const density = (double*)malloc(600 * sizeof(double));
    chi_test_host host = { .refuse_at = -1, .cancel_at = 1000000 };
    chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release,
      .is_cancelled = chi_test_is_cancelled };
    long allocations = 1, polls = 1;
    for (int k = -1; k < allocations + polls; ++k)
    {
      chi_scatterplot* plot = NULL;
      host = (chi_test_host){ .refuse_at = k < allocations ? k : -1,
        .cancel_at = k < allocations ? 1000000 : k - allocations };
      chi_status status = chi_scatterplot_create(&exec, &plot);
      if (status == CHI_OK)
      {
        status = chi_scatterplot_compute(&exec, plot, &s->input, &params, density, NULL);
        chi_scatterplot_destroy(plot);
      }
      if (k < 0)
      {
        CHECK(status == CHI_OK);
        allocations = host.allocations;
        polls = host.polls;
        CHECK(allocations > 5 && polls > 2);
      }
      else
      {
        CHECK(status == (k < allocations ? CHI_ERROR_OUT_OF_MEMORY : CHI_ERROR_CANCELLED));
      }
      CHECK(host.live == 0);
    }
    free(density);
    scene_free(s);
  }
}

static void kept_parts_change_nothing(void)
{
  scene* const s = scene_image((size_t[3]){ 12, 12, 12 }, zero, one, bent);
  scene_to_list(s, 3);
  s->grid.version = 3;
  s->input.version = 8;
  chi_scatterplot* plot = NULL;
  CHECK(chi_scatterplot_create(NULL, &plot) == CHI_OK);
  double* const density = (double*)malloc(900 * sizeof(double));
  for (int k = 0; k < 6; ++k)
  {
    chi_scatterplot_params params = scene_params(30, 20 + (size_t)k, 0, 1.0 + 0.1 * k, 0, 1);
    params.automatic_range = k == 2;
    s->input.components[1] = k == 4 ? -1 : 0; /* g is not negative */
    chi_scatterplot_result r, fresh;
    CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, &r) == CHI_OK);
    CHECK(r.is_kept == (k > 0 && k < 4));
    double* const other = scene_plot(NULL, s, &params, &fresh);
    CHECK(memcmp(density, other, 30 * params.bins[1] * sizeof *other) == 0);
    CHECK(r.total_mass == fresh.total_mass && r.cells == fresh.cells);
    free(other);
  }
  chi_scatterplot_destroy(plot);
  free(density);
  scene_free(s);
}

/* ---- short ways */

/* Largest difference of two plots, relative to the first one's largest bin. */
static double difference(const double* a, const double* b, size_t count)
{
  double peak = 0, error = 0;
  for (size_t i = 0; i < count; ++i)
  {
    peak = a[i] > peak ? a[i] : peak;
    error = fmax(error, fabs(a[i] - b[i]));
  }
  return error / peak;
}

static void short_ways_change_nothing(void)
{
  scene* const s = scene_image((size_t[3]){ 32, 24, 32 }, zero, one, steps);
  for (int window = 0; window < 2; ++window)
  {
    chi_scatterplot_params params =
      window ? scene_params(40, 40, 0.6, 0.8, 0.1, 1) : scene_params(40, 40, 0, 1, 0, 1);
    chi_scatterplot_result all, r;
    double* const expected = scene_plot(NULL, s, &params, &all);
    CHECK(window ? all.missing_pieces > 0 : all.one_bin_pieces > 0);
    for (uint32_t switches = 1; switches < 8; ++switches)
    {
      params.switches = switches;
      double* const density = scene_plot(NULL, s, &params, &r);
      CHECK(switches & CHI_SCATTERPLOT_NO_SKIP ? r.missing_pieces + r.one_bin_pieces == 0 : 1);
      CHECK(switches & CHI_SCATTERPLOT_NO_EDGES ? r.edge_simplices == 0 : 1);
      /* the bound of each way is the header's */
      CHECK_NEAR(difference(expected, density, 1600), 0, 1e-10);
      CHECK_NEAR(r.total_mass, all.total_mass, 1e-14);
      CHECK_NEAR(r.mass_out_of_range, all.mass_out_of_range, 1e-12);
      CHECK_NEAR(r.singular_mass, all.singular_mass, 1e-12);
      free(density);
    }
    free(expected);
  }
  scene_free(s);
}

/* ---- types, components, weights, associations */

static void any_type_and_component_gives_the_same_plot(void)
{
  scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
  const size_t count = s->input.fields[0].count;
  chi_scatterplot_params params = scene_params(20, 20, 0, 120, 0, 120);
  int16_t* const pairs = (int16_t*)malloc(count * 3 * sizeof *pairs);
  float* const single = (float*)malloc(count * sizeof *single);
  for (size_t i = 0; i < count; ++i)
  {
    s->f[i] = floor(90 * s->f[i]);
    s->g[i] = floor(90 * s->g[i]);
    pairs[3 * i] = 0;
    pairs[3 * i + 1] = (int16_t)s->f[i];
    pairs[3 * i + 2] = 0;
    single[i] = (float)s->g[i];
  }
  double* const expected = scene_plot(NULL, s, &params, NULL);
  s->input.fields[0] = (chi_array_view){ pairs, count, 3, 6, CHI_I16 };
  s->input.fields[1] = (chi_array_view){ single, count, 1, 4, CHI_F32 };
  for (int component = -1; component < 2; component += 2)
  {
    s->input.components[0] = component;
    double* const density = scene_plot(NULL, s, &params, NULL);
    CHECK(memcmp(expected, density, 400 * sizeof *density) == 0);
    free(density);
  }
  free(expected);
  free(pairs);
  free(single);
  scene_free(s);
}

static void weights_multiply_masses(void)
{
  scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
  const size_t points = s->input.fields[0].count, cells = s->counts.cells;
  double* const weight = (double*)malloc(points * sizeof *weight);
  chi_scatterplot_params params = scene_params(20, 20, 0, 1.4, 0, 1.4);
  chi_scatterplot_result plain, r;
  double* const expected = scene_plot(NULL, s, &params, &plain);
  for (int k = 0; k < 4; ++k)
  {
    const int signs = k >> 1;
    double sum = 0;
    for (size_t i = 0; i < points; ++i)
    {
      weight[i] = signs ? (i % 2 ? 1.5 : -1) : 3;
      sum += i < cells ? weight[i] / (double)cells : 0;
    }
    s->input.weight_association = k & 1 ? CHI_SCATTERPLOT_CELLS : CHI_SCATTERPLOT_POINTS;
    s->input.weight = (chi_array_view){ weight, k & 1 ? cells : points, 1, 8, CHI_F64 };
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK_NEAR(scene_mass_error(density, &r, 20, 20, r.total_mass), 0, 1e-12);
    if (!signs)
    {
      CHECK_NEAR(r.total_mass, 3, 1e-13);
      for (size_t i = 0; i < 400; ++i)
      {
        CHECK_NEAR(density[i], 3 * expected[i], 1e-9);
      }
    }
    else if (k & 1)
    {
      CHECK_NEAR(r.total_mass, sum, 1e-13);
    }
    free(density);
  }
  free(expected);
  free(weight);
  scene_free(s);
}

static void fields_of_cells_are_one_deposit_each(void)
{
  scene* const s = scene_image((size_t[3]){ 5, 4, 3 }, zero, one, bent);
  for (size_t i = 0; i < 60; ++i)
  {
    s->f[i] = (double)(i % 3);
    s->g[i] = (double)(i % 2);
  }
  s->input.association = CHI_SCATTERPLOT_CELLS;
  s->input.fields[0].count = s->input.fields[1].count = 60;
  const chi_scatterplot_params params = scene_params(4, 2, 0, 2, 0, 1);
  chi_scatterplot_result r;
  double* const density = scene_plot(NULL, s, &params, &r);
  for (size_t i = 0; i < 8; ++i) /* bins of area 1/4; 2 and 1 are upper ends */
  {
    CHECK_NEAR(density[i] / 4, i % 4 == 1 ? 0 : 1. / 6, 1e-15);
  }
  CHECK(r.cells == 60 && r.singular_mass == r.total_mass && r.dimension == 3);
  free(density);
  scene_free(s);
}

static void densities_beyond_double_are_infinite_not_nan(void)
{
  scene* const s = scene_image((size_t[3]){ 3, 3, 3 }, zero, one, steps);
  for (size_t i = 0; i < s->input.fields[0].count; ++i)
  {
    s->f[i] *= 1e-200;
    s->g[i] *= 1e-200;
  }
  chi_scatterplot_params params = scene_params(4, 4, 0, 0, 0, 0);
  params.automatic_range = 1;
  double* const density = scene_plot(NULL, s, &params, NULL);
  int zeros = 0, infinite = 0;
  for (int i = 0; i < 16; ++i)
  {
    zeros += density[i] == 0;
    infinite += density[i] == INFINITY;
  }
  CHECK(infinite > 0 && zeros + infinite == 16);
  free(density);
  scene_free(s);
}

/* ---- other cells */

static void meshes_of_all_cells_hold_their_volume(void)
{
  mesh* const m = make_mixed(4, 0.2, 11);
  const chi_grid_view grid = view_of(m);
  chi_grid_counts counts = { .struct_size = sizeof counts };
  CHECK(chi_grid_count(NULL, &grid, &counts) == CHI_OK);
  double* const f = (double*)malloc(m->points * sizeof *f);
  for (size_t i = 0; i < m->points; ++i)
  {
    f[i] = m->x[i][0] + 0.5 * m->x[i][2];
  }
  scene s = { .grid = grid };
  s.input = (chi_scatterplot_input){ .struct_size = sizeof s.input,
    .grid = &s.grid,
    .fields = { { f, m->points, 1, 8, CHI_F64 },
      { m->x, m->points, 3, 3 * sizeof(double), CHI_F64 } },
    .components = { 0, 1 } };
  chi_scatterplot_params params = scene_params(30, 31, 0, 0, 0, 0);
  params.automatic_range = 1;
  chi_scatterplot_result r;
  double* density = scene_plot(NULL, &s, &params, &r);
  CHECK_NEAR(r.total_mass, counts.volume, 1e-12 * counts.volume);
  CHECK_NEAR(scene_mass_error(density, &r, 30, 31, counts.volume), 0, 1e-12);
  CHECK(r.mass_out_of_range == 0 && r.simplices == counts.tetrahedra && r.cells == counts.cells);
  free(density);
  free(f);
  drop_view(&s.grid);
  free(m);
}

static void polygons_count_where_there_is_nothing_else(void)
{
  /* a plane image, and the same as quadrilaterals, pixels and a polygon that is not convex */
  for (int axis = 0; axis < 3; ++axis)
  {
    size_t n[3] = { 7, 7, 7 };
    n[axis] = 0;
    scene* const s = scene_image(n, zero, one, bent);
    const size_t count = s->input.fields[0].count;
    for (size_t i = 0; i < count; ++i)
    {
      s->f[i] = s->points[3 * i + (axis == 0)];
      s->g[i] = s->points[3 * i + (axis == 2 ? 1 : 2)];
    }
    chi_scatterplot_params params = scene_params(10, 10, 0, 1, 0, 1);
    chi_scatterplot_result r;
    double* const density = scene_plot(NULL, s, &params, &r);
    for (size_t i = 0; i < 100; ++i)
    {
      CHECK_NEAR(density[i], 1, 1e-10);
    }
    CHECK(r.dimension == 2 && r.simplices == 98 && r.mass_out_of_range == 0);
    CHECK_NEAR(r.total_mass, 1, 1e-14);
    free(density);
    scene_free(s);
  }
  mesh* const m = new_mesh();
  for (int i = 0; i < 9; ++i)
  {
    add_point(m, i % 3, i / 3, 0);
  }
  add_point(m, 4, 0, 0);
  add_cell(m, 7, 5, (const int64_t[5]){ 2, 4, 8, 6, 0 }); /* bends inwards at 4 */
  add_cell(m, 8, 4, (const int64_t[4]){ 4, 5, 7, 8 });
  add_cell(m, 3, 2, (const int64_t[2]){ 3, 4 });
  scene s = { .grid = view_of(m) };
  s.input = (chi_scatterplot_input){ .struct_size = sizeof s.input,
    .grid = &s.grid,
    .fields = { { m->x, m->points, 3, 24, CHI_F64 }, { m->x, m->points, 3, 24, CHI_F64 } },
    .components = { 0, 1 } };
  const chi_scatterplot_params params = scene_params(2, 2, 0, 2, 0, 2);
  chi_scatterplot_result r;
  double* const density = scene_plot(NULL, &s, &params, &r);
  static const double exact[4] = { 1, 0.5, 1, 1.5 };
  for (int i = 0; i < 4; ++i)
  {
    CHECK_NEAR(density[i], exact[i], 1e-12);
  }
  CHECK(r.lower_dimensional_cells == 1 && r.cells == 2);
  free(density);
  drop_view(&s.grid);
  free(m);
}

/* ---- values that are not numbers */

static void cells_at_bad_values_are_skipped_and_counted(void)
{
  for (int list = 0; list < 2; ++list)
  {
    scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
    const double bad[] = { NAN, INFINITY, -INFINITY, NAN };
    for (size_t k = 0; k < 4; ++k)
    {
      /* inner points, far apart */
      const size_t id = 2 + 2 * (k & 1) * 2 + 10 * (3 + 3 * (k >> 1)) + 100 * (2 + 2 * k);
      (k & 1 ? s->f : s->g)[id] = bad[k];
    }
    if (list)
    {
      scene_to_list(s, 0);
    }
    chi_scatterplot_params params = scene_params(20, 20, 0, 0, 0, 0);
    params.automatic_range = 1;
    chi_scatterplot_result r;
    double* const density = scene_plot(NULL, s, &params, &r);
    /* 8 cells of 729 meet at a point, or 24 of their tetrahedra */
    CHECK(r.skipped_cells == (list ? 4 * 24 : 4 * 8));
    CHECK_NEAR(r.total_mass, list ? 1 - 4 * 24 / (6 * 729.0) : 1 - 32 / 729.0, 1e-13);
    CHECK_NEAR(scene_mass_error(density, &r, 20, 20, r.total_mass), 0, 1e-12);
    CHECK(isfinite(r.range[0][0]) && isfinite(r.range[1][1]));
    free(density);
    scene_free(s);
  }
}

static void ghosts_and_blanked_cells_are_left_out(void)
{
  for (int list = 0; list < 2; ++list)
  {
    scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
    if (list)
    {
      scene_to_list(s, 0);
    }
    const size_t cells = list ? s->grid.cell_count : 729;
    uint8_t* const ghosts = (uint8_t*)calloc(cells, 1);
    ghosts[0] = CHI_GRID_DUPLICATE_CELL;
    ghosts[5] = ghosts[6] = CHI_GRID_HIDDEN_CELL;
    s->grid.cell_ghosts = ghosts;
    const chi_scatterplot_params params = scene_params(20, 20, 0, 1.5, 0, 1.5);
    chi_scatterplot_result r;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK(r.ghost_cells == 1 && r.blanked_cells == 2 && r.cells == cells - 3);
    CHECK_NEAR(r.total_mass, 1 - 3.0 / (double)cells, 1e-13);
    free(density);
    free(ghosts);
    scene_free(s);
  }
}

static void constant_fields_get_a_window(void)
{
  scene* const s = scene_image((size_t[3]){ 3, 3, 3 }, zero, one, bent);
  for (size_t i = 0; i < s->input.fields[0].count; ++i)
  {
    s->g[i] = 40;
  }
  chi_scatterplot_params params = scene_params(10, 11, 0, 0, 0, 0);
  params.automatic_range = 1;
  chi_scatterplot_result r;
  double* const density = scene_plot(NULL, s, &params, &r);
  CHECK(r.constant_fields == 2);
  CHECK_NEAR(r.range[1][1] - r.range[1][0], 40e-6, 1e-14);
  CHECK_NEAR(r.singular_mass, 1, 1e-12);
  CHECK(r.mass_out_of_range == 0);
  for (size_t i = 0; i < 110; ++i)
  {
    CHECK((density[i] > 0) == (i / 10 == 5));
  }
  free(density);
  scene_free(s);
}

/* ---- the published method */

static void the_published_method_approaches_the_exact_one(void)
{
  scene* const s = scene_image((size_t[3]){ 6, 6, 6 }, zero, one, bent);
  double before = INFINITY;
  for (size_t n = 16; n <= 256; n *= 4)
  {
    chi_scatterplot_params params = scene_params(n, n, 0, 1.4, 0, 1.4);
    double* const exact = scene_plot(NULL, s, &params, NULL);
    params.method = CHI_SCATTERPLOT_PUBLISHED;
    chi_scatterplot_result r;
    double* const published = scene_plot(NULL, s, &params, &r);
    double l1 = 0, sum = 0;
    for (size_t i = 0; i < n * n; ++i)
    {
      l1 += fabs(published[i] - exact[i]);
      sum += exact[i];
    }
    /* a linear function at the centre is its mean but where it bends: O(1/n) and better */
    CHECK(l1 / sum < before / 2);
    before = l1 / sum;
    free(exact);
    free(published);
  }
  CHECK(before < 0.01);
  scene_free(s);
}

/* ---- nonsense */

static void nonsense_is_refused(void)
{
  scene* const s = scene_image((size_t[3]){ 3, 3, 3 }, zero, one, bent);
  chi_scatterplot* plot = NULL;
  CHECK(chi_scatterplot_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_scatterplot_create(NULL, &plot) == CHI_OK);
  double density[16];
  for (int k = 0; k < 24; ++k)
  {
    chi_scatterplot_params p = scene_params(4, 4, 0, 1, 0, 1);
    chi_scatterplot_input in = s->input;
    chi_grid_view grid = s->grid;
    chi_scatterplot_reduction none = { .struct_size = sizeof none };
    in.grid = &grid;
    chi_status expected = CHI_ERROR_INVALID_ARGUMENT;
    switch (k)
    {
      case 0:
        p.bins[0] = 0;
        break;
      case 1:
        p.bins[1] = 0;
        break;
      case 2:
        p.bins[0] = 40000;
        expected = CHI_ERROR_TOO_LARGE;
        break;
      case 3:
        p.bins[0] = p.bins[1] = 32768;
        expected = CHI_ERROR_TOO_LARGE;
        break;
      case 4:
        p.range[0][1] = 0;
        break;
      case 5:
        p.range[1][0] = 2;
        break;
      case 6:
        p.range[0][0] = NAN;
        break;
      case 7:
        p.range[0][1] = INFINITY;
        break;
      case 8:
        p.method = 2;
        break;
      case 9:
        p.switches = 1 << 20;
        break;
      case 10:
        p.struct_size = 8;
        break;
      case 11:
        in.struct_size = 8;
        break;
      case 12:
        in.components[0] = 1;
        break;
      case 13:
        in.components[1] = -2;
        break;
      case 14:
        in.association = 2;
        break;
      case 15:
        in.fields[0].count = 3;
        break;
      case 16:
        in.fields[1].data = NULL;
        break;
      case 17:
        in.fields[1].type = 99;
        break;
      case 18:
        in.weight = (chi_array_view){ s->f, 5, 1, 8, CHI_F64 };
        break;
      case 19:
        in.grid = NULL;
        break;
      case 20:
        grid.kind = 9;
        break;
      case 21:
        p.reduction = &none;
        break;
      case 22:
        none.struct_size = 1;
        p.reduction = &none;
        break;
      default:
        in.weight_association = 7;
        break;
    }
    CHECK(chi_scatterplot_compute(NULL, plot, &in, &p, density, NULL) == expected);
  }
  const chi_scatterplot_params good = scene_params(4, 4, 0, 1, 0, 1);
  CHECK(chi_scatterplot_compute(NULL, NULL, &s->input, &good, density, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  CHECK(
    chi_scatterplot_compute(NULL, plot, NULL, &good, density, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, NULL, density, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &good, NULL, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &good, density, NULL) == CHI_OK);
  chi_scatterplot_destroy(plot);
  chi_scatterplot_destroy(NULL);
  scene_free(s);
}

static void broken_lists_are_refused_and_empty_ones_are_empty(void)
{
  scene* const s = scene_image((size_t[3]){ 3, 3, 3 }, zero, one, bent);
  chi_scatterplot_params params = scene_params(4, 4, 0, 1, 0, 1);
  chi_scatterplot* plot = NULL;
  chi_scatterplot_result r;
  double density[16];
  CHECK(chi_scatterplot_create(NULL, &plot) == CHI_OK);
  scene_to_list(s, 0);
  s->ids[9] = 1000;
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  s->ids[9] = 3;
  s->offsets[4] = -3;
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  s->grid.cell_count = 0;
  params.automatic_range = 1;
  CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, &r) == CHI_OK);
  CHECK(r.total_mass == 0 && r.dimension == 0 && density[0] == 0 && density[15] == 0);
  chi_scatterplot_destroy(plot);
  scene_free(s);
}

int main(void)
{
  any_number_of_threads_gives_the_same_bits();
  refused_memory_and_cancelling_are_told();
  kept_parts_change_nothing();
  short_ways_change_nothing();
  any_type_and_component_gives_the_same_plot();
  weights_multiply_masses();
  fields_of_cells_are_one_deposit_each();
  densities_beyond_double_are_infinite_not_nan();
  meshes_of_all_cells_hold_their_volume();
  polygons_count_where_there_is_nothing_else();
  cells_at_bad_values_are_skipped_and_counted();
  ghosts_and_blanked_cells_are_left_out();
  constant_fields_get_a_window();
  the_published_method_approaches_the_exact_one();
  nonsense_is_refused();
  broken_lists_are_refused_and_empty_ones_are_empty();
  return chi_test_report();
}
