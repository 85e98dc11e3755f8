/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The table of full pre-integration: the colour that leaves a segment, divided by its opacity, over
 * (front scalar, back scalar, optical depth). Divided, because opacity is known exactly without a
 * table, and what is left changes little and slowly.
 *
 * It is built as Engel et al. 2001 build theirs, by adding a slice to what is there, but along
 * another way: the scalar axes are cut into cells, and as long as the length per scalar (kappa)
 * stays the same, the segment that begins a cell earlier is that cell in front of the segment that
 * was there (Eq. 8). So all segments that end at the same scalar come one from the other, at once
 * for a ladder of kappas, and the optical depths wanted are read off between its rungs. The sums
 * have positive terms alone, and nothing is interpolated on the way.
 */

#include "chi_preintegration_internal.h"

#include <math.h>

enum
{
  OCTAVE = 2,       /* rungs of the ladder in an octave of kappa */
  MOST_RUNGS = 112, /* as many as `dim` and CHI_FULL_THICK ask for, up to MOST_DEPTHS */
  MOST_DEPTHS = 64,
  PANELS = 16, /* of a cell of more entries than that */
  TERMS = 5    /* of a cell and rung: red, green, blue, opacity, transmittance */
};

static const double dim = 1e-10;     /* a cell with less of the table's whole extinction has none */
static const double thin = 1.0 / 64; /* optical depth of the whole table at the first rung */

typedef struct build
{
  const chi_exec* exec;
  const float (*color)[4];
  int count, nodes, depths;
  int rungs;
  double axis[MOST_DEPTHS]; /* the third axis: rungs from an optical depth of 1 */
  double first;             /* kappa of the first rung */
  double* place;            /* [nodes] of the nodes in the 1-D tables */
  double (*cell)[4]; /* [nodes - 1] integrals of red, green, blue x extinction, of extinction */
  float* stage;      /* [nodes - 1][2][TERMS][rungs]; 0: front below, 1: front above */
  int* below;        /* [nodes] nearest node at or below, under which there is extinction; -1 */
  int* above;
  float (*full)[4];
} build;

/* 1: where nodes belong *********************************************************************** */

static double bend(const build* b, int i, int c)
{
  return fabs((double)b->color[i - 1][c] - 2 * (double)b->color[i][c] + (double)b->color[i + 1][c]);
}

/* How many nodes entry i ... i + 1 asks for, to a factor. Linear interpolation's error is that of
 * the second derivative times the distance squared, so nodes go by its root; one half goes
 * everywhere where the functions bend little. */
static double wish(const build* b, double most, int i)
{
  double sum = 1.0 / (b->count - 1);
  for (int k = i; k <= i + 1 && most > 0; ++k)
  {
    if (k > 0 && k < b->count - 1)
    {
      const double visible =
        fmax(fmax((double)b->color[k - 1][3], (double)b->color[k + 1][3]), (double)b->color[k][3]);
      const double colors = bend(b, k, 0) + bend(b, k, 1) + bend(b, k, 2);
      sum += 0.5 * sqrt((bend(b, k, 3) + colors * visible) / most);
    }
  }
  return sum;
}

/* The factor by which as many nodes as there are come out, where no entry gets more than one. */
static double scale_wishes(const build* b, double most)
{
  double low = 0, high = b->count - 1;
  for (int k = 0; k < 50; ++k)
  {
    const double middle = 0.5 * (low + high);
    double sum = 0;
    for (int i = 0; i < b->count - 1; ++i)
    {
      sum += fmin(1, middle * wish(b, most, i));
    }
    *(sum < b->nodes - 1 ? &low : &high) = middle;
  }
  return high;
}

/* Nodes are entries where there are more entries, else every entry is a node and the rest go
 * between, so that wherever can be no kink lies within a cell. Writes b->place, and the entries'
 * places among the nodes. */
