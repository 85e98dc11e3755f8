/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Vicinity occlusion, how it is combined with the light planes, and the opacity of geometry. Scenes
 * of surfaces alone: 96 x 96 pixels, one world unit each in parallel projection. */

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  WIDTH = 96,
  PIXELS = WIDTH * WIDTH
};

static const double pi = 3.14159265358979324;

typedef struct scene
{
  chi_camera camera;
  chi_surface_view surface;
  chi_occlusion_params params;
  chi_occlusion_frame frame;
  chi_occlusion* engine;
  float depth[PIXELS];
} scene;

static scene* make_scene(int parallel)
{
  scene* const s = calloc(1, sizeof *s);
  if (!s)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, WIDTH, WIDTH, parallel ? WIDTH / 2 : 0.25);
  s->surface = (chi_surface_view){ .struct_size = sizeof s->surface, .depth = s->depth };
  chi_occlusion_default_params(&s->params);
  s->params.bias = 1.5;
  s->params.sample_distance = 1;
  s->params.vicinity_distance = 8;
  s->params.vicinity_samples = 118;
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .surface = &s->surface,
    .params = &s->params };
  CHECK(chi_occlusion_create(NULL, &s->engine) == CHI_OK);
  return s;
}

static void free_scene(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  free(s);
}

/* Visibility of every surface pixel. */
static void render(scene* s, float* out)
{
  chi_occlusion_image image;
  ++s->surface.version;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  CHECK(image.visibility != NULL);
  if (image.visibility)
  {
    memcpy(out, image.visibility, PIXELS * sizeof *out);
  }
}

/* What the vicinity leaves, apart from the planes: the quotient of two pictures. */
static void render_vicinity(scene* s, float* out)
{
  static float alone[PIXELS];
  const int32_t samples = s->params.vicinity_samples;
  s->params.vicinity_samples = 0;
  render(s, alone);
  s->params.vicinity_samples = samples;
  render(s, out);
  for (int i = 0; i < PIXELS; ++i)
  {
    CHECK(alone[i] > 0.1f);
    out[i] /= alone[i];
  }
}

/* Columns left of the middle lie `lead` nearer to the eye. */
static void step_edge(scene* s, double lead)
{
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = (float)(i % WIDTH < WIDTH / 2 ? 100 - lead : 100);
  }
}

/* Share of the unit disc beyond a chord at this distance from its centre. */
static double beyond_chord(double distance)
{
  return distance >= 1 ? 0 : (acos(distance) - distance * sqrt(1 - distance * distance)) / pi;
}

/* Largest error of the visibility beside the edge against the closed form. */
static double step_error(const float* seen, double radius)
{
  double worst = 0;
  for (int x = WIDTH / 2; x < WIDTH; ++x)
  {
    /* a sample is the pixel that it falls into: the edge lies between pixels */
    const double exact = 1 - beyond_chord((x + 0.5 - WIDTH / 2) / radius);
    worst = fmax(worst, fabs((double)seen[WIDTH / 2 * WIDTH + x] - exact));
  }
  return worst;
}

static void a_step_takes_its_share_of_the_disc(void)
{
  static float seen[PIXELS];
  scene* const s = make_scene(1);
  /* 118 points of equal areas: within 3 areas of any half-plane's share */
  const double tolerance = 3.0 / 118;
  step_edge(s, 4);
  render_vicinity(s, seen);
  CHECK(step_error(seen, 8) <= tolerance);
  CHECK((double)seen[WIDTH / 2 * WIDTH + WIDTH / 2] < 0.6); /* there is something to see */
  CHECK(seen[WIDTH / 2 * WIDTH + WIDTH / 2 - 1] == 1);      /* the nearer side keeps its light */
  s->params.cone_angle_rad = atan(0.5); /* Eq. 4: the radius is l tan of the angle */
  render_vicinity(s, seen);
  CHECK(step_error(seen, 4) <= tolerance);
  /* Between one and two slices ahead the light planes take over. */
  s->params.cone_angle_rad = 0.25 * pi;
  step_edge(s, 12);
  render_vicinity(s, seen);
  const double half_way = 1 - (double)seen[WIDTH / 2 * WIDTH + WIDTH / 2];
  CHECK_NEAR(half_way, 0.5 * beyond_chord(0.5 / 8), tolerance);
  step_edge(s, 17);
  render_vicinity(s, seen);
  CHECK(seen[WIDTH / 2 * WIDTH + WIDTH / 2] == 1);
  free_scene(s);
}

