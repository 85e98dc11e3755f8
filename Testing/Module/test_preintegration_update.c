/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Tables as they are made: when they are, by which method, for hosts that refuse, cancel and
 * schedule as they like. */

#include "preintegration_fixture.h"

static void what_is_not_finite_or_out_of_range_is_refused(void)
{
  fixture* const f = make_fixture(5, CHI_PREINTEGRATION_NONE);
  fill_kind(f, RANDOM);
  update(f);
  const float(*const color)[4] = f->tables.color;
  const uint64_t version = f->tables.version;
  const fixture whole = *f;
#define REFUSED(change)                                                                            \
  do                                                                                               \
  {                                                                                                \
    change;                                                                                        \
    ++f->transfer.version;                                                                         \
    CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &f->params) ==                  \
      CHI_ERROR_INVALID_ARGUMENT);                                                                 \
    *f = whole;                                                                                    \
  } while (0)
  REFUSED(f->rgb[3][1] = NAN);
  REFUSED(f->opacity[4] = NAN);
  REFUSED(f->opacity[0] = INFINITY);
  REFUSED(f->transfer.count = 1);
  REFUSED(f->transfer.count = 65537);
  REFUSED(f->transfer.rgb = NULL);
  REFUSED(f->transfer.opacity = NULL);
  REFUSED(f->transfer.range[1] = 0);
  REFUSED(f->transfer.range[0] = NAN);
  REFUSED(f->transfer.range[1] = INFINITY);
  REFUSED(f->transfer.unit_distance = 0);
  REFUSED(f->transfer.unit_distance = 1e-300);
  REFUSED(f->transfer.unit_distance = INFINITY);
  REFUSED(f->transfer.table_count = 2);
  REFUSED(f->transfer.plane = f->opacity);
  REFUSED(f->params.method = 4);
  REFUSED(f->params.method = -1);
  REFUSED(f->params.opacity_convention = 2);
  REFUSED(f->params.longest_segment = -1);
  REFUSED(f->params.segment_range = NAN);
  REFUSED(f->params.full_scalars = 3);
  REFUSED(f->params.full_scalars = 513);
  REFUSED(f->params.full_depths = 3);
  REFUSED(f->params.full_depths = 65);
  REFUSED((f->params.full_scalars = 512, f->params.full_depths = 17)); /* 68 MiB */
  REFUSED(f->params.struct_size = 8);
  REFUSED(f->transfer.struct_size = 8);
#undef REFUSED
  CHECK(chi_preintegration_update(NULL, NULL, &f->transfer, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_preintegration_update(NULL, f->handle, NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_preintegration_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  chi_preintegration_get_tables(f->handle, &f->tables);
  CHECK(f->tables.color == color && f->tables.version == version); /* they stand */
  const float x = 0;
  float rgba[4];
  CHECK(chi_segment_evaluate(&f->tables, 0, NULL, NULL, NULL, NULL) == CHI_OK);
  CHECK(chi_segment_evaluate(&f->tables, 1, &x, &x, NULL, rgba) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_segment_evaluate(NULL, 1, &x, &x, &x, rgba) == CHI_ERROR_INVALID_ARGUMENT);
  f->tables.method = 0;
  CHECK(chi_segment_evaluate(&f->tables, 1, &x, &x, &x, rgba) == CHI_ERROR_INVALID_ARGUMENT);
  free_fixture(f);
  chi_preintegration* empty = NULL;
  CHECK(chi_preintegration_create(NULL, &empty) == CHI_OK);
  chi_segment_tables none;
  chi_preintegration_get_tables(empty, &none);
  CHECK(none.count == 0 && none.color == NULL);
  CHECK(chi_segment_evaluate(&none, 1, &x, &x, &x, rgba) == CHI_ERROR_NOT_READY);
  chi_preintegration_destroy(NULL, empty);
  chi_preintegration_destroy(NULL, NULL);
}

static void tables_are_kept_where_nothing_changes(void)
{
  fixture* const f = make_fixture(40, CHI_PREINTEGRATION_FULL);
  fill_kind(f, SMOOTH);
  update(f);
  uint64_t version = f->tables.version;
  const float first = f->tables.full[7][0];
  ((float(*)[4])f->tables.full)[7][0] = 77; /* stays, if nothing is made anew */
  CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &f->params) == CHI_OK);
  chi_preintegration_get_tables(f->handle, &f->tables);
  CHECK(f->tables.version == version && f->tables.full[7][0] == 77);
#define CHANGES(change)                                                                            \
  do                                                                                               \
  {                                                                                                \
    change;                                                                                        \
    CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &f->params) == CHI_OK);         \
    chi_preintegration_get_tables(f->handle, &f->tables);                                          \
    CHECK(f->tables.version != version);                                                           \
    version = f->tables.version;                                                                   \
  } while (0)
  CHANGES(++f->transfer.version);
  CHECK(f->tables.full[7][0] == first);
  CHANGES(f->transfer.unit_distance = 2);
  CHANGES(f->transfer.range[1] = 50);
  CHANGES(f->params.opacity_convention = CHI_OPACITY_IMAGE);
  CHANGES(f->params.longest_segment = 2);
  CHANGES(f->params.segment_range = 2);
  CHANGES((f->params.full_scalars = 4, f->params.full_depths = 4));
  CHECK(f->tables.full_size[0] == 4 && f->tables.full_size[1] == 4 && f->tables.full_size[2] == 4);
  CHANGES((f->params.full_scalars = 512, f->params.full_depths = 16)); /* 64 MiB */
  CHANGES(f->params.method = CHI_PREINTEGRATION_NONE);
  CHECK(f->tables.full == NULL);
  CHANGES(f->params.method = CHI_PREINTEGRATION_PARTIAL);
  CHANGES(f->transfer.count = 30);
