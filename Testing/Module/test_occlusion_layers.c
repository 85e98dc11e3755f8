/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Translucent layers: blended where they lie in the volume, and lit as surfaces are. */

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  N = 32,
  WIDTH = 70, /* not a multiple of a cell */
  PIXELS = WIDTH * WIDTH
};

typedef struct scene
{
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_layers_view layers;
  chi_occlusion_params params;
  chi_occlusion_frame frame;
  chi_occlusion* engine;
  float rgb[6], opacity[2], samples[N * N * N], depth[PIXELS];
  float layer_depth[CHI_MAX_LAYERS * PIXELS], layer_rgba[4 * CHI_MAX_LAYERS * PIXELS];
} scene;

/* Soft blobs, 0 ... 1, or fog of 1; a cube of 31 units centred at depth 100; the eye looks along
 * -z. No occlusion, and nothing left out. */
static scene* make_scene(int parallel, int fog)
{
  scene* const s = calloc(1, sizeof *s);
  if (!s)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, WIDTH, WIDTH, parallel ? 20 : 0.2);
  for (size_t k = 0; k < N * N * N; ++k)
  {
    const double i = (double)(k % N), j = (double)(k / N % N), z = (double)(k / N / N);
    s->samples[k] = fog ? 1 : (float)(0.5 + 0.5 * sin(0.45 * i) * cos(0.4 * j) * cos(0.5 * z));
  }
  s->volume = cube_at(s->samples, CHI_F32, N, 100);
  const float rgb[6] = { 0.2f, 0.4f, 0.9f, 1, 0.8f, 0.3f };
  memcpy(s->rgb, rgb, sizeof rgb);
  s->opacity[1] = 0.04f;
  s->transfer = tables(s->rgb, s->opacity, 2, 0.4, 1);
  s->surface = surface_of(s->depth);
  s->layers = layers_of(s->layer_depth, s->layer_rgba, 0);
  chi_occlusion_default_params(&s->params);
  s->params.sample_distance = 1;
  s->params.strength = 0;
  s->params.skip = 0;
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .volume = &s->volume,
    .transfer = &s->transfer,
    .params = &s->params,
    .layers = &s->layers };
  CHECK(chi_occlusion_create(NULL, &s->engine) == CHI_OK);
  return s;
}

static void free_scene(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  free(s);
}

static chi_occlusion_image render(scene* s)
{
  chi_occlusion_image image;
  ++s->layers.version;
  ++s->surface.version;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  CHECK(image.rgba && image.visibility);
  return image;
}

/* The picture's own copy, 4 floats a pixel. */
static float* render_copy(scene* s)
{
  float* const copy = malloc(4 * PIXELS * sizeof *copy);
  if (!copy)
  {
    exit(1);
  }
  memcpy(copy, render(s).rgba, 4 * PIXELS * sizeof *copy);
  return copy;
}

/* A layer of one depth, colour and alpha in all pixels. */
static void set_layer(scene* s, int layer, float depth, const float color[3], float alpha)
{
  for (int i = layer * PIXELS; i < (layer + 1) * PIXELS; ++i)
  {
    s->layer_depth[i] = depth;
    for (int c = 0; c < 4; ++c)
    {
      s->layer_rgba[4 * i + c] = c < 3 ? alpha * color[c] : alpha;
    }
  }
}

static const float red[3] = { 0.9f, 0.1f, 0.2f };

/* A repeatable depth per pixel and layer, in front of, inside and behind the volume, nearest layer
 * first; some of them in one segment, and some missing. */
static void set_random_layers(scene* s, int count, float alpha)
{
  uint32_t state = 12345;
  s->layers.count = count;
  for (int k = 0; k < count; ++k)
  {
    const float color[3] = { 0.9f - 0.2f * (float)k, 0.2f * (float)k, 0.5f };
    set_layer(s, k, 0, color, alpha);
  }
  for (int i = 0; i < PIXELS; ++i)
  {
    float depth = 80;
    for (int k = 0; k < count; ++k)
    {
      state = 1664525u * state + 1013904223u;
      const float u = (float)(state >> 8) / 16777216.0f;
      depth += k > 0 && i % 3 == 0 ? 0.3f * u : 20 * u;
      s->layer_depth[k * PIXELS + i] = i % 7 == k ? INFINITY : depth;
    }
  }
}

