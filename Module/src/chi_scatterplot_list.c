/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Lists of cells of any type in runs: their simplices side by side, edges that they share found in
 * a small table. Fields of cells have no simplices: each cell is one deposit. */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  VTK_TETRA_TYPE = 10,
  LEAST_CAPACITY = CHI_SCATTER_RUN
};

static const double largest = 1e100; /* of a coordinate, as chi_grid_count has it */

double chi_scatter_weight(const chi_scatter_job* job, size_t cell, const int64_t* ids, size_t count)
{
  const chi_scatterplot_input* const in = &job->input;
  if (!in->weight.data)
  {
    return 1;
  }
  if (in->weight_association == CHI_SCATTERPLOT_CELLS)
  {
    return chi_scatter_value(&in->weight, in->weight_component, cell);
  }
  double sum = 0;
  for (size_t k = 0; k < count; ++k)
  {
    sum += chi_scatter_value(&in->weight, in->weight_component, (size_t)ids[k]);
  }
  return sum / (double)count;
}

/* ---- a block of simplices */

/* The parts of one piece of memory; with `base` 0 only its size. */
static size_t lay_out(chi_scatter_block* b, size_t capacity, char* base)
{
  size_t at = 0;
#define PART(member, count)                                                                        \
  b->member = (void*)(base + at);                                                                  \
  at += ((count) * sizeof *b->member + 63) / 64 * 64
  PART(x, 4 * capacity + 8);
  PART(y, 4 * capacity + 8);
  PART(mass, capacity + 8);
  PART(keys, 6 * capacity);
  PART(center, capacity);
  PART(ids, 4 * capacity);
  PART(cell, capacity);
#undef PART
  return at;
}

int chi_scatter_reserve_block(chi_scatter_job* job, chi_scatter_worker* w, size_t count)
{
  chi_scatter_block* const b = &w->block;
  if (count <= b->capacity)
  {
    return 1;
  }
  const chi_exec* const exec = job->keep->has_exec ? &job->keep->exec : NULL;
  const size_t capacity = (count < LEAST_CAPACITY ? LEAST_CAPACITY : count + 7) / 8 * 8;
  size_t slots = 8;
  while (slots < 8 * capacity) /* an edge and a half a simplex, six at most */
  {
    slots *= 2;
  }
  chi_scatter_block none;
  static char nothing;
  const size_t bytes = lay_out(&none, capacity, &nothing);
  const int is_there = capacity <= SIZE_MAX / 512 &&
    chi_buffer_reserve(exec, &w->list_block, bytes, 1) &&
    chi_buffer_reserve(exec, &w->edge_block, 6 * capacity, sizeof *w->edge) &&
    chi_buffer_reserve(exec, &w->slot_block, slots, sizeof *w->slots);
  b->capacity = 0;
  if (!is_there)
  {
    job->failed = CHI_ERROR_OUT_OF_MEMORY;
    return 0;
  }
  lay_out(b, capacity, (char*)w->list_block.data);
  memset(w->list_block.data, 0, bytes); /* vectors read a little beyond what is written */
  b->capacity = capacity;
  w->edge = (chi_scatter_edge*)w->edge_block.data;
  w->slots = (uint32_t*)w->slot_block.data;
  w->slot_mask = slots - 1;
  return 1;
}

/* Six times the volume of a tetrahedron, without its sign. */
static double volume6(const double* p, const double* q, const double* r, const double* s)
{
  const double a[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
  const double b[3] = { r[0] - p[0], r[1] - p[1], r[2] - p[2] };
  const double c[3] = { s[0] - p[0], s[1] - p[1], s[2] - p[2] };
  return fabs(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]));
}

/* A tetrahedron that is a cell itself. Its mass is kept at `mass` when it is first looked at, and
 * is NaN where its points are not finite. */
