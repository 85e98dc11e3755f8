/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous scatterplots against closed forms and against cutting in long double. */

#include "scatterplot_scene.h"
#include "scatterplot_waves.h"

static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 }, minus[3] = { -1, -1, -1 };

static double field_scale = 1;

static void x_and_y(const double x[3], double value[2])
{
  value[0] = field_scale * x[0];
  value[1] = field_scale * x[1];
}

static void x_and_y_plus_z(const double x[3], double value[2])
{
  value[0] = field_scale * x[0];
  value[1] = field_scale * (x[1] + x[2]);
}

static void x_and_x(const double x[3], double value[2])
{
  value[0] = value[1] = field_scale * x[0];
}

static void x_and_constant(const double x[3], double value[2])
{
  value[0] = field_scale * x[0];
  value[1] = field_scale * 0.25;
}

/* Integral over a bin of the density of y + z, both even on [0, 1]. */
static double triangle_below(double t)
{
  return t <= 0 ? 0 : t <= 1 ? t * t / 2 : t <= 2 ? 1 - (2 - t) * (2 - t) / 2 : 1;
}

/* Mass of each bin of a plot of the unit cube over [0, scale] x [0, scale or 2 scale]. */
static double exact_mass(scene_field field, size_t i, size_t j, size_t n)
{
  const double h = 1.0 / (double)n;
  if (field == x_and_y)
  {
    return h * h;
  }
  if (field == x_and_y_plus_z)
  {
    return h * (triangle_below(2 * h * (double)(j + 1)) - triangle_below(2 * h * (double)j));
  }
  if (field == x_and_x)
  {
    return i == j ? h : 0;
  }
  return j == (size_t)(0.25 * (double)n) ? h : 0;
}

static void closed_forms_hold_at_every_scale(void)
{
  static const scene_field fields[] = { x_and_y, x_and_y_plus_z, x_and_x, x_and_constant };
  static const size_t cells[][2] = { { 4, 16 }, { 8, 64 }, { 5, 100 }, { 11, 50 } };
  static const double scales[] = { 1, 1e-12, 1e12 };
  for (int k = 0; k < 4 * 4 * 3 * 2; ++k)
  {
    const scene_field field = fields[k % 4];
    const size_t n = cells[k / 4 % 4][0], bins = cells[k / 4 % 4][1];
    field_scale = scales[k / 16 % 3];
    scene* const s = scene_image((size_t[3]){ n, n, n }, zero, one, field);
    if (k / 48)
    {
      scene_to_list(s, 0);
    }
    const double top = field == x_and_y_plus_z ? 2 * field_scale : field_scale;
    const chi_scatterplot_params params = scene_params(bins, bins, 0, field_scale, 0, top);
    chi_scatterplot_result r;
    double* const density = scene_plot(NULL, s, &params, &r);
    const double area = field_scale / (double)bins * (top / (double)bins);
    double error = 0, peak = 0;
    for (size_t i = 0; i < bins * bins; ++i)
    {
      const double exact = exact_mass(field, i % bins, i / bins, bins);
      peak = exact > peak ? exact : peak;
      error = fmax(error, fabs(density[i] * area - exact));
    }
    /* the bound that the header states */
    CHECK_NEAR(error / peak, 0, 1e-10);
    CHECK_NEAR(scene_mass_error(density, &r, bins, bins, 1), 0, 1e-12);
    CHECK_NEAR(r.mass_out_of_range, 0, 0);
    CHECK_NEAR(r.total_mass, 1, 1e-14 * (double)(n * n * n)); /* rounding of one sum */
    CHECK_NEAR(r.singular_mass, field == x_and_x || field == x_and_constant ? 1 : 0, 1e-9);
    CHECK(r.simplices == 6 * n * n * n);
    CHECK(r.edge_simplices + r.one_bin_simplices + r.section_simplices == r.simplices);
    free(density);
    scene_free(s);
  }
  field_scale = 1;
}

