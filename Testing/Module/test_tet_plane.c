/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Tetrahedra under transfer functions of two quantities, against brute force. Prints what it
 * measures, in units of 1/255. */
#include "chi_test.h"
#include "tet_frame.h"
#include "tet_reference.h"

#include <chiaroscuro/chi_transfer_shapes.h>

enum
{
  SIZE = 64,
  PIXELS = SIZE * SIZE,
  COLUMNS = 513,
  ROWS = 385
};

/* A scene under a function of two quantities. */
typedef struct of_two
{
  scene s;
  tet_mesh* mesh;
  float *first, *second;
  chi_array_view view;
  chi_transfer_shape shapes[3];
  float (*table)[4];
} of_two;

static chi_transfer_shape blob(double x, double y, double sigma, double r, double g, double b)
{
  return (chi_transfer_shape){ .struct_size = sizeof(chi_transfer_shape),
    .kind = CHI_SHAPE_GAUSSIAN,
    .rgba = { r, g, b, 0.6 },
    .center = { x, y },
    .sigma = { sigma, sigma } };
}

/* Both quantities within 0 ... 1; the second bends and has nothing to do with the first. */
static void make_of_two(of_two* o, int view, int parallel, int of_cells)
{
  memset(o, 0, sizeof *o);
  o->mesh = tet_mesh_cubes(6, TET_OBLIQUE_RAMP);
  make_scene(&o->s, o->mesh, view, parallel, SIZE);
  const size_t count = of_cells ? o->mesh->count : o->mesh->point_count;
  o->first = (float*)malloc(count * sizeof *o->first);
  o->second = (float*)malloc(count * sizeof *o->second);
  for (size_t i = 0; i < count; ++i)
  {
    const double* const p = o->mesh->points[of_cells ? o->mesh->vertices[i][0] : i];
    o->first[i] = (float)((p[0] + p[1] + p[2] + 3) / 6);
    o->second[i] = (float)(0.5 + 0.45 * sin(3 * p[0] - 2 * p[1] + p[2]));
  }
  o->view = (chi_array_view){ o->second, count, 1, sizeof *o->second, CHI_F32 };
  o->s.field.second = &o->view;
  o->s.field.is_cell_data = of_cells;
  o->s.scalars = (chi_array_view){ o->first, count, 1, sizeof *o->first, CHI_F32 };
  o->shapes[0] = blob(0.3, 0.3, 0.1, 1, 0.2, 0.1);
  o->shapes[1] = blob(0.5, 0.7, 0.07, 0.2, 1, 0.3);
  o->shapes[2] = blob(0.75, 0.4, 0.15, 0.3, 0.4, 1);
  o->table = (float(*)[4])malloc(COLUMNS * ROWS * sizeof *o->table);
  const size_t size[2] = { COLUMNS, ROWS };
  CHECK(chi_transfer_shapes_table(
          NULL, o->shapes, 3, size, (double[]){ 0, 1 }, (double[]){ 0, 1 }, o->table[0]) == CHI_OK);
  chi_transfer_view* const t = &o->s.transfer.view;
  t->rgb = t->opacity = NULL;
  t->plane = o->table[0];
  t->plane_count[0] = COLUMNS;
  t->plane_count[1] = ROWS;
  t->plane_range[0] = 0;
  t->plane_range[1] = 1;
  t->unit_distance = 0.2;
}

static void free_of_two(of_two* o)
{
  free(o->first);
  free(o->second);
  free(o->table);
  tet_mesh_free(o->mesh);
}

static tet_reference_scene reference_of(const of_two* o, const float* values)
{
  return (tet_reference_scene){ .camera = &o->s.camera,
    .points = (const double(*)[3])o->mesh->points,
    .vertices = (const uint32_t(*)[4])o->mesh->vertices,
    .count = o->mesh->count,
    .scalars = values,
    .is_cell_data = o->s.field.is_cell_data };
}