/* Thickness of the fog in front of `depth` along the ray of a pixel, by the slab method. */
static double fog_before(const scene* s, int pixel, double depth)
{
  const chi_camera* const c = &s->camera;
  const double px = c->window[0] + (c->window[1] - c->window[0]) * (pixel % WIDTH + 0.5) / WIDTH;
  const double py = c->window[2] + (c->window[3] - c->window[2]) * (pixel / WIDTH + 0.5) / WIDTH;
  const double half = 0.5 * (N - 1);
  double from = 100 - half, to = fmin(100 + half, depth);
  for (int a = 0; a < 2; ++a)
  {
    const double p = a ? py : px;
    if (c->parallel)
    {
      to = fabs(p) <= half ? to : from;
    }
    else
    {
      to = fmin(to, half / fabs(p));
    }
  }
  const double slope = c->parallel ? 1 : sqrt(1 + px * px + py * py);
  return to > from ? -log(1 - (double)s->opacity[1]) * slope * (to - from) : 0;
}

static void a_translucent_plane_in_fog_is_the_closed_form(void)
{
  /* in front of the box, inside on and off slices, at its faces, behind */
  static const float depths[] = { 70, 84.5f, 90.25f, 99.5f, 100.77f, 115.5f, 140 };
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, 1);
    s->layers.count = 1;
    double worst = 0;
    for (size_t d = 0; d < sizeof depths / sizeof depths[0]; ++d)
    {
      set_layer(s, 0, depths[d], red, 0.6f);
      const chi_occlusion_image image = render(s);
      for (int i = 0; i < PIXELS; ++i)
      {
        const double front = exp(-fog_before(s, i, (double)depths[d]));
        const double all = exp(-fog_before(s, i, 1e9));
        for (int c = 0; c < 4; ++c)
        {
          const double fog = c < 3 ? (double)s->rgb[3 + c] : 1;
          const double layer = 0.6 * (c < 3 ? (double)red[c] : 1);
          const double expected = fog * (1 - front) + front * layer + 0.4 * fog * (front - all);
          worst = fmax(worst, fabs(expected - (double)image.rgba[4 * i + c]));
        }
      }
    }
    /* 31 segments of float sums, and an exponential of relative error 1e-6 */
    CHECK_NEAR(worst, 0, 3e-5);
    free_scene(s);
  }
}

/* Volume in front of an opaque surface goes through other code. */
static void an_opaque_layer_ends_the_ray_as_a_surface_does(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, 0);
    set_random_layers(s, 1, 1);
    memcpy(s->depth, s->layer_depth, sizeof s->depth);
    float* const layered = render_copy(s);
    s->frame.layers = NULL;
    s->frame.surface = &s->surface;
    s->params.interactions = 0;
    const chi_occlusion_image front = render(s);
    double worst = 0;
    for (int i = 0; i < 4 * PIXELS; ++i)
    {
      const double alpha = (double)front.rgba[i / 4 * 4 + 3];
      const double hit = s->depth[i / 4] < INFINITY ? 1 : 0;
      const double color = (double)s->layer_rgba[i];
      const double expected = (double)front.rgba[i] + hit * (1 - alpha) * color;
      worst = fmax(worst, fabs(expected - (double)layered[i]));
    }
    CHECK_NEAR(worst, 0, 3e-5); /* an exponential against a power, 30 segments */
    free(layered);
    free_scene(s);
  }
}

/* Blending is linear in each alpha: a layer of alpha a is a part a of an opaque one, which hides
 * the rest, and a part 1 - a of none. So four layers follow from pictures of three. */
static void layers_blend_one_after_the_other(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, 0);
    set_random_layers(s, 4, 0.3f);
    float* const four = render_copy(s);
    for (int i = 0; i < PIXELS; ++i)
    {
      for (int c = 0; c < 4; ++c)
      {
        s->layer_rgba[4 * i + c] /= 0.3f;
      }
    }
    float* const opaque = render_copy(s);
    for (int i = 0; i < PIXELS; ++i)
    {
      s->layer_depth[i] = INFINITY;
    }
    float* const three = render_copy(s);
    set_random_layers(s, 4, 0.3f);
    double worst = 0, difference = 0;
    for (int i = 0; i < 4 * PIXELS; ++i)
    {
      const double a = s->layer_depth[i / 4] < INFINITY ? 0.3 : 0;
      const double expected = a * (double)opaque[i] + (1 - a) * (double)three[i];
      worst = fmax(worst, fabs(expected - (double)four[i]));
      difference = fmax(difference, fabs((double)four[i] - (double)three[i]));
    }
    CHECK_NEAR(worst, 0, 3e-5);
    CHECK(difference > 0.1);
    free(four);
    free(opaque);
    free(three);
    free_scene(s);
  }
}