static void place_nodes(build* b, float (*depth)[4])
{
  const int entries = b->count - 1, cells = b->nodes - 1;
  double most = 0, all = 0, sum = 0;
  for (int i = 0; i <= entries; ++i)
  {
    most = fmax(most, (double)b->color[i][3]);
  }
  const double factor = entries > cells ? scale_wishes(b, most) : 0;
  for (int i = 0; i < entries; ++i)
  {
    const double w = wish(b, most, i);
    all += entries > cells ? fmin(1, factor * w) : w;
  }
  int node = 0, start = 0; /* the last node, and its entry */
  b->place[0] = depth[0][3] = 0;
  for (int i = 0; i < entries; ++i)
  {
    const double w = wish(b, most, i);
    sum += entries > cells ? fmin(1, factor * w) : w;
    const double share = fmin(sum / all, 1);
    int next =
      entries > cells ? (int)(cells * share + 0.5) : i + 1 + (int)((cells - entries) * share + 0.5);
    if (i == entries - 1)
    {
      next = cells;
    }
    else if (next == cells && entries > cells)
    {
      next = node; /* the last node is the last entry */
    }
    for (int k = node + 1; k <= next; ++k)
    {
      b->place[k] = start + (double)(i + 1 - start) * (k - node) / (next - node);
    }
    if (next > node)
    {
      for (int k = start + 1; k <= i + 1; ++k)
      {
        depth[k][3] = (float)(node + (double)(next - node) * (k - start) / (i + 1 - start));
      }
      node = next;
      start = i + 1;
    }
  }
  depth[b->count][3] = (float)cells;
}

/* 2: cells ************************************************************************************ */

/* A part of a cell: its ends and integrals, the latter exact. */
typedef struct panel
{
  double low[4], high[4], sum[4];
} panel;

static panel make_panel(const build* b, double from, double to)
{
  panel p = { .sum = { 0 } };
  chi_classify_at(b->color, b->count, from, p.low);
  chi_classify_at(b->color, b->count, to, p.high);
  chi_integrate_entries(b->color, b->count, from, to, p.sum);
  return p;
}

/* Premultiplied colour, opacity and transmittance of a panel seen from one side. Colour and
 * extinction are linear (Eq. 5), up to what its exact integrals say besides. */
static void emit(const panel* p, int from_above, double kappa, double out[TERMS])
{
  const double* const front = from_above ? p->high : p->low;
  const double* const back = from_above ? p->low : p->high;
  const double tau = kappa * p->sum[3], both = front[3] + back[3];
  const double share = both > 0 ? front[3] / both : 0.5;
  out[3] = -expm1(-tau);
  out[4] = exp(-tau);
  const double psi = tau > 1e-4 ? chi_psi(2 * tau * share, 2 * tau * (1 - share)) : 1;
  for (int c = 0; c < 3; ++c)
  {
    const double mean = p->sum[3] > 0 ? p->sum[c] / p->sum[3] : 0;
    if (tau > 1e-4)
    {
      const double linear = (front[c] * (1 + share) + back[c] * (2 - share)) / 3;
      out[c] = front[c] * (1 - psi) + back[c] * (psi - out[4]) + (mean - linear) * out[3];
    }
    else /* the difference is of the order of tau / 12, and would be lost in that of psi from 1 */
    {
      out[c] = mean * out[3];
    }
  }
}

static int cell_panels(const build* b, int cell, panel panels[PANELS])
{
  const double from = b->place[cell], to = b->place[cell + 1];
  const int entries = (int)(ceil(to) - floor(from));
  if (entries > PANELS)
  {
    for (int k = 0; k < PANELS; ++k)
    {
      panels[k] =
        make_panel(b, from + (to - from) * k / PANELS, from + (to - from) * (k + 1) / PANELS);
    }
    return PANELS;
  }
  for (int k = 0; k < entries; ++k)
  {
    panels[k] = make_panel(b, fmax(from, floor(from) + k), fmin(to, floor(from) + k + 1));
  }
  return entries;
}

static void integrate_cells(void* data, size_t begin, size_t end)
{
  build* const b = (build*)data;
  for (size_t cell = begin; cell < end; ++cell)
  {
    panel panels[PANELS];
    const int count = cell_panels(b, (int)cell, panels);
    memset(b->cell[cell], 0, sizeof b->cell[cell]);
    for (int k = 0; k < count; ++k)
    {
      for (int c = 0; c < 4; ++c)
      {
        b->cell[cell][c] += panels[k].sum[c];
      }
    }
  }
}