/* Of one pixel: the shapes themselves at many places of every segment, thin slices in a row. */
static void integrate(const of_two* o, int x, int y, double rgba[4])
{
  const tet_reference_scene scenes[2] = { reference_of(o, o->first), reference_of(o, o->second) };
  tet_reference_fragment* lists[2];
  size_t counts[2];
  for (int q = 0; q < 2; ++q)
  {
    lists[q] = tet_reference_list(scenes + q, x + 0.5, y + 0.5, counts + q);
  }
  CHECK(counts[0] == counts[1]);
  double through = 1;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (size_t i = 0; i < counts[0]; ++i)
  {
    enum
    {
      STEPS = 64 /* the middle of steps of a 64th of a cell: to 1e-5 of it */
    };
    const tet_reference_fragment *const a = lists[0] + i, *const b = lists[1] + i;
    for (int k = 0; k < STEPS; ++k)
    {
      const double u = (k + 0.5) / STEPS;
      double at[4];
      CHECK(chi_transfer_shapes_map(o->shapes, 3, a->scalar[0] + u * (a->scalar[1] - a->scalar[0]),
              b->scalar[0] + u * (b->scalar[1] - b->scalar[0]), at) == CHI_OK);
      const double alpha = -expm1(-at[3] / o->s.transfer.view.unit_distance * a->length / STEPS);
      for (int c = 0; c < 3; ++c)
      {
        rgba[c] += through * alpha * at[c];
      }
      through *= 1 - alpha;
    }
  }
  rgba[3] = 1 - through;
  free(lists[0]);
  free(lists[1]);
}

static void is_what_brute_force_says(void)
{
  static const char* const names[4] = { "auto", "none", "partial", "full" };
  for (int kind = 0; kind < 3; ++kind) /* perspective, parallel, values of cells */
  {
    of_two o;
    make_of_two(&o, TET_VIEW_OBLIQUE, kind == 1, kind == 2);
    double(*const exact)[4] = (double(*)[4])malloc(PIXELS * sizeof *exact);
    for (int i = 0; i < PIXELS; ++i)
    {
      integrate(&o, i % SIZE, i / SIZE, exact[i]);
    }
    double mean[4] = { 0 };
    for (int method = CHI_PREINTEGRATION_AUTO; method <= CHI_PREINTEGRATION_FULL; ++method)
    {
      chi_tet* tet;
      chi_tet_image image;
      o.s.params.pre_integration = method;
      CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
      CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
      chi_tet_get_image(tet, &image);
      double most = 0, seen = 0;
      for (int i = 0; i < PIXELS; ++i)
      {
        for (int c = 0; c < 4; ++c)
        {
          const double error = 255 * fabs((double)image.rgba[4 * i + c] - exact[i][c]);
          mean[method] += error / (4 * PIXELS);
          most = fmax(most, error);
        }
        seen += exact[i][3] > 0.1;
      }
      CHECK(seen > PIXELS / 5);
      printf("two quantities, kind %d, %s: mean %.4f, largest %.3f\n", kind, names[method],
        mean[method], most);
      if (method == CHI_PREINTEGRATION_AUTO || method == CHI_PREINTEGRATION_FULL)
      {
        /* the bound of the mean for full tables. Parts of two of 512 entries, of which the
         * narrowest Gaussian has 36 a sigma, are off by (2/36)^2 / 12 of its height, 0.07 of 255,
         * psi's quadrature by 4e-5, of which some ten cells add up at the worst pixel */
        CHECK(mean[method] <= 0.05 && most <= 0.5);
      }
      chi_tet_destroy(NULL, tet);
    }
    if (kind != 2)
    {
      CHECK(mean[1] > 10 * mean[3] && mean[2] > 10 * mean[3]); /* something is to be integrated */
    }
    free(exact);
    free_of_two(&o);
  }
}

/* Marks where the second quantity, 0 ... `end`, is near a value: opaque there, nothing elsewhere.
 */
static void mark(of_two* o, double value, double end)
{
  for (int j = 0; j < ROWS; ++j)
  {
    const int near = fabs((double)j / (ROWS - 1) * end / value - 1) < 0.1;
    for (int i = 0; i < COLUMNS; ++i)
    {
      memcpy(o->table[j * COLUMNS + i], (float[4]){ 1, 0.5f, 0.25f, near ? 0.4f : 0 },
        4 * sizeof(float));
    }
  }
  o->s.transfer.view.plane_range[1] = end;
  ++o->s.transfer.view.version;
}

/* The ramp along the diagonal rises by 1 over 2 along each axis: 1/6 along each, whatever the mesh.
 */