/* Black fog: what the layer shows is its light alone. */
static void a_layer_receives_the_light_that_a_surface_receives_there(void)
{
  static const float depths[] = { 80, 86, 93.3f, 100, 108.6f, 114, 118, 160 };
  static const int interactions[] = { CHI_VOLUME_TO_VOLUME | CHI_VOLUME_TO_GEOMETRY,
    CHI_VOLUME_TO_GEOMETRY, CHI_VOLUME_TO_VOLUME };
  double darkest = 1;
  for (int test = 0; test < 2 * 3 * 2; ++test)
  {
    scene* const s = make_scene(test & 1, 0);
    memset(s->rgb, 0, sizeof s->rgb);
    s->params.strength = 0.9;
    s->params.half_size = test / 6;
    s->params.interactions = interactions[test / 2 % 3];
    s->layers.count = 1;
    double worst[2] = { 0, 0 }; /* within the planes of light, behind them */
    for (size_t d = 0; d < sizeof depths / sizeof depths[0]; ++d)
    {
      set_layer(s, 0, depths[d], red, 1);
      s->frame.layers = &s->layers;
      s->frame.surface = NULL;
      float* const layered = render_copy(s);
      for (int i = 0; i < PIXELS; ++i)
      {
        s->depth[i] = depths[d];
      }
      s->frame.layers = NULL;
      s->frame.surface = &s->surface;
      const chi_occlusion_image image = render(s);
      for (int i = 0; i < PIXELS; ++i)
      {
        const double front = 1 - (double)image.rgba[4 * i + 3];
        const double expected = front * (double)image.visibility[i] * (double)red[0];
        double* const w = worst + (depths[d] > 116);
        *w = fmax(*w, fabs(expected - (double)layered[4 * i]));
        darkest = fmin(darkest, (double)image.visibility[i]);
      }
      free(layered);
    }
    CHECK_NEAR(worst[0], 0, 3e-5);
    /* A surface behind the volume has the planes go on to it; to a layer light takes one step:
     * linear weights once instead of 1 ... 40 times, measured 0.0079. */
    CHECK_NEAR(worst[1], 0, 0.012);
    free_scene(s);
  }
  CHECK(darkest < 0.8); /* there was something to receive */
}

static void layers_at_or_behind_the_surface_are_hidden(void)
{
  scene* const s = make_scene(0, 0);
  s->frame.surface = &s->surface;
  s->params.strength = 1;
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = i % 2 ? 97 : 103;
  }
  set_layer(s, 0, 103, red, 0.5f);
  set_layer(s, 1, 120, red, 0.5f);
  s->layers.count = 2;
  float* const hidden = render_copy(s);
  s->frame.layers = NULL;
  CHECK(memcmp(hidden, render(s).rgba, 4 * PIXELS * sizeof *hidden) == 0);
  free(hidden);
  free_scene(s);
}

static void what_is_no_layer_changes_no_bit(void)
{
  scene* const s = make_scene(0, 0);
  s->params.strength = 1;
  s->params.skip = 1;
  float* const plain = render_copy(s); /* count 0 */
  s->layers.count = 4;
  set_layer(s, 0, NAN, red, 0.5f);
  set_layer(s, 1, INFINITY, red, 0.5f);
  set_layer(s, 2, -3, red, 0.5f);
  set_layer(s, 3, 100, red, NAN);
  CHECK(memcmp(plain, render(s).rgba, 4 * PIXELS * sizeof *plain) == 0);
  set_layer(s, 3, 100, red, 0);
  CHECK(memcmp(plain, render(s).rgba, 4 * PIXELS * sizeof *plain) == 0);
  /* and a layer in one pixel changes this one alone */
  s->layer_rgba[4 * (3 * PIXELS + 2000) + 3] = 0.5f;
  const float* const one = render(s).rgba;
  int changed = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    changed += memcmp(one + 4 * i, plain + 4 * i, 4 * sizeof *plain) != 0;
  }
  CHECK(changed == 1);
  free(plain);
  free_scene(s);
}