#undef CHANGES
  free_fixture(f);
}

static int choose(fixture* f, double range, double length)
{
  f->params.segment_range = range;
  f->params.longest_segment = length;
  update(f);
  return f->tables.method;
}

static void auto_is_full_where_the_function_bends_within_a_cell(void)
{
  fixture* const f = make_fixture(1024, CHI_PREINTEGRATION_AUTO);
  fill_constant(f, 1, 0, 0, 0.5f);
  CHECK(choose(f, 0, 0) == CHI_PREINTEGRATION_PARTIAL);
  CHECK(choose(f, 1000, 100) == CHI_PREINTEGRATION_PARTIAL);
  for (int i = 0; i < 1024; ++i) /* as linear as can be, whatever the range */
  {
    f->opacity[i] = (float)i / 1023;
  }
  CHECK(choose(f, 1000, 100) == CHI_PREINTEGRATION_PARTIAL);
  fill_kind(f, PEAK);
  CHECK(choose(f, 64, 1) == CHI_PREINTEGRATION_FULL);
  CHECK(choose(f, 0.5, 0.1) == CHI_PREINTEGRATION_PARTIAL); /* narrower than an entry */
  CHECK(choose(f, 64, 1e-3) == CHI_PREINTEGRATION_PARTIAL); /* as good as transparent */
  fill_kind(f, STEP);
  CHECK(choose(f, 64, 1) == CHI_PREINTEGRATION_FULL);
  CHECK(choose(f, 0.5, 1) == CHI_PREINTEGRATION_FULL); /* from 0 to 1 in one entry */
  fill_kind(f, SMOOTH);
  CHECK(choose(f, 16, 0.5) == CHI_PREINTEGRATION_PARTIAL);
  CHECK(choose(f, 512, 4) == CHI_PREINTEGRATION_FULL);
  free_fixture(f);
}

/* What AUTO takes for good is: whole segments of that range and length, anywhere. */
static void auto_keeps_its_word(void)
{
  static const double length[] = { 0.01, 0.1, 1, 10 }, range[] = { 0.4, 3, 20, 100 };
  int partial = 0;
  for (int kind = SMOOTH; kind <= RANDOM; ++kind)
  {
    for (int i = 0; i < 16; ++i)
    {
      fixture* const f = make_fixture(256, CHI_PREINTEGRATION_AUTO);
      fill_kind(f, kind);
      if (choose(f, range[i & 3], length[i >> 2]) == CHI_PREINTEGRATION_PARTIAL)
      {
        ++partial;
        const segment_entries e = { f->tables.color, 256 };
        double most = 0;
        for (float x = 0; x < 255; x += 0.17f)
        {
          const float x1 = (float)fmin((double)x + range[i & 3], 255), l = (float)length[i >> 2];
          float rgba[4];
          double expected[4];
          one(f, x, x1, l, rgba);
          segment_integrate(&e, (double)x, (double)x1, (double)l, expected);
          for (int c = 0; c < 4; ++c)
          {
            most = fmax(most, fabs((double)rgba[c] - expected[c]));
          }
        }
        /* The criterion is of segments without attenuation, that end or have their middle at
         * entries: for a factor of 2.
         */
        CHECK(most < 1.0 / 255);
      }
      free_fixture(f);
    }
  }
  CHECK(partial > 10);
}