static void without_a_second_array_it_is_the_gradient(void)
{
  of_two o;
  chi_tet* tet;
  chi_tet_image image;
  make_of_two(&o, TET_VIEW_OBLIQUE, 0, 0);
  o.s.field.second = NULL;
  const double edge = cbrt(8.0 / (double)o.mesh->count);
  const double gradient = sqrt(3.0) / 6 * edge;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  for (int off = 0; off < 2; ++off)
  {
    mark(&o, off ? 1.3 * gradient : gradient, 4 * gradient);
    CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
    chi_tet_get_image(tet, &image);
    for (int i = 0; i < PIXELS; ++i)
    {
      const double length = tet_reference_cube_length(&o.s.camera, i % SIZE + 0.5, i / SIZE + 0.5);
      const double alpha = off ? 0 : -expm1(-0.4f / o.s.transfer.view.unit_distance * length);
      CHECK_NEAR(image.rgba[4 * i + 3], alpha, 1e-4); /* the bound of even meshes */
      CHECK_NEAR(image.rgba[4 * i + 1], 0.5 * alpha, 1e-4);
    }
  }
  chi_tet_destroy(NULL, tet);
  free_of_two(&o);
}

/* Largest along the ray: the scalar is at an end of each segment, and the second quantity there. */
static void maximum_intensity_takes_both_at_the_largest_scalar(void)
{
  of_two o;
  chi_tet* tet;
  chi_tet_image image;
  make_of_two(&o, TET_VIEW_OBLIQUE, 0, 0);
  o.s.params.blend = CHI_TET_BLEND_MAXIMUM;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
  chi_tet_get_image(tet, &image);
  double mean = 0, seen = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    const tet_reference_scene scenes[2] = { reference_of(&o, o.first), reference_of(&o, o.second) };
    double largest = -1, other = 0, at[4] = { 0 };
    size_t count;
    tet_reference_fragment* const a =
      tet_reference_list(scenes, i % SIZE + 0.5, i / SIZE + 0.5, &count);
    tet_reference_fragment* const b =
      tet_reference_list(scenes + 1, i % SIZE + 0.5, i / SIZE + 0.5, &count);
    for (size_t k = 0; k < 2 * count; ++k)
    {
      const double s = a[k / 2].scalar[k % 2];
      other = s > largest ? b[k / 2].scalar[k % 2] : other;
      largest = s > largest ? s : largest;
    }
    if (count > 0)
    {
      CHECK(chi_transfer_shapes_map(o.shapes, 3, largest, other, at) == CHI_OK);
      seen += at[3] > 0.05;
    }
    const double alpha = fmin(at[3], 1); /* of a path of the unit distance, linear */
    mean += 255.0 / PIXELS * fabs((double)image.rgba[4 * i + 3] - alpha);
    free(a);
    free(b);
  }
  printf("two quantities, maximum: mean %.4f\n", mean);
  CHECK(seen > PIXELS / 20);
  CHECK(mean < 0.05); /* the table between its entries, at rims by chance the next cell's end */
  chi_tet_destroy(NULL, tet);
  free_of_two(&o);
}

/* What is transparent over a cell's range in every row is left out, and nothing changes by it. */
static void what_is_transparent_is_skipped(void)
{
  of_two o;
  chi_tet* tet;
  chi_tet_image image;
  chi_tet_stats stats;
  make_of_two(&o, TET_VIEW_OBLIQUE, 0, 0);
  for (int k = 0; k < COLUMNS * ROWS; ++k)
  {
    o.table[k][3] = k % COLUMNS < COLUMNS / 2 ? 0 : o.table[k][3];
  }
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  chi_tet_get_image(tet, &image);
  CHECK(stats.skipped[1] > 100);
  float* const kept = (float*)malloc(4 * PIXELS * sizeof(float));
  memcpy(kept, image.rgba, 4 * PIXELS * sizeof(float));
  o.s.params.skip = CHI_TET_SKIP_EVERY_KIND & ~CHI_TET_SKIP_TRANSPARENT;
  CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  chi_tet_get_image(tet, &image);
  CHECK(stats.skipped[1] == 0);
  CHECK(memcmp(kept, image.rgba, 4 * PIXELS * sizeof(float)) == 0);
  free(kept);
  chi_tet_destroy(NULL, tet);
  free_of_two(&o);
}

