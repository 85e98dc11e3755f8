/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The march through the slabs.
 *
 * Light planes are too large for a core's cache, and every slab reads and writes all of them. So a
 * task takes a band of rows through a whole block of slabs. In each slab light moves by at most
 * `skew` rows; the band moves down by as much from slab to slab, and then needs, of other tasks,
 * only those that come before it: the band below in this block, and the band above in the block
 * before. Two copies of the planes are enough (theory/occlusion.md shows why no row is overwritten
 * too early).
 *
 * Tasks are handed out in the order of a diagonal sweep, by a ticket, whatever range the host's
 * parallel_for names: a task only ever waits for one that has been handed out before it, so any
 * schedule ends, a serial one included, and all give the same bits.
 */

#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>
#include <time.h>

#if defined(_WIN32)
#  include <windows.h>
#  define CHI_YIELD() SwitchToThread()
#else
#  include <sched.h>
#  define CHI_YIELD() sched_yield()
#endif

double chi_seconds(void)
{
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/*
 * Whether light in this piece of a band can still matter: some piece, so near that light gets from
 * here to there in time, has rays that are not done and something left to meet. Of bands whose last
 * block may still be running, the state of an earlier block counts, a fixed one, so that the answer
 * does not depend on the schedule.
 */
static void find_need(march* m, int64_t block, int band, uint8_t* need)
{
  const int64_t slab = block * m->block;
  const int all = !(m->skip & CHI_SKIP_UNREACHED_LIGHT) || m->frame->probes;
  int64_t rows[2];
  chi_march_band_rows(m, band, rows);
  memset(need, all, (size_t)m->light.segments);
  if (!m->light.fields)
  {
    memset(need, 0, (size_t)m->light.segments);
    return;
  }
  for (int other = 0; other < m->bands && !all; ++other)
  {
    const int64_t behind = other > band ? (other - band + m->lag - 1) / m->lag : 0;
    const int64_t known = block - 1 - behind;
    int64_t there[2];
    chi_march_band_rows(m, other, there);
    const int64_t gap_y = there[0] >= rows[1] ? there[0] - rows[1] + 1
      : rows[0] >= there[1]                   ? rows[0] - there[1] + 1
                                              : 0;
    for (int k = 0; k < m->light.segments; ++k)
    {
      const int64_t* const pending = m->last_slab[(int64_t)other * m->light.segments + k];
      int64_t last =
        known < 0 ? pending[0] : m->until[(known * m->bands + other) * m->light.segments + k];
      last = pending[1] > last ? pending[1] : last;
      if (last < slab)
      {
        continue;
      }
      /* What stands in the light planes now moves in this slab already. */
      const double reach = m->light.reach[last] - (slab > 0 ? m->light.reach[slab - 1] : 0);
      if ((double)gap_y > reach + 1)
      {
        continue;
      }
      const int spread = reach < CHI_SEGMENT * m->light.segments ? (int)(reach / CHI_SEGMENT) + 1
                                                                 : m->light.segments;
      const int first = k > spread ? k - spread : 0;
      const int end = k + spread < m->light.segments ? k + spread : m->light.segments - 1;
      memset(need + first, 1, (size_t)(end - first + 1));
    }
  }
}

/* Which pieces still have rays to follow, and how far, after the band's last slab of a block. */
static void update_live(march* m, int64_t block, int band, int64_t slab, int64_t row0, int64_t row1)
{
  const chi_scene* const s = m->scene;
  int32_t* const until = m->until + (block * m->bands + band) * m->light.segments;
  const float now = (float)((slab + 1) * s->group);
  for (int k = 0; k < m->light.segments; ++k)
  {
    until[k] = -1;
  }
  for (int64_t y = row0 * s->scale; y < row1 * s->scale && y < s->height; ++y)
  {
    uint8_t* const row = m->live_row + y * m->cells_x;
    const int32_t* const last = m->last_cell + y / CHI_CELL_HEIGHT * m->cells_x;
    const float* const transmittance = picture(m, TRANSMITTANCE, y);
    const float* const surface = m->frame->surface && (m->skip & CHI_SKIP_BEHIND_GEOMETRY)
      ? surface_row(&m->light, SURFACE, y)
      : NULL;
    for (int cx = 0; cx < m->cells_x; ++cx)
    {
      if (row[cx] != RAYS_LIVE)
      {
        continue;
      }
      const int x0 = cx * CHI_CELL_WIDTH, left = s->width - x0;
      const float end = m->kernels->farthest(transmittance + x0, surface ? surface + x0 : NULL,
        m->sample.saturated, left < CHI_CELL_WIDTH ? left : CHI_CELL_WIDTH);
      row[cx] = end > now ? RAYS_LIVE : end > -INFINITY ? RAYS_BEHIND_GEOMETRY : RAYS_SATURATED;
      if (end > now)
      {
        const double behind = (double)end / (double)s->group;
        const int32_t to = behind < (double)last[cx] ? (int32_t)behind : last[cx];
        int32_t* const known = until + x0 / s->scale / CHI_SEGMENT;
        *known = to > *known ? to : *known;
      }
    }
  }
}

/* One slab's light for a band of rows, and what receives it. */
static void light_band(
  march* m, int64_t slab, const int64_t rows[2], const uint8_t* need, light_counts* counts)
{
  chi_light_band(&m->light, slab, rows, need, counts);
  for (int64_t y = rows[0]; y < rows[1] && m->frame->surface; ++y)
  {
    chi_march_light_surfaces(m, slab, y);
  }
  for (int64_t y = rows[0]; y < rows[1] && m->layers; ++y)
  {
    chi_layers_light(m, slab, y);
  }
  chi_march_read_probes(m, slab, rows[0], rows[1]);
}

static void run_task(march* m, int64_t block, int band)
{
  const chi_scene* const s = m->scene;
  uint8_t* const need = m->need + (int64_t)band * m->light.segments;
  chi_sample_row row = { .frame = &m->sample };
  light_counts counts = { 0, 0, 0 };
  double seconds[2] = { 0, 0 };
  find_need(m, block, band, need);
  int64_t slab = block * m->block, row0 = 0, row1 = 0;
  const int64_t end = slab + m->block < s->slabs ? slab + m->block : s->slabs;
  for (int64_t j = 0; slab < end; ++slab, ++j)
  {
    row0 = (int64_t)band * BAND - (int64_t)m->light.skew * j;
    row1 = row0 + BAND;
    row0 = row0 > 0 ? row0 : 0;
    row1 = row1 < s->light_height ? row1 : s->light_height;
    if (row0 >= row1)
    {
      continue;
    }
    const double t0 = chi_seconds();
    memset(
      m->light.tau_flag + row0 * m->light.segments, 0, (size_t)((row1 - row0) * m->light.segments));
    const int has_samples = slab >= s->volume_begin && slab < s->volume_end;
    for (int64_t y = row0 * s->scale; has_samples && y < row1 * s->scale && y < s->height; ++y)
    {
      for (int c = 0; c < 3; ++c)
      {
        row.color[c] = picture(m, RED + c, y);
      }
      row.transmittance = picture(m, TRANSMITTANCE, y);
      row.table_position = picture(m, TABLE_POSITION, y);
      row.sum = (int32_t*)(void*)picture(m, SUM, y);
      row.rest = picture(m, REST, y);
      row.tau = tau_row(&m->light, slab, y);
      chi_march_sample_row(m, slab, y, band, &row);
    }
    const double t1 = chi_seconds();
    seconds[0] += t1 - t0;
    if (!m->light.fields)
    {
      chi_march_read_probes(m, slab, row0, row1);
      continue;
    }
    const int64_t rows[2] = { row0, row1 };
    light_band(m, slab, rows, need, &counts);
    seconds[1] += chi_seconds() - t1;
  }
  if (row0 < row1)
  {
    update_live(m, block, band, slab - 1, row0, row1);
  }
  atomic_fetch_add(&m->samples, row.taken);
  atomic_fetch_add(&m->light_updates, counts.updates);
  atomic_fetch_add(&m->skipped[SKIPPED_BRICKS], row.spared[CHI_SPARED_EMPTY]);
  atomic_fetch_add(&m->skipped[SKIPPED_SATURATED_RAYS], row.spared[CHI_SPARED_SATURATED]);
  atomic_fetch_add(&m->skipped[SKIPPED_BEHIND_GEOMETRY], row.spared[CHI_SPARED_HIDDEN]);
  atomic_fetch_add(&m->skipped[SKIPPED_SATURATED_LIGHT], counts.uniform);
  atomic_fetch_add(&m->skipped[SKIPPED_UNREACHED_LIGHT], counts.unreached);
  atomic_fetch_add(&m->nanoseconds[0], (long long)(1e9 * seconds[0]));
  atomic_fetch_add(&m->nanoseconds[1], (long long)(1e9 * seconds[1]));
}

static void wait_for(march* m, int64_t block, int band)
{
  if (block < 0 || band < 0)
  {
    return;
  }
  band = band < m->bands ? band : m->bands - 1;
  atomic_uchar* const flag = m->done + block * m->bands + band;
  for (int spins = 0; !atomic_load_explicit(flag, memory_order_acquire); ++spins)
  {
    if (spins > 256)
    {
      CHI_YIELD();
    }
  }
}

static void run_tickets(void* data, size_t begin, size_t end)
{
  march* const m = (march*)data;
  for (size_t i = begin; i < end; ++i)
  {
    const size_t ticket = atomic_fetch_add(&m->ticket, 1);
    const int64_t block = m->order[2 * ticket];
    const int band = (int)m->order[2 * ticket + 1];
    wait_for(m, block, band - 1);
    wait_for(m, block - 1, band + m->lag);
    if (!atomic_load(&m->cancelled))
    {
      if (chi_is_cancelled(m->exec))
      {
        atomic_store(&m->cancelled, 1);
      }
      else
      {
        run_task(m, block, band);
      }
    }
    atomic_store_explicit(m->done + block * m->bands + band, 1, memory_order_release);
  }
}

/* Values a pixel of the visibility that is handed out. */
static size_t colors_of(const march* m)
{
  return m->scene->channels > 1 ? 3 : 1;
}

static void store_rows(void* data, size_t begin, size_t end)
{
  const march* const m = ((march* const*)data)[0];
  float* const rgba = ((float* const*)data)[1];
  float* const visibility = ((float* const*)data)[2];
  const size_t width = (size_t)m->scene->width;
  for (size_t y = begin; y < end; ++y)
  {
    const float* const transmittance = picture(m, TRANSMITTANCE, (int64_t)y);
    for (int c = 0; c < 3; ++c)
    {
      const float* const color = picture(m, RED + c, (int64_t)y);
      for (size_t x = 0; x < width; ++x)
      {
        rgba[4 * (y * width + x) + (size_t)c] = color[x];
      }
    }
    for (size_t x = 0; x < width; ++x)
    {
      rgba[4 * (y * width + x) + 3] = 1 - transmittance[x];
    }
    const size_t colors = colors_of(m);
    if (!m->frame->surface)
    {
      chi_fill_ones(visibility + colors * y * width, (int)(colors * width));
    }
    for (size_t c = 0; c < colors && colors > 1 && m->frame->surface; ++c)
    {
      const float* const seen = surface_visibility(m, m->scene->channel_of[c], (int64_t)y);
      for (size_t x = 0; x < width; ++x)
      {
        visibility[colors * (y * width + x) + c] = seen[x];
      }
    }
  }
}

/* Behind the colours of all pixels, where there are three, lies their mean. */
static void finish_visibility(void* data, size_t begin, size_t end)
{
  const march* const m = ((march* const*)data)[0];
  float* const visibility = ((float* const*)data)[1];
  const size_t width = (size_t)m->scene->width, colors = colors_of(m);
  float* const mean = visibility + colors * width * (size_t)m->scene->height;
  for (size_t i = begin * width; i < end * width; ++i)
  {
    float* const v = visibility + colors * i;
    for (size_t c = 0; c < colors; ++c)
    {
      v[c] = 1 - m->strength * (1 - v[c]);
    }
    if (colors == 3)
    {
      mean[i] = (v[0] + v[1] + v[2]) / 3;
    }
  }
}

chi_status chi_march_run(const chi_exec* exec, chi_march* keep, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* frame, float* rgba, float* visibility, chi_march_result* result)
{
  march m = { .exec = exec,
    .scene = scene,
    .frame = frame,
    .kernels = chi_kernels(),
    .keep = keep,
    .light = { .exec = exec,
      .scene = scene,
      .params = frame->params,
      .kernels = chi_kernels(),
      .skip = chi_skip_kinds(frame->params),
      .surfaces = frame->surface ? rgba : NULL },
    .seen = visibility,
    .bricks = bricks,
    .classification = classification,
    .layers = chi_layers_count(frame),
    .skip = chi_skip_kinds(frame->params),
    .strength = (float)frame->params->strength,
    .shaded = frame->params->strength > 0 };
  const double t0 = chi_seconds();
  chi_status status = chi_march_plan(&m);
  if (status == CHI_OK && frame->volume)
  {
    status = chi_for(exec, (size_t)scene->height, chi_march_intersect_rows, &m);
  }
  if (status == CHI_OK && frame->surface)
  {
    status = chi_surface_intervals(exec, scene, frame->surface, frame->params->geometry_thickness,
      GEOMETRY_PLANES * m.light.stride, m.light.stride, surface_row(&m.light, SURFACE, 0),
      surface_row(&m.light, RECEIVER, 0), surface_row(&m.light, BLOCK_BEGIN, 0),
      surface_row(&m.light, BLOCK_END, 0));
    if (status == CHI_OK)
    {
      status = chi_for(exec, (size_t)scene->light_height, chi_light_touch_rows, &m.light);
    }
  }
  if (status == CHI_OK && m.layers)
  {
    status = chi_layers_plan(&m);
  }
  if (status == CHI_OK && m.blocks > 0)
  {
    status = chi_for(exec, (size_t)(m.blocks * m.cells_y), chi_march_classify_blocks, &m);
  }
  const double t1 = chi_seconds();
  result->seconds_visible_set = t1 - t0;
  if (status == CHI_OK && m.blocks > 0)
  {
    chi_march_last_cells(&m);
    for (int band = 0; band < m.bands; ++band)
    {
      for (int k = 0; k < m.light.segments; ++k)
      {
        chi_march_last_slab(&m, band, k, m.last_slab[band * m.light.segments + k]);
      }
    }
    status = chi_for(exec, (size_t)(m.blocks * m.bands), run_tickets, &m);
  }
  if (status == CHI_OK && frame->surface)
  {
    status = chi_for(exec, (size_t)scene->height, chi_march_light_rest, &m);
  }
  if (status == CHI_OK && m.layers)
  {
    status = chi_for(exec, (size_t)scene->height, chi_layers_light_rest, &m);
  }
  if (status == CHI_OK && m.layers)
  {
    status = chi_for(exec, (size_t)scene->height, chi_layers_finish, &m);
  }
  if (status == CHI_OK)
  {
    chi_march_read_last_probes(&m);
  }
  if (status == CHI_OK && rgba)
  {
    void* outputs[3] = { &m, rgba, visibility };
    status = chi_for(exec, (size_t)scene->height, store_rows, outputs);
  }
  const int receives = frame->surface && m.shaded;
  if (status == CHI_OK && receives)
  {
    status = chi_vicinity(exec, scene, frame->surface, frame->params, visibility, colors_of(&m));
  }
  if (status == CHI_OK && (receives || colors_of(&m) == 3))
  {
    void* outputs[2] = { &m, visibility };
    status = chi_for(exec, (size_t)scene->height, finish_visibility, outputs);
  }
  result->seconds_slices = chi_seconds() - t1;
  result->samples = m.samples;
  for (int k = 0; k < CHI_SKIP_KINDS; ++k)
  {
    result->skipped[k] = m.skipped[k];
  }
  result->skipped[SKIPPED_CLIPPED] +=
    scene->clipped_slabs * scene->group * scene->width * scene->height;
  result->skipped_samples = result->skipped[SKIPPED_BRICKS] +
    result->skipped[SKIPPED_SATURATED_RAYS] + result->skipped[SKIPPED_BEHIND_GEOMETRY];
  result->light_updates = m.light_updates;
  result->skipped_light_updates =
    result->skipped[SKIPPED_SATURATED_LIGHT] + result->skipped[SKIPPED_UNREACHED_LIGHT];
  result->light_bytes = (int64_t)m.light.bytes;
  result->seconds_samples = 1e-9 * (double)m.nanoseconds[0];
  result->seconds_light = 1e-9 * (double)m.nanoseconds[1];
  return status;
}

void chi_march_free(const chi_exec* exec, chi_march* keep)
{
  chi_buffer* const all[] = { &keep->planes, &keep->cells, &keep->last_cell, &keep->last_slab,
    &keep->until, &keep->need, &keep->live_row, &keep->sampled, &keep->done, &keep->order,
    &keep->band_rows, &keep->layers, &keep->layer_flags, &keep->tint };
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
  {
    chi_buffer_free(exec, all[i]);
  }
  chi_light_free(exec, &keep->light);
}