static void any_number_of_entries_has_a_full_table(void)
{
  double worst[RANDOM + 1] = { 0 };
  static const size_t counts[] = { 2, 3, 17, 256, 257, 1000, 65536 };
  for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k)
  {
    for (int kind = SMOOTH; kind <= RANDOM; ++kind)
    {
      fixture* const f = make_fixture(counts[k], CHI_PREINTEGRATION_FULL);
      fill_kind(f, kind);
      update(f);
      const size_t n = counts[k];
      CHECK(f->tables.depth[0][3] == 0);
      CHECK(f->tables.depth[n - 1][3] == (float)(f->tables.full_size[0] - 1));
      CHECK(f->tables.depth[n][3] == f->tables.depth[n - 1][3]);
      int rising = 1;
      for (size_t i = 1; i < n; ++i)
      {
        rising &= f->tables.depth[i][3] > f->tables.depth[i - 1][3];
      }
      CHECK(rising);
      int inside = 1;
      const size_t entries = (size_t)f->tables.full_size[0] * (size_t)f->tables.full_size[1] *
        (size_t)f->tables.full_size[2];
      for (size_t i = 0; i < entries; ++i)
      {
        const float* const c = f->tables.full[i];
        inside &= c[0] >= 0 && c[0] <= 1 && c[1] >= 0 && c[1] <= 1 && c[2] >= 0 && c[2] <= 1;
      }
      CHECK(inside);
      const segment_entries e = { f->tables.color, (int)n };
      uint32_t seed = 8;
      double most = 0;
      for (int i = 0; i < 60; ++i)
      {
        const float x0 = (float)(chi_test_random(&seed) * (double)(n - 1));
        const float x1 = (float)(chi_test_random(&seed) * (double)(n - 1));
        const float length = (float)exp(7 * chi_test_random(&seed) - 4);
        float rgba[4];
        double expected[4];
        one(f, x0, x1, length, rgba);
        segment_integrate(&e, (double)x0, (double)x1, (double)length, expected);
        for (int c = 0; c < 4; ++c)
        {
          most = fmax(most, fabs((double)rgba[c] - expected[c]));
        }
      }
      worst[kind] = fmax(worst[kind], 255 * most);
      /* 0.19 and 25 were measured: noise of each entry does not fit into 128 places. */
      CHECK(most < (kind == RANDOM ? 50.0 : 0.4) / 255);
      free_fixture(f);
    }
  }
  for (int kind = SMOOTH; kind <= RANDOM; ++kind)
  {
    printf("full, one segment, %s: %.3g of 255\n", kind_name[kind], worst[kind]);
  }
}

static void nothing_and_walls_are_defined(void)
{
  fixture* const f = make_fixture(300, CHI_PREINTEGRATION_FULL);
  fill_constant(f, 1, 0.5f, 0.25f, 0);
  update(f);
  float rgba[4];
  one(f, 10, 200, 5, rgba);
  CHECK(rgba[0] == 0 && rgba[1] == 0 && rgba[2] == 0 && rgba[3] == 0);
  f->opacity[100] = 1e-30f; /* next to nothing in the middle of nothing */
  update(f);
  one(f, 10, 200, 5, rgba);
  CHECK(rgba[3] >= 0 && rgba[3] < 1e-20f && rgba[0] >= 0 && rgba[0] < 1e-20f);
  fill_constant(f, 1, 0.5f, 0.25f, 1);
  f->transfer.unit_distance = 1e-15;
  update(f);
  one(f, 10, 200, 5, rgba);
  CHECK(rgba[0] == 1 && rgba[1] == 0.5f && rgba[2] == 0.25f && rgba[3] == 1);
  one(f, 10, 10, 0, rgba);
  CHECK(rgba[0] == 0 && rgba[3] == 0);
  free_fixture(f);
}

static void any_schedule_gives_the_same_bits(void)
{
  fixture* const f = make_fixture(700, CHI_PREINTEGRATION_FULL);
  fixture* const g = make_fixture(700, CHI_PREINTEGRATION_FULL);
  fill_kind(f, PEAK);
  fill_kind(g, PEAK);
  update(f);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  CHECK(chi_preintegration_update(&backwards, g->handle, &g->transfer, &g->params) == CHI_OK);
  chi_preintegration_get_tables(g->handle, &g->tables);
  const chi_segment_tables *const a = &f->tables, *const b = &g->tables;
  CHECK(memcmp(a->color, b->color, 701 * sizeof *a->color) == 0);
  CHECK(memcmp(a->depth, b->depth, 701 * sizeof *a->depth) == 0);
  CHECK(memcmp(a->psi, b->psi, CHI_PSI_SIZE * CHI_PSI_SIZE * sizeof *a->psi) == 0);
  const size_t entries =
    (size_t)a->full_size[0] * (size_t)a->full_size[1] * (size_t)a->full_size[2];
  CHECK(memcmp(a->full, b->full, entries * sizeof *a->full) == 0);
  free_fixture(f);
  free_fixture(g);
}