static void the_papers_rule_counts_whatever_is_nearer_than_the_bias(void)
{
  static float seen[PIXELS];
  scene* const s = make_scene(1);
  s->params.vicinity_bias = 2;
  step_edge(s, 1.9);
  render_vicinity(s, seen);
  CHECK(seen[WIDTH / 2 * WIDTH + WIDTH / 2] == 1);
  for (int k = 0; k < 2; ++k)
  {
    step_edge(s, k ? 40 : 2.1);
    render_vicinity(s, seen);
    CHECK(step_error(seen, 8) <= 3.0 / 118);
  }
  free_scene(s);
}

/* A plane z = 100 + slope x in eye coordinates, seen from anywhere. */
static void tilted_plane(scene* s, double slope, int along_y)
{
  for (int i = 0; i < PIXELS; ++i)
  {
    const int at = along_y ? i / WIDTH : i % WIDTH;
    const double window = s->camera.window[0] * (1 - (at + 0.5) / WIDTH * 2);
    /* perspective: z = 100 + slope * window * z */
    s->depth[i] = (float)(s->camera.parallel ? 100 + slope * window : 100 / (1 - slope * window));
  }
}

static void planes_keep_their_light_at_any_tilt(void)
{
  static float seen[PIXELS];
  static const double slopes[] = { 0, 0.1, 1, -2 };
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel);
    for (int k = 0; k < 8; ++k)
    {
      tilted_plane(s, slopes[k >> 1], k & 1);
      render_vicinity(s, seen);
      float darkest = 1;
      for (int i = 0; i < PIXELS; ++i)
      {
        darkest = fminf(darkest, seen[i]);
      }
      CHECK(darkest == 1);
      if (k >= 4) /* the paper's rule darkens it by up to a half */
      {
        s->params.vicinity_bias = 0.4;
        render_vicinity(s, seen);
        CHECK(seen[PIXELS / 2 + WIDTH / 2] < 0.65f);
        s->params.vicinity_bias = 0;
      }
    }
    free_scene(s);
  }
}

static void both_terms_combine_by_product_or_minimum_and_strength_comes_last(void)
{
  static float planes[PIXELS], vicinity[PIXELS], both[PIXELS];
  scene* const s = make_scene(1);
  for (int i = 0; i < PIXELS; ++i) /* a low wall and a high one */
  {
    s->depth[i] = i % WIDTH < 32 ? 94 : i % WIDTH < 64 ? 100 : 88;
  }
  render_vicinity(s, vicinity);
  s->params.vicinity_samples = 0;
  render(s, planes);
  s->params.vicinity_samples = 118;
  s->params.combine = CHI_COMBINE_MINIMUM;
  render(s, both);
  int planes_darker = 0, vicinity_darker = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    /* the quotient in render_vicinity is rounded twice */
    CHECK_NEAR((double)both[i], fmin((double)planes[i], (double)vicinity[i]), 2e-7);
    planes_darker += planes[i] < vicinity[i];
    vicinity_darker += vicinity[i] < planes[i];
  }
  CHECK(planes_darker > 100 && vicinity_darker > 100); /* both cases occur */
  s->params.combine = CHI_COMBINE_PRODUCT;
  s->params.strength = 0.4;
  render(s, both);
  for (int i = 0; i < PIXELS; ++i)
  {
    CHECK_NEAR((double)both[i], 1 - 0.4 * (1 - (double)planes[i] * (double)vicinity[i]), 3e-7);
  }
  free_scene(s);
}

