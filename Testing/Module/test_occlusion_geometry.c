/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Opaque geometry in the occlusion engine: who darkens whom, thickness, leaks, seams. */

#include "chi_test.h"
#include "occlusion_reference.h"

enum
{
  SIZE = REFERENCE_SIZE,
  PIXELS = REFERENCE_PICTURE * REFERENCE_PICTURE
};

static const double angle_45 = 0.78539816339744831;

/* What most tests here need; the picture has one pixel a voxel unless a test changes the view. */
typedef struct bench
{
  reference_view view;
  reference_frame* frame;
  chi_occlusion* engine;
  float* depth;
} bench;

static int bench_create(bench* b)
{
  b->view = reference_parallel_view();
  b->frame = malloc(sizeof *b->frame);
  b->depth = malloc(PIXELS * sizeof *b->depth);
  b->engine = NULL;
  const int ok = b->frame && b->depth && chi_occlusion_create(NULL, &b->engine) == CHI_OK;
  CHECK(ok);
  return ok;
}

static void bench_destroy(bench* b)
{
  chi_occlusion_destroy(NULL, b->engine);
  free(b->frame);
  free(b->depth);
}

/* New depths and samples each time: they may lie at the addresses of the last. */
static void bench_use(bench* b, const reference_volume* volume, double range)
{
  static uint64_t version = 0;
  reference_frame_init(b->frame, volume, &b->view, range);
  b->frame->surface = (chi_surface_view){
    .struct_size = sizeof b->frame->surface, .depth = b->depth, .version = ++version
  };
  b->frame->volume.version = version;
  b->frame->frame.surface = &b->frame->surface;
}

static const float* render_visibility(bench* b)
{
  chi_occlusion_image image = { 0 };
  CHECK(chi_occlusion_render(NULL, b->engine, &b->frame->frame) == CHI_OK);
  chi_occlusion_get_image(b->engine, &image);
  CHECK(image.visibility != NULL);
  return image.visibility;
}

static double probe(bench* b, double x, double y, double z)
{
  double at[3] = { x, y, z };
  float seen = -1;
  const reference_points points = { at, 1 };
  CHECK(reference_probe(NULL, b->engine, b->frame, &b->view, &points, &seen) == CHI_OK);
  return (double)seen;
}

/* A plate at z = 20 over a strip of the picture, a wall at z = 84 beside it. */
static void plate_and_wall(bench* b)
{
  const int width = b->view.camera.width;
  for (int i = 0; i < width * b->view.camera.height; ++i)
  {
    const int x = i % width - width / 2;
    const double z = x < 0 && x >= -width / 8 ? 20 : 84;
    b->depth[i] = (float)(z - b->view.eye[2]);
  }
}

/* The same model by rays: thickness 0 is one slab. Limits: those asked of the half-plane. */
static void geometry_of_any_thickness_shades_as_the_rays_say(double angle_deg, double limit)
{
  bench b;
  reference_volume empty;
  const size_t n[3] = { SIZE, SIZE, SIZE };
  const double thickness[3] = { 0, 12, INFINITY };
  if (!bench_create(&b) || !reference_volume_create(&empty, n))
  {
    return;
  }
  if (angle_deg > 0)
  {
    b.view = reference_perspective_view(angle_deg);
  }
  plate_and_wall(&b);
  const int width = b.view.camera.width, row = b.view.camera.height / 2;
  const double dx = (b.view.camera.window[1] - b.view.camera.window[0]) / width;
  for (int k = 0; k < 6; ++k)
  {
    bench_use(&b, &empty, 1);
    b.frame->params.bias = 1.5;
    b.frame->params.half_size = k & 1;
    b.frame->params.geometry_thickness = thickness[k >> 1];
    const float* const seen = render_visibility(&b);
    const reference_surface surface = {
      .depth = b.depth, .thickness = k >> 1 ? thickness[k >> 1] : 1, .nearest = 20 - b.view.eye[2]
    };
    const reference_rays rays = { 256, 0.5, angle_45 };
    double error = 0, darkest = 1, brightest = 0;
    int count = 0;
    for (int i = width / 2; seen && i < width; i += 4)
    {
      const double z = 84 - 1.5, scale = b.view.camera.parallel ? 1 : z - b.view.eye[2];
      const double at[3] = { b.view.eye[0] + scale * (b.view.camera.window[0] + (i + 0.5) * dx),
        b.view.eye[1] + scale * (b.view.camera.window[2] + (row + 0.5) * dx), z };
      const double exact = reference_visibility(NULL, &surface, &b.view, &rays, at);
      error += fabs((double)seen[i + width * row] - exact);
      darkest = fmin(darkest, exact);
      brightest = fmax(brightest, exact);
      ++count;
    }
    printf("plate over a wall, %g degrees, thickness %g, %s: mean %.4f, V %.3f to %.3f\n",
      angle_deg, thickness[k >> 1], k & 1 ? "half" : "full", error / count, darkest, brightest);
    CHECK(count > 15 && darkest < (k >> 1 < 2 ? 0.9 : 0.7));
    CHECK(error / count <= limit);
  }
  reference_volume_free(&empty);
  bench_destroy(&b);
}