static int add_tetrahedron(
  chi_scatter_job* job, chi_scatter_worker* w, size_t index, double* mass, int is_first)
{
  const chi_grid* const grid = &job->grid;
  const chi_grid_view* const v = &grid->view;
  chi_scatter_block* const b = &w->block;
  int64_t begin = 4 * (int64_t)index;
  if (!job->is_uniform)
  {
    begin = v->offsets[index];
    const int64_t end = v->offsets[index + 1];
    if (begin < 0 || end != begin + 4 || (uint64_t)end > v->connectivity_count)
    {
      return CHI_CELL_BROKEN;
    }
  }
  const int64_t* const ids = v->connectivity + begin;
  double x[4][3], reach = 0;
  for (size_t c = 0; c < 4; ++c)
  {
    if ((uint64_t)ids[c] >= grid->points)
    {
      return CHI_CELL_BROKEN;
    }
    b->ids[c * b->capacity + b->count] = (uint32_t)ids[c];
  }
  for (size_t c = 0; c < 4 && is_first; ++c)
  {
    chi_grid_point(grid, (size_t)ids[c], x[c]);
    for (int a = 0; a < 3; ++a)
    {
      const double far = fabs(x[c][a]);
      reach = far <= reach ? reach : far; /* NaN stays */
    }
  }
  if (is_first)
  {
    const double volume = reach <= largest ? volume6(x[0], x[1], x[2], x[3]) / 6 : NAN;
    *mass = volume * chi_scatter_weight(job, index, ids, 4);
  }
  if (*mass != *mass)
  {
    return CHI_CELL_NON_FINITE;
  }
  b->mass[b->count] = *mass;
  b->cell[b->count++] = (uint32_t)index;
  return CHI_CELL_GOOD;
}

/* All tetrahedra of a cell. */
static int add_cell(chi_scatter_job* job, chi_scatter_worker* w, size_t index, int is_first)
{
  const chi_grid* const grid = &job->grid;
  chi_scatter_block* const b = &w->block;
  chi_grid_cell cell;
  int found = chi_cell_read(grid, index, &cell);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  if (!chi_cell_locate(&cell))
  {
    return CHI_CELL_NON_FINITE;
  }
  chi_cell_split split;
  chi_cell_choose(&cell, &split);
  if (split.tetrahedra > b->capacity - b->count)
  {
    return CHI_CELL_UNSUPPORTED; /* the caller has made room: this cannot be */
  }
  const size_t center_id = grid->points + b->centers, first = b->count;
  if (split.way == CHI_SPLIT_CENTER)
  {
    chi_scatter_center* const center = b->center + b->centers++;
    chi_cell_find_center(&cell);
    memcpy(center->point, cell.center, sizeof center->point);
    for (int f = 0; f < 2; ++f)
    {
      double sum = 0;
      for (size_t k = 0; k < cell.count; ++k)
      {
        sum +=
          chi_scatter_value(&job->input.fields[f], job->input.components[f], (size_t)cell.ids[k]);
      }
      center->value[f] = sum / (double)cell.count;
    }
  }
  /* keys of edges are not there yet: room for what the cell writes */
  uint32_t(*const vertices)[4] = (uint32_t(*)[4])(void*)(b->keys + 2 * b->count);
  const size_t count = chi_cell_write(&cell, split.way, (uint32_t)center_id, vertices);
  const double weight = chi_scatter_weight(job, index, cell.ids, cell.count);
  for (size_t t = 0; t < count; ++t)
  {
    double x[4][3];
    for (size_t c = 0; c < 4; ++c)
    {
      const uint32_t id = vertices[t][c];
      b->ids[c * b->capacity + b->count] = id;
      if (id == center_id)
      {
        memcpy(x[c], cell.center, sizeof x[c]);
      }
      else
      {
        chi_grid_point(grid, id, x[c]);
      }
    }
    b->mass[b->count] = volume6(x[0], x[1], x[2], x[3]) / 6 * weight;
    b->cell[b->count++] = (uint32_t)index;
  }
  if (job->params.trilinear_tolerance > 0 && b->count > first)
  {
    chi_scatter_refine_cell(job, w, &cell, split.way, first, weight, is_first);
  }
  return CHI_CELL_GOOD;
}

/* Values at corners, as they are. */
static void gather(const chi_scatter_job* job, chi_scatter_block* b)
{
  double* const values[2] = { b->x, b->y };
  const size_t points = job->grid.points;
  for (int f = 0; f < 2; ++f)
  {
    for (size_t c = 0; c < 4; ++c)
    {
      const uint32_t* const ids = b->ids + c * b->capacity;
      double* const out = values[f] + c * b->capacity;
      chi_scatter_gather(
        &job->input.fields[f], job->input.components[f], ids, points, b->count, out);
      for (size_t i = 0; i < b->count && b->centers > 0; ++i)
      {
        out[i] = ids[i] >= points ? b->center[ids[i] - points].value[f] : out[i];
      }
    }
  }
}