static void one_tetrahedron_is_a_tent_of_height_3V_over_A(void)
{
  /* the fourth corner projects into the triangle of the others, of area 1/2; bins so small that
   * their mean is the height: it falls by 3 of 256ths of itself from the peak's bin to the next */
  const double f[4] = { 0, 1, 0, 0.25 }, g[4] = { 0, 0, 1, 0.25 }, volume = 0.7;
  const size_t n = 1024;
  const chi_scatterplot_params params = scene_params(n, n, 0, 1, 0, 1);
  chi_scatterplot_result r;
  double* const density = scene_plot_one(f, g, volume, &params, &r);
  double peak = 0;
  for (size_t i = 0; i < n * n; ++i)
  {
    peak = density[i] > peak ? density[i] : peak;
    const double x = ((double)(i % n) + 0.5) / (double)n, y = ((double)(i / n) + 0.5) / (double)n;
    const double h = fmin(fmin(x, y) / 0.25, (1 - x - y) / 0.5);
    /* bins without a ridge have the value at their centre: linear, to 1e-10 of the peak */
    const double ridge = fmin(fabs(x - y), fabs(fmin(x, y) / 0.25 - (1 - x - y) / 0.5));
    if (ridge > 8.0 / (double)n && h > 8.0 / (double)n)
    {
      CHECK_NEAR(density[i], 6 * volume * h, 1e-10 * 6 * volume);
    }
  }
  CHECK_NEAR(peak, 6 * volume, 6 * volume * 4 / (double)n * 2);
  CHECK_NEAR(scene_mass_error(density, &r, n, n, volume), 0, 1e-12);
  CHECK(r.edge_simplices == 1);
  free(density);
}

/* Largest difference of bins from the reference's masses, relative to its largest; the
 * mass beyond the plot is exact to rounding of the whole. */
static double compare(const double* density, const chi_scatterplot_result* r, const ref_plot* ref)
{
  const double area = (ref->range[0][1] - ref->range[0][0]) / (double)ref->bins[0] *
    ((ref->range[1][1] - ref->range[1][0]) / (double)ref->bins[1]);
  long double peak = 0, error = 0;
  CHECK_NEAR(r->mass_out_of_range, (double)ref->out, 1e-12 * r->total_mass);
  for (size_t i = 0; i < ref->bins[0] * ref->bins[1]; ++i)
  {
    peak = fmaxl(peak, ref->mass[i]);
    error = fmaxl(error, fabsl(density[i] * (long double)area - ref->mass[i]));
  }
  return peak > 0 ? (double)(error / peak) : (double)error;
}

static void tetrahedra_of_any_shape_match_cutting(void)
{
  uint32_t seed = 7;
  const size_t n = 24;
  double worst[4] = { 0 };
  ref_plot ref = { .bins = { n, n } };
  ref.mass = (long double*)malloc(n * n * sizeof *ref.mass);
  for (int k = 0; k < 1500; ++k)
  {
    /* sizes from 1e-3 to 30 bins, slivers down to 1e-10, beyond the plot's ends too */
    double f[4], g[4];
    const double size = pow(10, -3 + 4.5 * chi_test_random(&seed));
    const double thin = pow(10, -10 * chi_test_random(&seed) * chi_test_random(&seed));
    const double angle = 7 * chi_test_random(&seed);
    const double cx = 24 * chi_test_random(&seed), cy = 24 * chi_test_random(&seed);
    const int grid = k % 5 == 0, flat = k % 7;
    for (int c = 0; c < 4; ++c)
    {
      const double u = (chi_test_random(&seed) - 0.5) * size;
      const double v = (chi_test_random(&seed) - 0.5) * size * thin;
      f[c] = cx + u * cos(angle) - v * sin(angle);
      g[c] = cy + u * sin(angle) + v * cos(angle);
      if (grid) /* corners on lines of the plot */
      {
        f[c] = floor(f[c]);
        g[c] = floor(g[c]);
      }
      f[c] = flat == 1 ? f[0] : f[c];
      g[c] = flat == 2 ? f[c] : g[c];
    }
    ref.range[0][0] = ref.range[1][0] = 0;
    ref.range[0][1] = ref.range[1][1] = (double)n;
    memset(ref.mass, 0, n * n * sizeof *ref.mass);
    ref.out = 0;
    ref_deposit(&ref, 4, f, g, 0.3L);
    for (int all = 0; all < 2; ++all)
    {
      chi_scatterplot_params params = scene_params(n, n, 0, (double)n, 0, (double)n);
      params.switches = all ? CHI_SCATTERPLOT_NO_EDGES | CHI_SCATTERPLOT_NO_ONE_BIN : 0;
      params.switches |= CHI_SCATTERPLOT_NO_SKIP;
      chi_scatterplot_result r;
      double* const density = scene_plot_one(f, g, 0.3, &params, &r);
      const double error = compare(density, &r, &ref);
      const int way = r.edge_simplices ? 0 : r.one_bin_simplices ? 1 : all ? 3 : 2;
      worst[way] = error > worst[way] ? error : worst[way];
      CHECK_NEAR(scene_mass_error(density, &r, n, n, 0.3), 0, 1e-12);
      free(density);
    }
  }
  /* The stated bound, though values are rounded to 32 2^-51 of a bin here, and a cell of 1e-3 bins
   * that a line cuts moves by 3 of that relative to its size: 4e-11. */
  for (int way = 0; way < 4; ++way)
  {
    CHECK_NEAR(worst[way], 0, 1e-10);
  }
  free(ref.mass);
}