/* Volume and geometry on one cone: 60 balls and a plate, at the judged points outside the plate. */
static void volume_and_geometry_shade_together(void)
{
  bench b;
  reference_volume v;
  reference_points points = { NULL, 0 };
  if (!bench_create(&b))
  {
    return;
  }
  for (int i = 0; i < SIZE * SIZE; ++i)
  {
    const int on = i % SIZE >= 40 && i % SIZE < 80 && i / SIZE >= 30 && i / SIZE < 90;
    b.depth[i] = on ? (float)(40.5 - b.view.eye[2]) : INFINITY;
  }
  if (reference_scene(&v, REFERENCE_BALLS, NULL) &&
    reference_points_create(&points, &v, REFERENCE_BALLS, &b.view, 31))
  {
    float* const seen = malloc(points.count * sizeof *seen);
    double* const exact = malloc(2 * points.count * sizeof *exact);
    const reference_rays rays = { 256, 0.5, angle_45 };
    for (int k = 0; k < 2 && seen && exact; ++k)
    {
      bench_use(&b, &v, 4.5);
      b.frame->params.geometry_thickness = k ? 15 : 0;
      const reference_surface surface = { b.depth, k ? 15 : 1, 40 - b.view.eye[2], NULL, NULL };
      size_t kept = 0;
      for (size_t i = 0; i < points.count; ++i)
      {
        double* const at = points.position + 3 * i;
        if (k == 0 || !(at[2] > 38 && at[2] < 58 && at[0] > 36 && at[0] < 84))
        {
          memmove(points.position + 3 * kept++, at, 3 * sizeof *at);
        }
      }
      points.count = kept;
      for (size_t i = 0; i < kept; ++i)
      {
        exact[i] = reference_visibility(&v, &surface, &b.view, &rays, points.position + 3 * i);
      }
      CHECK(reference_probe(NULL, b.engine, b.frame, &b.view, &points, seen) == CHI_OK);
      const reference_error e = reference_compare(seen, exact, kept, exact + points.count);
      printf("balls and plate, thickness %d: mean %.4f, bias %+.4f, %zu points\n", k ? 15 : 0,
        e.mean, e.bias, kept);
      CHECK(kept > 100 && e.mean <= 0.024); /* of the two scenes alone: 0.018 and 0.024 */
    }
    free(seen);
    free(exact);
    reference_volume_free(&v);
  }
  reference_points_free(&points);
  bench_destroy(&b);
}

/* Share of the cone on the far side of a plane that falls by `slope` a unit of x. */
static double beyond_plane(double slope)
{
  const int steps = 2000;
  double share = 0;
  for (int i = 0; i < steps; ++i)
  {
    const double mu = 1 - (1 - cos(angle_45)) * (i + 0.5) / steps;
    const double x = mu / (slope * sqrt(1 - mu * mu));
    share += x < 1 ? acos(x) / 3.14159265358979324 / steps : 0;
  }
  return share;
}