/* Leave out cells with a value or a mass that is not finite; how many, and with `piece` what the
 * others hold. */
static void look_through(chi_scatter_block* b, int corners, chi_scatter_piece* piece)
{
  for (size_t first = 0, end; first < b->count; first = end)
  {
    double zero = 0, mass = 0, size = 0;
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
    for (end = first; end < b->count && b->cell[end] == b->cell[first]; ++end)
    {
      zero += 0 * b->mass[end];
      mass += b->mass[end];
      size += fabs(b->mass[end]);
      for (size_t c = 0; c < (size_t)corners; ++c)
      {
        const double x = b->x[c * b->capacity + end], y = b->y[c * b->capacity + end];
        zero += 0 * x + 0 * y;
        low[0] = x < low[0] ? x : low[0];
        high[0] = x > high[0] ? x : high[0];
        low[1] = y < low[1] ? y : low[1];
        high[1] = y > high[1] ? y : high[1];
      }
    }
    const int is_good = zero == 0;
    for (size_t i = first; i < end && !is_good; ++i)
    {
      b->mass[i] = NAN;
    }
    if (!piece)
    {
      continue;
    }
    piece->skipped += (uint32_t)!is_good;
    piece->cells += (uint32_t)is_good;
    piece->simplices += is_good ? (uint32_t)(end - first) : 0;
    piece->mass += is_good ? mass : 0;
    piece->size += is_good ? size : 0;
    for (int f = 0; f < 2 && is_good; ++f)
    {
      piece->low[f] = low[f] < piece->low[f] ? low[f] : piece->low[f];
      piece->high[f] = high[f] > piece->high[f] ? high[f] : piece->high[f];
    }
  }
}

/* Add a weight to the edge between two corners, which are places in the block's arrays. */
static void add_edge(chi_scatter_worker* w, size_t* count, size_t from, size_t to, double weight)
{
  const chi_scatter_block* const b = &w->block;
  const uint32_t p = b->ids[from], q = b->ids[to];
  const uint64_t key = p < q ? (uint64_t)p << 32 | q : (uint64_t)q << 32 | p;
  size_t slot = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & w->slot_mask;
  for (; w->slots[slot]; slot = (slot + 1) & w->slot_mask)
  {
    const size_t e = w->slots[slot] - 1;
    if (b->keys[e] == key)
    {
      w->edge[e].weight += weight;
      return;
    }
  }
  b->keys[*count] = key;
  w->edge[*count] = (chi_scatter_edge){ (uint32_t)from, (uint32_t)to, weight };
  w->slots[slot] = (uint32_t)++ * count;
}

static void corners_at(const chi_scatter_block* b, size_t i, double x[4], double y[4])
{
  for (size_t c = 0; c < 4; ++c)
  {
    x[c] = b->x[c * b->capacity + i];
    y[c] = b->y[c * b->capacity + i];
  }
}

static void deposit_tetrahedra(chi_scatter_job* job, chi_scatter_worker* w, const double box[4])
{
  chi_scatter_block* const b = &w->block;
  double weight[6][CHI_SCATTER_CHUNK], x[4], y[4], most = 0, edge_mass = 0;
  uint8_t kind[CHI_SCATTER_CHUNK];
  size_t edges = 0;
  memset(w->slots, 0, (w->slot_mask + 1) * sizeof *w->slots);
  if (chi_scatter_splats(job))
  {
    chi_scatter_splat_list(job, w);
  }
  for (size_t i = 0; i < b->count; ++i)
  {
    most = fabs(b->mass[i]) > most ? fabs(b->mass[i]) : most;
  }
  for (size_t first = 0; first < b->count; first += CHI_SCATTER_CHUNK)
  {
    const size_t left = b->count - first;
    const size_t count = left < CHI_SCATTER_CHUNK ? left : CHI_SCATTER_CHUNK;
    job->kernels->classify(&job->plot, b->x + first, b->y + first, b->capacity, b->mass + first,
      count, chi_scatter_light(most), weight, kind);
    for (size_t k = 0; k < count; ++k)
    {
      const size_t i = first + k;
      switch (kind[k])
      {
        case CHI_SCATTER_EDGES:
          for (size_t e = 0; e < 6; ++e)
          {
            add_edge(w, &edges, chi_scatter_ends[e][0] * b->capacity + i,
              chi_scatter_ends[e][1] * b->capacity + i, weight[e][k]);
          }
          edge_mass += b->mass[i];
          ++w->edges;
          break;
        case CHI_SCATTER_ONE_BIN:
          chi_scatter_deposit_at(job, w, b->x[i], b->y[i], b->mass[i]);
          ++w->one_bin;
          break;
        case CHI_SCATTER_SECTIONS:
          corners_at(b, i, x, y);
          chi_scatter_deposit_simplex(job, w, 4, x, y, b->mass[i]);
          break;
        default:
          break;
      }
    }
  }
  if (edges > 0)
  {
    chi_scatter_deposit_edges(job, w, b->x, b->y, edges, edge_mass, box, chi_scatter_noise(most));
  }
}