static void stage_cells(void* data, size_t begin, size_t end)
{
  build* const b = (build*)data;
  for (size_t cell = begin; cell < end && !chi_is_cancelled(b->exec); ++cell)
  {
    panel panels[PANELS];
    const int count = cell_panels(b, (int)cell, panels);
    for (int above = 0; above < 2; ++above)
    {
      float* const stage = b->stage + (2 * cell + (size_t)above) * TERMS * (size_t)b->rungs;
      for (int rung = 0; rung < b->rungs; ++rung)
      {
        const double kappa = b->first * exp2((double)rung / OCTAVE);
        double sum[TERMS] = { 0, 0, 0, 0, 1 };
        for (int k = 0; k < count; ++k) /* from the back to the front */
        {
          double part[TERMS];
          emit(panels + (above ? k : count - 1 - k), above, kappa, part);
          for (int c = 0; c < 4; ++c)
          {
            sum[c] = part[c] + part[4] * sum[c];
          }
          sum[4] *= part[4];
        }
        for (int c = 0; c < TERMS; ++c)
        {
          stage[c * b->rungs + rung] = (float)sum[c];
        }
      }
    }
  }
}

/* 3: segments ********************************************************************************* */

/* All segments to one back end, as they grow. */
typedef struct growing
{
  double sum[4];            /* the integrals of what they pass */
  float now[4][MOST_RUNGS]; /* premultiplied colour and opacity */
  int top;                  /* rungs that thicker segments may need */
} growing;

/* A cell in front: Eq. 8. */
static void grow(const build* b, growing* g, int cell, int above)
{
  const float* const stage = b->stage + (size_t)(2 * cell + above) * TERMS * (size_t)b->rungs;
  const float* const through = stage + 4 * b->rungs;
  for (int c = 0; c < 4; ++c)
  {
    g->sum[c] += b->cell[cell][c];
    const float* const add = stage + c * b->rungs;
    float* const now = g->now[c];
    for (int rung = 0; rung < g->top; ++rung)
    {
      now[rung] = add[rung] + through[rung] * now[rung];
    }
  }
}

static float* entry(const build* b, int front, int back, int depth)
{
  return b->full[(size_t)front + (size_t)b->nodes * (size_t)(back + b->nodes * depth)];
}

/* Where nothing is seen: what would be, were the segment a little longer at the end that has not so
 * far to go, so that the cells at the border do not mix in what belongs to nobody. */
static void fill_dark(const build* b, int front, int back)
{
  const int low = front < back ? front : back, high = front < back ? back : front;
  const int below = b->below[low], above = b->above[high];
  double rgba[2][4] = { { 0 }, { 0 } };
  const int far = 2 * b->nodes;
  const int down = below < 0 ? far : low - below, up = above < 0 ? far : above - high;
  if (down < far || up < far)
  {
    chi_classify_at(b->color, b->count, b->place[down <= up ? below : above], rgba[0]);
    chi_classify_at(b->color, b->count, b->place[up <= down ? above : below], rgba[1]);
  }
  for (int k = 0; k < b->depths; ++k)
  {
    float* const e = entry(b, front, back, k);
    for (int c = 0; c < 3; ++c)
    {
      e[c] = (float)(0.5 * (rgba[0][c] + rgba[1][c]));
    }
    e[3] = 0;
  }
}

/* Between rungs: the cubic through four of them; below the first one, where the whole table is
 * thin, linear towards the mean without attenuation. */
static void fill_seen(const build* b, growing* g, int front, int back)
{
  float color[3][MOST_RUNGS];
  const double whole = OCTAVE * log2(g->sum[3] * b->first);
  double mean[3];
  for (int c = 0; c < 3; ++c)
  {
    mean[c] = g->sum[c] / g->sum[3];
  }
  const double last = b->axis[b->depths - 1] - whole, second = b->axis[1] - whole;
  const int top = last < b->rungs - 3 ? (int)(last < 1 ? 1 : last) + 3 : b->rungs;
  g->top = top < g->top ? top : g->top;
  for (int rung = second > 1 ? (int)second - 1 : 0; rung < g->top; ++rung)
  {
    const float inverse = g->now[3][rung] > 0 ? 1 / g->now[3][rung] : 0;
    for (int c = 0; c < 3; ++c)
    {
      color[c][rung] = g->now[c][rung] * inverse;
    }
  }
  for (int k = 0; k < b->depths; ++k)
  {
    float* const e = entry(b, front, back, k);
    const double at = k > 0 ? b->axis[k] - whole : -1e9;
    const int rung = at < 1 ? 1 : at < g->top - 3 ? (int)at : g->top - 3;
    const double f = fmin(fmax(at - rung, -1), 2), share = at < 0 ? exp2(at / OCTAVE) : 1;
    const double w[4] = { -f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2,
      -(f + 1) * f * (f - 2) / 2, (f + 1) * f * (f - 1) / 6 };
    for (int c = 0; c < 3; ++c)
    {
      const float* const r = color[c] + rung;
      const double value =
        w[0] * (double)r[-1] + w[1] * (double)r[0] + w[2] * (double)r[1] + w[3] * (double)r[2];
      e[c] = (float)fmin(fmax(k > 0 ? mean[c] + share * (value - mean[c]) : mean[c], 0), 1);
    }
    e[3] = 0;
  }
}