static void tilt(bench* b, double slope, int along_y)
{
  for (int i = 0; i < SIZE * SIZE; ++i)
  {
    const double x = (along_y ? i / SIZE : i % SIZE) - 64;
    b->depth[i] = (float)(500 + slope * x - b->view.eye[2]);
  }
}

/*
 * Behind a plane that is one slab thin only that light arrives which leans more than the plane: no
 * ray slips between two pixels whose depths lie slabs apart. In front of it that light is missing.
 * Half a pixel of depth, the slab, and 32 directions leave 0.05 of the cone open to doubt.
 */
static void one_tilted_surface_neither_leaks_nor_shades_itself(void)
{
  bench b;
  if (!bench_create(&b))
  {
    return;
  }
  static const double slopes[4] = { 0.6, 0.9, 2, 3 };
  for (int k = 0; k < 16; ++k)
  {
    const double slope = slopes[k >> 2];
    reference_volume empty;
    const size_t n[3] = { 2, 2, (size_t)(128 * slope) + 60 };
    if (!reference_volume_create(&empty, n))
    {
      break;
    }
    tilt(&b, slope, k & 1);
    bench_use(&b, &empty, 1);
    b.frame->volume.index_to_world[11] =
      -500 + 0.5 * (double)n[2]; /* slabs of one voxel all along the surface */
    b.frame->params.directions = 32;
    b.frame->params.half_size = k >> 1 & 1;
    b.frame->params.sample_distance = 1;
    const double expected = slope > 1 ? beyond_plane(slope) : 0;
    const double behind = probe(&b, 64, 64, 506);
    b.frame->params.bias = 1.5;
    const float* const seen = render_visibility(&b);
    const double before = seen ? (double)seen[64 + 64 * SIZE] : -1;
    printf("slope %.1f %s %s: behind %.3f (%.3f), in front %.3f (%.3f)\n", slope, k & 1 ? "y" : "x",
      k & 2 ? "half" : "full", behind, expected, before, 1 - expected);
    CHECK(behind <= expected + 0.05);
    CHECK_NEAR(before, 1 - expected, 0.05);
    reference_volume_free(&empty);
  }
  bench_destroy(&b);
}

/* Behind the last slice each direction is read at its remaining offset; and farther light slices
 * than the volume's own change nothing: same rays, same limit as for the half-plane. */
static void geometry_behind_the_volume_is_shaded_exactly(void)
{
  bench b;
  reference_volume v;
  const size_t n[3] = { SIZE, SIZE, 30 };
  if (!bench_create(&b) || !reference_volume_create(&v, n))
  {
    return;
  }
  for (size_t i = 0; i < n[0] * n[1]; ++i)
  {
    const size_t layer = n[0] * n[1];
    v.extinction[i + 20 * layer] = v.extinction[i + 21 * layer] = i % SIZE < 64 ? 8.0f : 0.0f;
  }
  reference_volume_finish(&v);
  static const double walls[4] = { 36, 45, 70, 150 };
  for (int k = 0; k < 8; ++k)
  {
    const double wall = walls[k >> 1];
    for (int i = 0; i < SIZE * SIZE; ++i)
    {
      b.depth[i] = (float)(wall - b.view.eye[2]);
    }
    bench_use(&b, &v, 8);
    b.frame->params.half_size = k & 1;
    const float* const seen = render_visibility(&b);
    const reference_rays rays = { 512, 0.25, angle_45 };
    double error = 0;
    int count = 0;
    for (int i = 2; seen && i < SIZE; i += 3)
    {
      if (fabs(i - 63.5) <= wall - 21)
      {
        const double at[3] = { i, 64, wall };
        error +=
          fabs((double)seen[i + SIZE * 64] - reference_visibility(&v, NULL, &b.view, &rays, at));
        ++count;
      }
    }
    printf(
      "wall at %g behind a plate, %s: mean %.4f\n", wall, k & 1 ? "half" : "full", error / count);
    CHECK(count > 3 && error / count <= (k & 1 ? 0.024 : 0.028));
  }
  reference_volume_free(&v);
  bench_destroy(&b);
}