static void hostile_hosts_lose_the_tables_and_nothing_else(void)
{
  fixture* const f = make_fixture(300, CHI_PREINTEGRATION_AUTO);
  fill_kind(f, BOXES); /* for which AUTO is full */
  const float x0 = 20, x1 = 250, length = 1;
  float rgba[4];
  int refused = 0, cancelled = 0;
  for (long k = 0; k < 400; ++k)
  {
    const int cancel = k >= 12;
    chi_test_host host = { .refuse_at = cancel ? -1 : k, .cancel_at = cancel ? k - 12 : 1L << 40 };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release,
      .is_cancelled = chi_test_is_cancelled };
    chi_preintegration* p = NULL;
    chi_status status = chi_preintegration_create(&exec, &p);
    if (status == CHI_OK)
    {
      status = chi_preintegration_update(&exec, p, &f->transfer, &f->params);
      chi_segment_tables t;
      chi_preintegration_get_tables(p, &t);
      CHECK(status == CHI_OK || (t.count == 0 && t.full == NULL && t.color == NULL));
      CHECK(chi_segment_evaluate(&t, 1, &x0, &x1, &length, rgba) ==
        (status == CHI_OK ? CHI_OK : CHI_ERROR_NOT_READY));
      host.refuse_at = -1; /* and is friendly from here on */
      host.cancel_at = 1L << 40;
      CHECK(chi_preintegration_update(&exec, p, &f->transfer, &f->params) == CHI_OK);
      chi_preintegration_get_tables(p, &t);
      CHECK(t.count == 300 && t.full != NULL);
    }
    refused += status == CHI_ERROR_OUT_OF_MEMORY;
    cancelled += status == CHI_ERROR_CANCELLED;
    CHECK(status == CHI_OK || status == CHI_ERROR_OUT_OF_MEMORY || status == CHI_ERROR_CANCELLED);
    chi_preintegration_destroy(&exec, p);
    CHECK(host.live == 0);
    k += cancel ? 20 : 0; /* polls are many */
  }
  CHECK(refused == 9 && cancelled > 8); /* the handle, three tables, five of scratch */
  free_fixture(f);
}

static void kept_tables_ask_for_no_memory(void)
{
  fixture* const f = make_fixture(300, CHI_PREINTEGRATION_FULL);
  chi_test_host host = { .refuse_at = -1, .cancel_at = 1L << 40 };
  const chi_exec exec = {
    .struct_size = sizeof exec, .user = &host, .alloc = chi_test_alloc, .release = chi_test_release
  };
  chi_preintegration* p = NULL;
  CHECK(chi_preintegration_create(&exec, &p) == CHI_OK);
  CHECK(chi_preintegration_update(&exec, p, &f->transfer, &f->params) == CHI_OK);
  const long before = host.allocations;
  CHECK(chi_preintegration_update(&exec, p, &f->transfer, &f->params) == CHI_OK);
  CHECK(host.allocations == before);
  chi_preintegration_destroy(&exec, p);
  CHECK(host.live == 0);
  free_fixture(f);
}

static void callers_of_other_versions_are_understood(void)
{
  fixture* const f = make_fixture(20, CHI_PREINTEGRATION_PARTIAL);
  fill_kind(f, SMOOTH);
  /* The transfer function's first version, in memory of its size. */
  const size_t size = offsetof(chi_transfer_view, gradient_opacity);
  void* const older = malloc(size);
  memcpy(older, &f->transfer, size);
  memcpy(older, &size, sizeof size);
  CHECK(chi_preintegration_update(NULL, f->handle, (const chi_transfer_view*)older, &f->params) ==
    CHI_OK);
  free(older);
  struct
  {
    chi_preintegration_params params;
    size_t more;
  } newer = { f->params, 0 };
  newer.params.struct_size = sizeof newer;
  ++f->transfer.version;
  CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &newer.params) == CHI_OK);
  newer.more = 1;
  CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &newer.params) ==
    CHI_ERROR_INVALID_ARGUMENT);
  free_fixture(f);
}

int main(void)
{
  what_is_not_finite_or_out_of_range_is_refused();
  tables_are_kept_where_nothing_changes();
  auto_is_full_where_the_function_bends_within_a_cell();
  auto_keeps_its_word();
  any_number_of_entries_has_a_full_table();
  nothing_and_walls_are_defined();
  any_schedule_gives_the_same_bits();
  hostile_hosts_lose_the_tables_and_nothing_else();
  kept_tables_ask_for_no_memory();
  callers_of_other_versions_are_understood();
  return chi_test_report();
}
