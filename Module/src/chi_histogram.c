/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Stages of a histogram: check what is given, measure the mesh piece by piece unless that is known,
 * choose the range, fill bins. Quantiles are histograms again, each in a bin of the one before.
 */

#include "chi_histogram_internal.h"

#include <math.h>

enum
{
  MOST_BINS = 1 << 20,
  DEFAULT_MOMENTS = 4,
  COARSE_BINS = 1024, /* of a quantile's first pass, which is kept */
  FINE_BINS = 32      /* of the others: there a cell that meets the window spans all of it */
};

/* ---- the handle */

chi_status chi_histogram_create(const chi_exec* exec, chi_histogram** histogram)
{
  if (!histogram)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *histogram = (chi_histogram*)chi_alloc(exec, 1, sizeof **histogram);
  if (!*histogram)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*histogram, 0, sizeof **histogram);
  return CHI_OK;
}

void chi_histogram_destroy(const chi_exec* exec, chi_histogram* h)
{
  if (h)
  {
    chi_buffer_free(exec, &h->piece_buffer);
    chi_buffer_free(exec, &h->group_buffer);
    chi_buffer_free(exec, &h->bin_buffer);
    chi_buffer_free(exec, &h->coarse_buffer);
    chi_free(exec, h, 1, sizeof *h);
  }
}

void chi_histogram_get_result(const chi_histogram* h, chi_histogram_result* result)
{
  if (h && result)
  {
    *result = h->result;
    result->struct_size = sizeof *result;
  }
}

/* ---- what is given */

static chi_status make_plan(
  chi_histogram_plan* plan, const chi_grid_view* grid, const chi_histogram_params* params)
{
  const chi_status status = chi_grid_open(&plan->grid, grid);
  if (status != CHI_OK)
  {
    return status;
  }
  const int32_t of_points = params->association == CHI_HISTOGRAM_POINTS;
  const chi_array_view* const field = params->field;
  if (params->association < CHI_HISTOGRAM_POINTS || params->association > CHI_HISTOGRAM_CELLS ||
    !chi_array_is_valid(field) ||
    field->count != (of_points ? plan->grid.points : plan->grid.cells) || params->component < -1 ||
    (params->component >= 0 && (size_t)params->component >= field->components))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  plan->field = *field;
  plan->component = params->component;
  plan->association = params->association;
  plan->moments = params->moments ? params->moments : DEFAULT_MOMENTS;
  plan->no_skipping = params->no_skipping;
  chi_histogram_make_plan(plan);
  return CHI_OK;
}