static void layers_come_in_any_order(void)
{
  scene* const s = make_scene(1, 0);
  s->layers.count = 2;
  set_layer(s, 0, 101, red, 0.5f);
  set_layer(s, 1, 95, s->rgb, 0.5f);
  float* const unsorted = render_copy(s);
  set_layer(s, 1, 101, red, 0.5f);
  set_layer(s, 0, 95, s->rgb, 0.5f);
  const float* const sorted = render(s).rgba;
  double worst = 0;
  for (int i = 0; i < 4 * PIXELS; ++i)
  {
    worst = fmax(worst, fabs((double)unsorted[i] - (double)sorted[i]));
  }
  CHECK_NEAR(worst, 0, 1e-6); /* colours are added in the order of the arrays */
  free(unsorted);
  free_scene(s);
}

/* Edges use the layers' arrays here, and have the surface's depth. */
static void use_edges(scene* s, float share, float end)
{
  static float ends[PIXELS];
  for (int i = 0; i < PIXELS; ++i)
  {
    ends[i] = end;
    s->layer_depth[i] = s->depth[i];
    for (int c = 0; c < 4; ++c)
    {
      s->layer_rgba[4 * i + c] = share * (c < 3 ? red[c] : 1);
    }
  }
  s->frame.surface = &s->surface;
  s->surface.end = ends;
  s->surface.edge_depth = s->layer_depth;
  s->surface.edge_rgba = s->layer_rgba;
}

static void a_part_of_a_pixel_is_that_part_of_both_pictures(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, 0);
    for (int i = 0; i < PIXELS; ++i)
    {
      s->depth[i] = 85 + (float)(i % 37) * 0.6f;
    }
    s->frame.surface = &s->surface;
    float* const near = render_copy(s);
    use_edges(s, 0.25f, 111);
    float* const both = render_copy(s);
    s->surface.edge_depth = s->surface.edge_rgba = NULL;
    const float* const far = render(s).rgba;
    double worst = 0;
    for (int i = 0; i < 4 * PIXELS; ++i)
    {
      const double hit = (1 - (double)near[i / 4 * 4 + 3]) * (i % 4 < 3 ? (double)red[i % 4] : 1);
      const double expected = 0.25 * ((double)near[i] + hit) + 0.75 * (double)far[i];
      worst = fmax(worst, fabs(expected - (double)both[i]));
    }
    CHECK_NEAR(worst, 0, 3e-5);
    free(near);
    free(both);
    free_scene(s);
  }
}

/* A tilted surface blocks its own light but for the rise that the receiver's depth allows for. */
static void an_edge_receives_as_the_surface_that_it_is_part_of(void)
{
  scene* const s = make_scene(0, 0);
  memset(s->rgb, 0, sizeof s->rgb);
  s->params.strength = 1;
  s->params.vicinity_samples = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = 92 + (float)(i % WIDTH) * 0.2f;
  }
  s->frame.surface = &s->surface;
  float* const alpha = render_copy(s);
  float visibility[PIXELS];
  memcpy(visibility, render(s).visibility, sizeof visibility);
  use_edges(s, 1, INFINITY);
  const chi_occlusion_image image = render(s);
  double worst = 0, darkest = 1;
  for (int i = 0; i < PIXELS; ++i)
  {
    const double front = 1 - (double)alpha[4 * i + 3];
    const double expected = front * (double)visibility[i] * (double)red[0];
    worst = fmax(worst, fabs(expected - (double)image.rgba[4 * i]));
    darkest = fmin(darkest, (double)visibility[i]);
    CHECK(image.visibility[i] == 1); /* nothing behind it */
  }
  CHECK_NEAR(worst, 0, 3e-5);
  CHECK(darkest < 0.9);
  free(alpha);
  free_scene(s);
}

static void edges_sort_in_with_layers(void)
{
  scene* const s = make_scene(1, 0);
  set_random_layers(s, 4, 0.3f);
  float* const layers = render_copy(s);
  /* the third layer as an edge */
  float depth[PIXELS], rgba[4 * PIXELS], none[PIXELS];
  memcpy(depth, s->layer_depth + 2 * PIXELS, sizeof depth);
  memcpy(rgba, s->layer_rgba + 8 * PIXELS, sizeof rgba);
  for (int i = 0; i < PIXELS; ++i)
  {
    s->layer_depth[2 * PIXELS + i] = none[i] = INFINITY;
  }
  s->surface = (chi_surface_view){
    .struct_size = sizeof s->surface, .depth = none, .edge_depth = depth, .edge_rgba = rgba
  };
  s->frame.surface = &s->surface;
  const float* const mixed = render(s).rgba;
  double worst = 0;
  for (int i = 0; i < 4 * PIXELS; ++i)
  {
    worst = fmax(worst, fabs((double)layers[i] - (double)mixed[i]));
  }
  CHECK_NEAR(worst, 0, 3e-5);
  free(layers);
  free_scene(s);
}