static void nothing_happens_where_geometry_shall_not_shade_itself(void)
{
  static float seen[PIXELS];
  scene* const s = make_scene(1);
  step_edge(s, 6);
  for (int k = 0; k < 2; ++k)
  {
    s->params.interactions =
      k ? CHI_ALL_INTERACTIONS & ~CHI_GEOMETRY_TO_GEOMETRY : CHI_ALL_INTERACTIONS;
    s->params.strength = k ? 1 : 0;
    render(s, seen);
    float darkest = 1;
    for (int i = 0; i < PIXELS; ++i)
    {
      darkest = fminf(darkest, seen[i]);
    }
    CHECK(darkest == 1);
  }
  free_scene(s);
}

/* A strip that is nearer: its shadow on what lies behind it is linear in its opacity, because light
 * passes it once. */
static void geometry_lets_through_what_its_opacity_leaves(void)
{
  static float full[PIXELS], part[PIXELS];
  scene* const s = make_scene(1);
  s->params.vicinity_samples = 0;
  static const double thickness[] = { 0, 5 };
  for (int k = 0; k < 4; ++k)
  {
    for (int i = 0; i < PIXELS; ++i)
    {
      s->depth[i] = abs(i % WIDTH - WIDTH / 2) < 10 ? 80 : 100;
    }
    s->params.half_size = k & 1;
    s->params.geometry_thickness = thickness[k >> 1];
    s->params.geometry_opacity = 1;
    render(s, full);
    s->params.geometry_opacity = 0.25;
    render(s, part);
    double darkest = 1;
    for (int x = 0; x < WIDTH; ++x)
    {
      const int i = WIDTH / 2 * WIDTH + x;
      if (s->depth[i] > 90)
      {
        /* Far from a thick strip rays cross a corner of it; next to it at most a quarter of those
         * that it blocks do (its thickness is 5 of 20), and each by its full opacity at most. */
        const int thick = thickness[k >> 1] > 0;
        if (thick && full[i] > 0.8f)
        {
          continue;
        }
        const double tolerance = thick ? 0.25 * 0.25 * (1 - (double)full[i]) : 0;
        CHECK_NEAR((double)part[i], 1 - 0.25 * (1 - (double)full[i]), tolerance + 1e-5);
        darkest = fmin(darkest, (double)full[i]);
      }
    }
    CHECK(darkest < 0.7);
    s->params.geometry_opacity = 0;
    render(s, part);
    for (int i = 0; i < PIXELS; ++i)
    {
      CHECK(part[i] >= 1 - 1e-5f);
    }
  }
  /* Algorithm 3: the opacity acts in every slab behind */
  s->params.geometry_thickness = INFINITY;
  s->params.geometry_opacity = 1;
  render(s, full);
  s->params.geometry_opacity = 0.25;
  render(s, part);
  const int beside = WIDTH / 2 * WIDTH + WIDTH / 2 + 11;
  CHECK(part[beside] < 1 - 0.3f * (1 - full[beside]) && part[beside] >= full[beside] - 1e-5f);
  free_scene(s);
}

static void bad_parameters_are_refused(void)
{
  scene* const s = make_scene(1);
  step_edge(s, 6);
  const chi_occlusion_params good = s->params;
  for (int k = 0; k < 8; ++k)
  {
    s->params = good;
    switch (k)
    {
      case 0:
        s->params.vicinity_samples = 119;
        break;
      case 1:
        s->params.vicinity_samples = -1;
        break;
      case 2:
        s->params.vicinity_distance = -1;
        break;
      case 3:
        s->params.vicinity_distance = NAN;
        break;
      case 4:
        s->params.vicinity_bias = -1;
        break;
      case 5:
        s->params.combine = 2;
        break;
      case 6:
        s->params.geometry_opacity = 1.5;
        break;
      default:
        s->params.geometry_opacity = NAN;
        break;
    }
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  }
  free_scene(s);
}

int main(void)
{
  a_step_takes_its_share_of_the_disc();
  the_papers_rule_counts_whatever_is_nearer_than_the_bias();
  planes_keep_their_light_at_any_tilt();
  both_terms_combine_by_product_or_minimum_and_strength_comes_last();
  nothing_happens_where_geometry_shall_not_shade_itself();
  geometry_lets_through_what_its_opacity_leaves();
  bad_parameters_are_refused();
  return chi_test_report();
}