static chi_status check_params(const chi_histogram_params* p)
{
  const int32_t all = (1 << CHI_HISTOGRAM_SKIP_KINDS) - 1;
  chi_histogram_window window;
  if (p->bins == 0 || (p->no_skipping & ~all) ||
    (p->moments && (p->moments < 2 || p->moments > CHI_HISTOGRAM_MOMENTS)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (p->bins > MOST_BINS)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  return p->automatic_range || chi_histogram_open_window(&window, p->range[0], p->range[1], p->bins)
    ? CHI_OK
    : CHI_ERROR_INVALID_ARGUMENT;
}

/* ---- stages */

/* Whether the pieces of the last call are those of this one. */
static int is_known(
  const chi_histogram* h, const chi_histogram_plan* plan, const chi_histogram_params* p)
{
  return h->is_ready && p->field_version && plan->grid.view.version &&
    h->field_version == p->field_version && h->grid_version == plan->grid.view.version &&
    h->plan.component == plan->component && h->plan.association == plan->association &&
    h->plan.moments >= plan->moments && h->plan.pieces == plan->pieces &&
    !(plan->no_skipping & CHI_HISTOGRAM_SKIP_UNCHANGED);
}

static void choose_range(chi_histogram* h, const chi_histogram_params* p)
{
  chi_histogram_result* const r = &h->result;
  chi_histogram_window window;
  double low = p->range[0], high = p->range[1];
  if (p->automatic_range)
  {
    low = r->field_range[0];
    high = r->field_range[1];
    if (low > high) /* nothing there */
    {
      low = 0;
      high = 1;
    }
    else if (!chi_histogram_open_window(&window, low, high, p->bins))
    {
      const double middle = 0.5 * low + 0.5 * high;
      const double half = 0.5e-6 * (fabs(middle) > 1 ? fabs(middle) : 1);
      low = middle - half;
      high = middle + half;
      r->is_constant = 1;
    }
  }
  r->range[0] = low;
  r->range[1] = high;
}

static void write_outputs(
  const double* slots, const chi_histogram_result* r, size_t bins, const chi_histogram_outputs* o)
{
  const double size = r->range[1] - r->range[0], width = size / (double)bins;
  chi_sum below = { slots[0], 0 };
  for (size_t i = 0; i < bins; ++i)
  {
    const double mass = slots[i + 1], area = slots[bins + 2 + i + 1];
    chi_sum_add(&below, mass);
    if (o->centers)
    {
      o->centers[i] = r->range[0] + size * (((double)i + 0.5) / (double)bins);
    }
    if (o->mass)
    {
      o->mass[i] = mass;
    }
    if (o->density)
    {
      o->density[i] = mass / width;
    }
    if (o->iso_area)
    {
      o->iso_area[i] = area / width;
    }
    if (o->cumulative)
    {
      o->cumulative[i] = chi_sum_value(&below);
    }
  }
}

/* Cells of the highest dimension of all processes count. */
static size_t leave_lower_dimensions(chi_histogram_plan* plan, int dimension)
{
  const size_t cells = plan->dimension < dimension ? plan->grid.cells : 0;
  if (plan->dimension < dimension)
  {
    plan->dimension = dimension;
    plan->corners = plan->association == CHI_HISTOGRAM_CELLS ? 1 : dimension + 1;
    plan->is_lattice = 0;
    plan->pieces = 0;
  }
  return cells;
}

static chi_status measure(const chi_exec* exec, chi_histogram* h, chi_histogram_plan* plan,
  chi_status status, const chi_histogram_params* p)
{
  double dimension = plan->dimension;
  status = chi_histogram_agree(plan, status, &dimension, 1);
  if (status != CHI_OK)
  {
    return status;
  }
  const size_t lower = leave_lower_dimensions(plan, (int)dimension);
  const int known = is_known(h, plan, p);
  const int moments = known ? h->plan.moments : plan->moments;
  h->result = (chi_histogram_result){ .struct_size = sizeof h->result,
    .dimension = plan->dimension,
    .pieces = plan->pieces,
    .first_bad_cell = -1 };
  h->is_ready = 0;
  h->plan = *plan;
  h->plan.moments = moments;
  double is_new = !(known && h->has_coarse);
  h->result.moments = moments;
  h->result.skipped[2] = known;
  h->result.lower_dimensional_cells = lower;
  status = chi_histogram_agree(plan, known ? CHI_OK : chi_histogram_measure(exec, h), &is_new, 1);
  h->has_coarse = !(is_new > 0);
  return status == CHI_OK ? chi_histogram_add_up(h) : status;
}

chi_status chi_histogram_compute(const chi_exec* exec, chi_histogram* h, const chi_grid_view* grid,
  const chi_histogram_params* given_params, const chi_histogram_outputs* given_outputs)
{
  chi_histogram_params params = { .struct_size = sizeof params };
  chi_histogram_outputs outputs = { .struct_size = sizeof outputs };
  chi_histogram_plan plan;
  chi_histogram_window window;
  if (!h || !given_params || !CHI_ADOPT(chi_histogram_params, reserved, &params, given_params) ||
    (given_outputs && !CHI_ADOPT(chi_histogram_outputs, cumulative, &outputs, given_outputs)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  memset(&plan, 0, sizeof plan);
  if (params.reduction &&
    (!CHI_ADOPT(chi_histogram_reduction, sum_i64, &plan.reduction, params.reduction) ||
      !plan.reduction.max_f64 || !plan.reduction.sum_i64))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = check_params(&params); /* the same in all processes */
  status =
    status == CHI_OK ? measure(exec, h, &plan, make_plan(&plan, grid, &params), &params) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  if (exec && exec->progress)
  {
    exec->progress(exec->user, 0.5);
  }
  choose_range(h, &params);
  chi_histogram_result* const r = &h->result;
  chi_histogram_open_window(&window, r->range[0], r->range[1], params.bins);
  status = chi_histogram_fill_window(exec, h, &window, r->skipped);
  if (status != CHI_OK)
  {
    return status;
  }
  const double* const slots = (const double*)h->bin_buffer.data;
  r->mass_below = slots[0];
  r->mass_above = slots[params.bins + 1];
  write_outputs(slots, r, params.bins, &outputs);
  h->field_version = params.field_version;
  h->grid_version = plan.grid.view.version;
  h->is_ready = 1;
  if (exec && exec->progress)
  {
    exec->progress(exec->user, 1);
  }
  return CHI_OK;
}

/* ---- the distribution */

chi_status chi_histogram_moment(const chi_histogram* h, int32_t order, double* moment)
{
  if (!h || !moment || order < 0)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!h->is_ready)
  {
    return CHI_ERROR_NOT_READY;
  }
  const chi_histogram_result* const r = &h->result;
  if (order > r->moments)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  double sum = r->central_moments[0], choose = 1; /* Horner's rule in the mean */
  for (int j = 1; j <= order; ++j)
  {
    choose = choose * (order - j + 1) / j;
    sum = sum * r->mean + choose * r->central_moments[j];
  }
  *moment = order == 0 && r->total_mass > 0 ? 1 : sum;
  return CHI_OK;
}

/* The bins of the field's whole range, once. */
static chi_status find_coarse(const chi_exec* exec, chi_histogram* h, const double** slots)
{
  const size_t numbers = 2 * (COARSE_BINS + 2);
  const double* const range = h->result.field_range;
  chi_histogram_window window;
  chi_status status = CHI_OK;
  if (!h->has_coarse)
  {
    int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS] = { 0 };
    if (!chi_buffer_reserve(exec, &h->coarse_buffer, numbers, sizeof(double)))
    {
      return chi_histogram_agree(&h->plan, CHI_ERROR_OUT_OF_MEMORY, NULL, 0);
    }
    chi_histogram_open_window(&window, range[0], range[1], COARSE_BINS);
    status = chi_histogram_fill_window(exec, h, &window, skipped);
    if (status == CHI_OK)
    {
      memcpy(h->coarse_buffer.data, h->bin_buffer.data, numbers * sizeof(double));
      h->has_coarse = 1;
    }
  }
  *slots = (const double*)h->coarse_buffer.data;
  return status;
}

/* Narrow low ... high to the bin in which the mass below reaches the target; the place in it. */
static double narrow(const double* slots, size_t bins, double target, double* low, double* high)
{
  const double begin = *low, size = *high - *low;
  chi_sum below = { slots[0], 0 };
  for (size_t j = 0; j < bins; ++j)
  {
    const double mass = slots[j + 1], before = chi_sum_value(&below);
    chi_sum_add(&below, mass);
    if (chi_sum_value(&below) >= target)
    {
      const double part = mass > 0 ? (target - before) / mass : 0;
      *low = begin + size * ((double)j / (double)bins);
      *high = begin + size * ((double)(j + 1) / (double)bins);
      return *low + (*high - *low) * (part < 0 ? 0 : part > 1 ? 1 : part);
    }
  }
  *low = *high; /* rounding has moved the mass beyond */
  return *high;
}

chi_status chi_histogram_quantile(
  const chi_exec* exec, chi_histogram* h, double share, double* quantile)
{
  if (!h || !quantile || !(share >= 0 && share <= 1))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!h->is_ready)
  {
    return CHI_ERROR_NOT_READY;
  }
  const chi_histogram_result* const r = &h->result;
  double low = r->field_range[0], high = r->field_range[1];
  chi_histogram_window window;
  if (!(r->total_mass > 0))
  {
    return CHI_ERROR_EMPTY;
  }
  if (share == 0 || share == 1 || !chi_histogram_open_window(&window, low, high, COARSE_BINS))
  {
    *quantile = share < 1 ? low : high;
    return CHI_OK;
  }
  const double target = share * r->total_mass, enough = 1e-13 * (high - low);
  const double* slots = NULL;
  size_t bins = COARSE_BINS;
  chi_status status = find_coarse(exec, h, &slots);
  while (status == CHI_OK)
  {
    const double before = high - low;
    *quantile = narrow(slots, bins, target, &low, &high);
    if (!(high - low > enough) || !(high - low < before) ||
      !chi_histogram_open_window(&window, low, high, FINE_BINS))
    {
      break;
    }
    int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS] = { 0 };
    status = chi_histogram_fill_window(exec, h, &window, skipped);
    slots = (const double*)h->bin_buffer.data;
    bins = FINE_BINS;
  }
  return status;
}