static void images_and_lists_match_cutting(void)
{
  static const double zooms[] = { 1, 0.5, 1e-3 };
  for (int k = 0; k < 2 * 3; ++k)
  {
    const size_t n = 4, bins = k % 2 ? 24 : 10;
    const double zoom = zooms[k / 2];
    scene* const s = scene_image((size_t[3]){ n, n + 3, n }, minus, one, waves_values);
    const double x = 0.45, y = 0.9;
    const double half_x = zoom == 1 ? 1 : 0.45 * zoom, half_y = zoom == 1 ? 2 : 0.9 * zoom;
    ref_plot ref = { .bins = { bins, bins + 3 },
      .range = { { x - half_x, x + half_x }, { y - half_y, y + half_y } } };
    ref.mass = (long double*)calloc(bins * (bins + 3), sizeof *ref.mass);
    for (size_t t = 0; t < s->counts.tetrahedra; ++t)
    {
      double f[4], g[4];
      for (size_t c = 0; c < 4; ++c)
      {
        f[c] = s->f[s->vertices[4 * t + c]];
        g[c] = s->g[s->vertices[4 * t + c]];
      }
      ref_deposit(&ref, 4, f, g, 8.0L / (6.0L * (long double)(n * n * (n + 3))));
    }
    for (int way = 0; way < 4; ++way)
    {
      chi_scatterplot_params params = scene_params(
        bins, bins + 3, ref.range[0][0], ref.range[0][1], ref.range[1][0], ref.range[1][1]);
      params.switches = way == 1 ? CHI_SCATTERPLOT_NO_EDGES
        : way == 3               ? CHI_SCATTERPLOT_ALWAYS_SORT
                                 : 0;
      if (way == 2)
      {
        scene_to_list(s, 5);
      }
      chi_scatterplot_result r;
      double* const density = scene_plot(NULL, s, &params, &r);
      CHECK_NEAR(compare(density, &r, &ref), 0, 1e-10);
      CHECK_NEAR(scene_mass_error(density, &r, bins, bins + 3, 8), 0, 1e-12);
      free(density);
    }
    free(ref.mass);
    scene_free(s);
  }
}

static void marschner_lobb_approaches_quadrature_with_the_square_of_the_mesh(void)
{
  /* a quarter of the domain, which is symmetric about the axis */
  static const double corner[3] = { 0, 0, -1 };
  const size_t n = 24, bins[2] = { n, n };
  const double range[2][2] = { { 0, 1 }, { 0, sqrt(3) } };
  double *const exact = (double*)malloc(n * n * sizeof *exact), l1[3] = { 0 };
  waves_masses(exact, bins, range, 4096); /* twice as many change it by 3e-5 of the mass */
  for (int k = 0; k < 3; ++k)
  {
    const size_t cells = (size_t[]){ 40, 80, 160 }[k]; /* 4 to 17 a wave */
    scene* const s = scene_image((size_t[3]){ cells, cells, cells / 2 }, corner, one, waves_values);
    const chi_scatterplot_params params = scene_params(n, n, 0, 1, 0, range[1][1]);
    double* const density = scene_plot(NULL, s, &params, NULL);
    for (size_t i = 0; i < n * n; ++i)
    {
      l1[k] += fabs(density[i] * range[1][1] / (double)(n * n) - exact[i] / 4) / 2;
    }
    free(density);
    scene_free(s);
  }
  CHECK_NEAR(log2(l1[1] / l1[2]), 2, 0.2);
  CHECK(l1[0] > l1[1] && l1[2] < 0.01);
  free(exact);
}

int main(void)
{
  marschner_lobb_approaches_quadrature_with_the_square_of_the_mesh();
  closed_forms_hold_at_every_scale();
  one_tetrahedron_is_a_tent_of_height_3V_over_A();
  tetrahedra_of_any_shape_match_cutting();
  images_and_lists_match_cutting();
  return chi_test_report();
}