void chi_scatter_finish_block(
  chi_scatter_job* job, chi_scatter_worker* w, size_t run, chi_scatter_piece* piece)
{
  chi_scatter_block* const b = &w->block;
  const int corners = job->dimension + 1;
  if (b->count > 0)
  {
    gather(job, b);
    if (piece || job->pieces[run].skipped > 0)
    {
      look_through(b, corners, piece);
    }
  }
  if (b->count > 0 && !piece)
  {
    const chi_scatter_piece* const all = job->pieces + run;
    double box[4] = { all->low[0], all->high[0], all->low[1], all->high[1] }, x[4], y[4];
    chi_scatter_map(&job->plot, 0, box, 2);
    chi_scatter_map(&job->plot, 1, box + 2, 2);
    for (size_t c = 0; c < (size_t)corners; ++c)
    {
      chi_scatter_map(&job->plot, 0, b->x + c * b->capacity, b->count);
      chi_scatter_map(&job->plot, 1, b->y + c * b->capacity, b->count);
    }
    if (corners == 4)
    {
      deposit_tetrahedra(job, w, box);
    }
    for (size_t i = 0; i < b->count && corners == 3; ++i)
    {
      corners_at(b, i, x, y);
      if (b->mass[i] == b->mass[i])
      {
        chi_scatter_deposit_simplex(job, w, 3, x, y, b->mass[i]);
      }
    }
  }
  b->count = b->centers = 0;
}

/* ---- fields of cells */

static int volume_of(const chi_scatter_job* job, size_t index, double* volume, double* weight)
{
  if (job->dimension == 2)
  {
    return chi_scatter_measure_polygon(job, index, volume, weight);
  }
  chi_grid_cell cell;
  const int found = chi_cell_read(&job->grid, index, &cell);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  *weight = chi_scatter_weight(job, index, cell.ids, cell.count);
  if (job->grid.view.kind == CHI_GRID_IMAGE)
  {
    *volume = 6 * job->cell_volume;
    return isfinite(*volume) ? CHI_CELL_GOOD : CHI_CELL_NON_FINITE;
  }
  if (!chi_cell_locate(&cell))
  {
    return CHI_CELL_NON_FINITE;
  }
  chi_cell_split split;
  chi_cell_choose(&cell, &split);
  *volume = split.volume;
  return CHI_CELL_GOOD;
}

/* One cell with constant fields. */
static int visit_constant(
  chi_scatter_job* job, chi_scatter_worker* w, size_t index, chi_scatter_piece* piece)
{
  const chi_scatterplot_input* const in = &job->input;
  double volume = 0, weight = 1;
  const int found = volume_of(job, index, &volume, &weight);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  const double mass = volume * weight;
  double value[2];
  for (int f = 0; f < 2; ++f)
  {
    value[f] = chi_scatter_value(&in->fields[f], in->components[f], index);
  }
  if (!isfinite(mass) || !isfinite(value[0]) || !isfinite(value[1]))
  {
    return CHI_CELL_NON_FINITE;
  }
  if (!piece)
  {
    chi_scatter_map(&job->plot, 0, value, 1);
    chi_scatter_map(&job->plot, 1, value + 1, 1);
    w->sink.singular += chi_scatter_deposit_at(job, w, value[0], value[1], mass) ? mass : 0;
    ++w->one_bin;
    return found;
  }
  ++piece->cells;
  ++piece->simplices;
  piece->mass += mass;
  piece->size += fabs(mass);
  for (int f = 0; f < 2; ++f)
  {
    piece->low[f] = value[f] < piece->low[f] ? value[f] : piece->low[f];
    piece->high[f] = value[f] > piece->high[f] ? value[f] : piece->high[f];
  }
  return found;
}