static void without_a_volume_layers_are_blended_alone(void)
{
  scene* const s = make_scene(1, 0);
  s->frame.volume = NULL;
  s->frame.transfer = NULL;
  s->layers.count = 2;
  set_layer(s, 0, 95, red, 0.5f);
  set_layer(s, 1, 101, s->rgb, 0.25f);
  const chi_occlusion_image image = render(s);
  for (int c = 0; c < 3; ++c)
  {
    const double expected = 0.5 * (double)red[c] + 0.5 * 0.25 * (double)s->rgb[c];
    CHECK_NEAR((double)image.rgba[4 * 99 + c], expected, 1e-6);
  }
  CHECK_NEAR((double)image.rgba[4 * 99 + 3], 1 - 0.5 * 0.75, 1e-6);
  free_scene(s);
}

static void skipping_changes_nothing_visible(void)
{
  scene* const s = make_scene(0, 0);
  s->opacity[1] = 0.6f; /* rays end inside */
  s->params.strength = 1;
  set_random_layers(s, 4, 0.4f);
  float* const all = render_copy(s);
  s->params.skip = 1;
  const float* const some = render(s).rgba;
  double worst = 0;
  for (int i = 0; i < 4 * PIXELS; ++i)
  {
    worst = fmax(worst, fabs((double)all[i] - (double)some[i]));
  }
  CHECK(worst <= 1.0 / 255);
  free(all);
  free_scene(s);
}

static void any_schedule_gives_the_same_bits(void)
{
  scene* const s = make_scene(0, 0);
  s->params.strength = 1;
  s->params.skip = 1;
  set_random_layers(s, 4, 0.4f);
  float* const serial = render_copy(s);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  ++s->layers.version;
  chi_occlusion_image image;
  CHECK(chi_occlusion_render(&backwards, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  CHECK(memcmp(serial, image.rgba, 4 * PIXELS * sizeof *serial) == 0);
  free(serial);
  free_scene(s);
}

static void a_new_version_is_drawn_and_an_old_one_kept(void)
{
  scene* const s = make_scene(0, 0);
  chi_occlusion_stats stats;
  s->params.skip = CHI_SKIP_UNCHANGED;
  set_random_layers(s, 2, 0.4f);
  render(s);
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused == 1);
  ++s->layers.version;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused == 0);
  s->layers.count = 1;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_stats(s->engine, &stats);
  CHECK(stats.reused == 0);
  free_scene(s);
}

static void bad_layers_are_an_invalid_argument(void)
{
  scene* const s = make_scene(0, 0);
  s->layers.count = CHI_MAX_LAYERS + 1;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->layers.count = -1;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->layers.count = 1;
  s->layers.depth = NULL;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->layers.depth = s->layer_depth;
  s->layers.rgba = NULL;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->layers.rgba = s->layer_rgba;
  s->frame.surface = &s->surface;
  s->surface.edge_depth = s->layer_depth; /* without colours */
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  s->surface.edge_depth = NULL;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  free_scene(s);
}

int main(void)
{
  a_translucent_plane_in_fog_is_the_closed_form();
  an_opaque_layer_ends_the_ray_as_a_surface_does();
  layers_blend_one_after_the_other();
  a_layer_receives_the_light_that_a_surface_receives_there();
  layers_at_or_behind_the_surface_are_hidden();
  what_is_no_layer_changes_no_bit();
  layers_come_in_any_order();
  a_part_of_a_pixel_is_that_part_of_both_pictures();
  an_edge_receives_as_the_surface_that_it_is_part_of();
  edges_sort_in_with_layers();
  without_a_volume_layers_are_blended_alone();
  skipping_changes_nothing_visible();
  any_schedule_gives_the_same_bits();
  a_new_version_is_drawn_and_an_old_one_kept();
  bad_layers_are_an_invalid_argument();
  return chi_test_report();
}