/* A tilted plane that comes from before the box, passes through it and leaves behind it: light is
 * the same all along, whichever slices it meets. */
static void no_seam_where_geometry_leaves_the_box(void)
{
  bench b;
  reference_volume v;
  const size_t n[3] = { SIZE, SIZE, 24 };
  if (!bench_create(&b) || !reference_volume_create(&v, n))
  {
    return;
  }
  b.view.eye[2] = -200;
  b.view.camera.world_to_eye[11] = -200;
  for (int k = 0; k < 4; ++k)
  {
    const double slope = k & 1 ? 2 : 0.9;
    for (int i = 0; i < SIZE * SIZE; ++i)
    {
      b.depth[i] = (float)(12 + slope * (i % SIZE - 64) - b.view.eye[2]);
    }
    bench_use(&b, &v, 1);
    b.frame->params.bias = 1.5;
    b.frame->params.half_size = k >> 1;
    const float* const seen = render_visibility(&b);
    double low = 1, high = 0;
    for (int i = 40; seen && i < 88; ++i)
    {
      low = fmin(low, (double)seen[i + SIZE * 64]);
      high = fmax(high, (double)seen[i + SIZE * 64]);
    }
    printf("slope %.1f through the box, %s: V %.4f to %.4f\n", slope, k >> 1 ? "half" : "full", low,
      high);
    CHECK(high - low <= 0.03); /* a slab's position within a pixel's step of depth */
    CHECK_NEAR(0.5 * (low + high), slope > 1 ? 1 - beyond_plane(slope) : 1, 0.06);
  }
  reference_volume_free(&v);
  bench_destroy(&b);
}

/* A volume's plate shades the left, geometry's the right; each of four receivers stands in the
 * shade of one, so that each hangs on one bit alone. */
static void each_interaction_bit_does_what_it_says(void)
{
  bench b;
  reference_volume v;
  const size_t n[3] = { SIZE, SIZE, 100 };
  if (!bench_create(&b) || !reference_volume_create(&v, n))
  {
    return;
  }
  for (size_t i = 0; i < n[0] * n[1]; ++i)
  {
    v.extinction[i + 20 * n[0] * n[1]] = i % SIZE < 34 ? 8.0f : 0.0f;
    b.depth[i] = (float)((i % SIZE >= 94 ? 30 : 60) - b.view.eye[2]);
  }
  reference_volume_finish(&v);
  for (int bits = 0; bits < 16; ++bits)
  {
    bench_use(&b, &v, 8);
    b.frame->params.interactions = bits;
    b.frame->params.bias = 1.5;
    const double left = probe(&b, 38, 64, 50), right = probe(&b, 89, 64, 50);
    const float* const seen = render_visibility(&b);
    const double wall_left = seen ? (double)seen[38 + SIZE * 64] : -1;
    const double wall_right = seen ? (double)seen[89 + SIZE * 64] : -1;
    const double receiver[4] = { left, wall_left, right, wall_right };
    for (int k = 0; k < 4; ++k) /* CHI_VOLUME_TO_VOLUME, _GEOMETRY; CHI_GEOMETRY_TO_VOLUME, _... */
    {
      CHECK(bits >> k & 1 ? receiver[k] < 0.75 && receiver[k] > 0.3 : receiver[k] > 0.999);
    }
  }
  reference_volume_free(&v);
  bench_destroy(&b);
}