/* From one function to the other, and back: tables follow. */
static void functions_of_one_and_two_quantities_take_turns(void)
{
  of_two o;
  chi_tet *tet, *fresh;
  chi_tet_image image, expected;
  tet_transfer plain;
  make_of_two(&o, TET_VIEW_OBLIQUE, 0, 0);
  tet_transfer_constant(&plain, 0.3);
  const chi_transfer_view* const both[2] = { &o.s.transfer.view, &plain.view };
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  for (int k = 0; k < 4; ++k)
  {
    o.s.frame.transfer = both[k % 2];
    CHECK(chi_tet_create(NULL, &fresh) == CHI_OK);
    CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
    CHECK(chi_tet_render(NULL, fresh, &o.s.frame) == CHI_OK);
    chi_tet_get_image(tet, &image);
    chi_tet_get_image(fresh, &expected);
    CHECK(memcmp(image.rgba, expected.rgba, 4 * PIXELS * sizeof(float)) == 0);
    chi_tet_destroy(NULL, fresh);
  }
  chi_tet_destroy(NULL, tet);
  free_of_two(&o);
}

static void nonsense_and_refused_memory_leave_the_handle_usable(void)
{
  of_two o;
  chi_tet* tet;
  make_of_two(&o, TET_VIEW_OBLIQUE, 0, 0);
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
#define REFUSED(change)                                                                            \
  do                                                                                               \
  {                                                                                                \
    const chi_tet_field field = o.s.field;                                                         \
    const chi_transfer_view transfer = o.s.transfer.view;                                          \
    const chi_tet_params params = o.s.params;                                                      \
    const chi_array_view view = o.view;                                                            \
    change;                                                                                        \
    ++o.s.field.version;                                                                           \
    CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_ERROR_INVALID_ARGUMENT);                    \
    o.s.field = field;                                                                             \
    o.s.transfer.view = transfer;                                                                  \
    o.s.params = params;                                                                           \
    o.view = view;                                                                                 \
  } while (0)
  REFUSED(o.view.count = 7);
  REFUSED(o.s.field.second_component = 1);
  REFUSED(o.s.field.opacity = &o.s.scalars);
  REFUSED(o.s.field.colors = &o.s.scalars);
  REFUSED(o.s.params.projection = CHI_TET_PROJECTION_PUBLISHED);
  REFUSED(o.s.transfer.view.plane_count[0] = 1);
  REFUSED(o.s.transfer.view.plane_count[1] = 1 << 20);
  REFUSED(o.s.transfer.view.plane_range[1] = NAN);
  REFUSED(o.s.transfer.view.range[1] = o.s.transfer.view.range[0]);
  REFUSED(o.s.transfer.view.unit_distance = 0);
#undef REFUSED
  CHECK(chi_tet_render(NULL, tet, &o.s.frame) == CHI_OK);
  chi_tet_destroy(NULL, tet);
  for (int gradient = 0; gradient < 2; ++gradient)
  {
    o.s.field.second = gradient ? NULL : &o.view;
    for (long at = 0;; ++at)
    {
      chi_test_host host = { .refuse_at = at, .cancel_at = 1L << 40 };
      const chi_exec refusing = { .struct_size = sizeof refusing,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release };
      chi_status status = chi_tet_create(&refusing, &tet);
      if (status == CHI_OK)
      {
        status = chi_tet_render(&refusing, tet, &o.s.frame);
        host.refuse_at = -1;
        CHECK(chi_tet_render(&refusing, tet, &o.s.frame) == CHI_OK);
        chi_tet_destroy(&refusing, tet);
      }
      CHECK(host.live == 0);
      CHECK(status == CHI_OK || status == CHI_ERROR_OUT_OF_MEMORY);
      if (status == CHI_OK)
      {
        CHECK(at > 10);
        break;
      }
    }
  }
  free_of_two(&o);
}

int main(void)
{
  is_what_brute_force_says();
  without_a_second_array_it_is_the_gradient();
  maximum_intensity_takes_both_at_the_largest_scalar();
  what_is_transparent_is_skipped();
  functions_of_one_and_two_quantities_take_turns();
  nonsense_and_refused_memory_leave_the_handle_usable();
  return chi_test_report();
}