static void fill_rows(void* data, size_t begin, size_t end)
{
  build* const b = (build*)data;
  for (size_t row = begin; row < end && !chi_is_cancelled(b->exec); ++row)
  {
    const int back = (int)row;
    fill_dark(b, back, back);
    for (int above = 0; above < 2; ++above)
    {
      growing g = { .top = b->rungs };
      const int step = above ? 1 : -1, stop = above ? b->nodes : -1;
      for (int front = back + step; front != stop; front += step)
      {
        grow(b, &g, above ? front - 1 : front, above);
        if (g.sum[3] > 0)
        {
          fill_seen(b, &g, front, back);
        }
        else
        {
          fill_dark(b, front, back);
        }
      }
    }
  }
}

/* 4: all of it ******************************************************************************** */

/* Cells that are as good as empty are, and the ladder of kappas is as long as the others need it.
 */
static void find_rungs(build* b)
{
  double all = 0, least = INFINITY;
  const int cells = b->nodes - 1;
  for (int i = 0; i < cells; ++i)
  {
    all += b->cell[i][3];
  }
  for (int i = 0; i < cells; ++i)
  {
    if (b->cell[i][3] > dim * all)
    {
      least = fmin(least, b->cell[i][3]);
    }
    else
    {
      memset(b->cell[i], 0, sizeof b->cell[i]);
    }
  }
  for (int i = 0; i <= cells; ++i)
  {
    b->below[i] = i > 0 ? b->cell[i - 1][3] > 0 ? i : b->below[i - 1] : -1;
    const int j = cells - i;
    b->above[j] = i > 0 ? b->cell[j][3] > 0 ? j : b->above[j + 1] : -1;
  }
  b->first = all > 0 ? thin / all : 1;
  const double last = (double)CHI_FULL_THICK * (b->depths - 2) / least;
  b->rungs = all > 0 ? (int)ceil(OCTAVE * log2(last / b->first)) + 4 : 4;
  b->rungs = b->rungs < MOST_RUNGS ? b->rungs : MOST_RUNGS;
}

static void give_back(const chi_exec* exec, void* block, size_t count, size_t size)
{
  if (block)
  {
    chi_free(exec, block, count, size);
  }
}

chi_status chi_fill_full(const chi_exec* exec, const float (*color)[4], float (*depth)[4],
  size_t count, const int32_t size[3], float (*full)[4])
{
  build b = { .exec = exec,
    .color = color,
    .count = (int)count,
    .nodes = size[0],
    .depths = size[2],
    .full = full };
  const size_t nodes = (size_t)size[0];
  const size_t stages = (nodes - 1) * 2 * TERMS * MOST_RUNGS;
  for (int k = 1; k < b.depths; ++k) /* tau = gamma / (1 - gamma) */
  {
    const int end = b.depths - 1;
    b.axis[k] = OCTAVE * log2(k < end ? (double)k / (end - k) : CHI_FULL_THICK * (end - 1));
  }
  b.place = (double*)chi_alloc(exec, nodes, sizeof *b.place);
  b.cell = (double(*)[4])chi_alloc(exec, nodes - 1, sizeof *b.cell);
  b.stage = (float*)chi_alloc(exec, stages, sizeof *b.stage);
  b.below = (int*)chi_alloc(exec, 2 * nodes, sizeof *b.below);
  chi_status status = CHI_ERROR_OUT_OF_MEMORY;
  if (b.place && b.cell && b.stage && b.below)
  {
    b.above = b.below + nodes;
    place_nodes(&b, depth);
    integrate_cells(&b, 0, nodes - 1);
    find_rungs(&b);
    status = chi_for(exec, nodes - 1, stage_cells, &b);
    status = status == CHI_OK ? chi_for(exec, nodes, fill_rows, &b) : status;
  }
  give_back(exec, b.place, nodes, sizeof *b.place);
  give_back(exec, b.cell, nodes - 1, sizeof *b.cell);
  give_back(exec, b.stage, stages, sizeof *b.stage);
  give_back(exec, b.below, 2 * nodes, sizeof *b.below);
  return status;
}