/* No interaction, or no strength: probes are 1, and written. */
static void a_surface_without_anyone_to_shade_it_is_lit(void)
{
  bench b;
  reference_volume v;
  const size_t n[3] = { SIZE, SIZE, 100 };
  if (!bench_create(&b) || !reference_volume_create(&v, n))
  {
    return;
  }
  plate_and_wall(&b);
  bench_use(&b, &v, 8);
  b.frame->params.interactions = 0;
  CHECK(probe(&b, 70, 64, 50) == 1);
  const float* const seen = render_visibility(&b);
  CHECK(seen && seen[64 + 64 * SIZE] == 1);
  b.frame->params.interactions = CHI_ALL_INTERACTIONS;
  const double shaded = probe(&b, 66, 64, 50);
  b.frame->params.strength = 0;
  CHECK(shaded < 0.9 && probe(&b, 66, 64, 50) == shaded); /* before strength */
  reference_volume_free(&v);
  bench_destroy(&b);
}

/* Asked: >= 0.97 at the default bias; the picture in front of it stays empty. */
static void open_geometry_keeps_its_colour(void)
{
  bench b;
  if (!bench_create(&b))
  {
    return;
  }
  for (int k = 0; k < 24; ++k)
  {
    static const double thickness[3] = { 0, 10, INFINITY };
    if (k >= 12)
    {
      b.view = reference_perspective_view(30);
    }
    for (int i = 0; i < PIXELS; ++i)
    {
      b.depth[i] = (float)((k & 2 ? 40 : 40.6) - b.view.eye[2]);
    }
    bench_use(&b, NULL, 1);
    b.frame->params.bias = -1;
    b.frame->params.half_size = k & 1;
    b.frame->params.geometry_thickness = thickness[k % 12 / 4];
    const float* const seen = render_visibility(&b);
    const int last = b.view.camera.width * b.view.camera.height - 1;
    CHECK(seen && seen[last / 2] >= 0.97f && seen[0] >= 0.97f && seen[last] >= 0.97f);
    CHECK(seen && seen[last / 2] <= 1.0001f);
    chi_occlusion_image image;
    chi_occlusion_get_image(b.engine, &image);
    CHECK(image.rgba && image.rgba[2 * last] == 0);
  }
  bench_destroy(&b);
}

/* Samples behind the surface are not drawn; the sample slab that it cuts counts up to it. */
static void a_surface_ends_the_rays(void)
{
  bench b;
  reference_volume v;
  const size_t n[3] = { SIZE, SIZE, 60 };
  if (!bench_create(&b) || !reference_volume_create(&v, n))
  {
    return;
  }
  for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i)
  {
    v.extinction[i] = 0.02f;
  }
  reference_volume_finish(&v);
  for (int i = 0; i < SIZE * SIZE; ++i)
  {
    b.depth[i] = (float)(0.5 * (i % SIZE) - b.view.eye[2]);
  }
  bench_use(&b, &v, 1);
  b.frame->params.strength = 0;
  CHECK(render_visibility(&b) != NULL);
  chi_occlusion_image image;
  chi_occlusion_get_image(b.engine, &image);
  for (int i = 1; i < SIZE - 1 && image.rgba; ++i)
  {
    const double length = fmin(0.5 * i, 59);
    /* a hundredth of a slab's 0.02 */
    CHECK_NEAR((double)image.rgba[4 * (i + SIZE * 64) + 3], -expm1(-0.02 * length), 2e-4);
    CHECK(image.visibility[i + SIZE * 64] == 1); /* strength 0 */
  }
  reference_volume_free(&v);
  bench_destroy(&b);
}

int main(void)
{
  geometry_of_any_thickness_shades_as_the_rays_say(0, 0.028);
  geometry_of_any_thickness_shades_as_the_rays_say(30, 0.031);
  volume_and_geometry_shade_together();
  one_tilted_surface_neither_leaks_nor_shades_itself();
  geometry_behind_the_volume_is_shaded_exactly();
  each_interaction_bit_does_what_it_says();
  open_geometry_keeps_its_colour();
  a_surface_ends_the_rays();
  no_seam_where_geometry_leaves_the_box();
  a_surface_without_anyone_to_shade_it_is_lit();
  return chi_test_report();
}