/* ---- runs */

/* Simplices that a cell may add, at most. */
static size_t most_simplices(const chi_scatter_job* job, size_t index)
{
  const chi_grid_view* const v = &job->grid.view;
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    return 12;
  }
  if (v->cell_types[index] == VTK_TETRA_TYPE)
  {
    return 1;
  }
  chi_grid_cell cell;
  chi_cell_split split;
  const int found = chi_cell_read(&job->grid, index, &cell);
  if (found == CHI_CELL_FLAT_TYPE)
  {
    return cell.count + 8;
  }
  if (found != CHI_CELL_GOOD || !chi_cell_locate(&cell))
  {
    return 0;
  }
  chi_cell_choose(&cell, &split);
  return split.tetrahedra + split.collapsed;
}

static void count(chi_scatter_job* job, chi_scatter_piece* piece, int found)
{
  if (found == CHI_CELL_BROKEN)
  {
    job->failed = CHI_ERROR_INVALID_ARGUMENT;
  }
  if (piece)
  {
    piece->ghosts += found == CHI_CELL_GHOST;
    piece->blanked += found == CHI_CELL_BLANKED;
    piece->lower_dimensional += found == CHI_CELL_FLAT_TYPE;
    piece->unsupported += found == CHI_CELL_UNSUPPORTED;
    piece->skipped += found == CHI_CELL_NON_FINITE;
  }
}

/* Fetch what is needed of cells further on in an order that is not memory's. */
static void fetch_ahead(const chi_scatter_job* job, size_t i, size_t last)
{
  enum
  {
    FAR = 64,
    NEAR = 12
  };
  const chi_grid_view* const v = &job->grid.view;
  if (job->is_uniform && i + FAR < last)
  {
    __builtin_prefetch(v->connectivity + 4 * (size_t)job->order[i + FAR]);
  }
  else if (i + FAR < last)
  {
    const size_t cell = job->order[i + FAR];
    __builtin_prefetch(v->offsets + cell);
    __builtin_prefetch(v->cell_types + cell);
    const int64_t at = v->offsets[job->order[i + NEAR]];
    if (at >= 0 && (uint64_t)at < v->connectivity_count)
    {
      __builtin_prefetch(v->connectivity + at);
    }
  }
}

void chi_scatter_visit_run(
  chi_scatter_job* job, size_t run, chi_scatter_worker* w, chi_scatter_piece* piece)
{
  const chi_grid_view* const v = &job->grid.view;
  const size_t begin = run * CHI_SCATTER_RUN, cells = job->grid.cells;
  const size_t first = begin > job->run_phase ? begin - job->run_phase : 0;
  const size_t end = begin + CHI_SCATTER_RUN - job->run_phase;
  const size_t last = end < cells ? end : cells;
  const int are_cells = job->input.association == CHI_SCATTERPLOT_CELLS;
  const int is_plain = job->masses && !v->cell_ghosts && !v->point_ghosts;
  if (piece)
  {
    *piece = (chi_scatter_piece){ .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY } };
  }
  for (size_t i = first; i < last && !job->failed; ++i)
  {
    const size_t index = job->order ? job->order[i] : i;
    if (job->order)
    {
      fetch_ahead(job, i, last);
    }
    if (are_cells)
    {
      count(job, piece, visit_constant(job, w, index, piece));
      continue;
    }
    const int is_tetrahedron =
      is_plain && (job->is_uniform || v->cell_types[index] == VTK_TETRA_TYPE);
    const size_t most = is_tetrahedron ? 1 : most_simplices(job, index);
    if (most > w->block.capacity - w->block.count)
    {
      chi_scatter_finish_block(job, w, run, piece);
      if (!chi_scatter_reserve_block(job, w, most))
      {
        return;
      }
    }
    count(job, piece,
      is_tetrahedron          ? add_tetrahedron(job, w, index, job->masses + i, piece != NULL)
        : job->dimension == 2 ? chi_scatter_add_polygon(job, w, index)
                              : add_cell(job, w, index, piece != NULL));
  }
  chi_scatter_finish_block(job, w, run, piece);
}
