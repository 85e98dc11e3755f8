/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * What chi_occlusion_describe hands out is enough to draw the frame: another engine that knows no
 * more makes the picture of chi_occlusion_render. Where a plan says that nothing happens, nothing
 * does; its versions and features say what they should.
 */

#include "occlusion_blobs.h"
#include "occlusion_executor.h"

enum
{
  ENTRIES = 256
};

/* Fog, and in it a ball behind a step of opacity; with surfaces before, in, behind it, and none. */
typedef struct fogged
{
  scene* s;
  float rgb[3 * ENTRIES], opacity[ENTRIES];
} fogged;

static void make_fogged(fogged* f, int parallel, int with_surface)
{
  f->s = make_whole(parallel);
  for (int i = 0; i < N * N * N; ++i)
  {
    const double x = i % N - 17, y = i / N % N - 22, z = i / N / N - 19;
    f->s->samples[i] = (float)(1 - sqrt(x * x + y * y + z * z) / 40);
  }
  for (int i = 0; i < ENTRIES; ++i)
  {
    const double value = i / (ENTRIES - 1.0);
    f->opacity[i] = value > 0.75 ? 0.8f : 0.03f; /* within 10 voxels of the middle */
    f->rgb[3 * i] = (float)value;
    f->rgb[3 * i + 1] = 0.5f;
    f->rgb[3 * i + 2] = (float)(1 - value);
  }
  for (int i = 0; i < PIXELS; ++i)
  {
    static const float depth[4] = { 95, 108, 300, INFINITY };
    const int x = i % WIDTH, y = i / WIDTH;
    f->s->depth[i] = depth[x / 18] + 0.05f * (float)y; /* tilted */
  }
  f->s->transfer = (chi_transfer_view){ .struct_size = sizeof f->s->transfer,
    .rgb = f->rgb,
    .opacity = f->opacity,
    .count = ENTRIES,
    .range = { 0, 1 },
    .unit_distance = 1,
    .version = 1 };
  f->s->params.color_integration = CHI_COLOR_MIDDLE;
  f->s->frame.surface = with_surface ? &f->s->surface : NULL;
}

static chi_occlusion_plan describe(scene* s)
{
  chi_occlusion_plan plan;
  memset(&plan, 0, sizeof plan);
  CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &plan) == CHI_OK);
  return plan;
}

/* The plan of a frame, and what is drawn of it by the executor; free it. */
static double* draw(const chi_occlusion_plan* plan, int everywhere)
{
  CHECK((plan->features & ~(uint64_t)CHI_FEATURE_PUBLISHED) == 0 && plan->fields == 1 &&
    plan->channels == 1 && plan->vicinity_radius[0] * plan->vicinity_samples == 0 &&
    (!plan->scalars || plan->type == CHI_F32));
  return execute_plan(plan, everywhere);
}

static double largest_difference(const double* executed, const chi_occlusion_image* image)
{
  double most = 0;
  for (int i = 0; i < image->width * image->height; ++i)
  {
    const double* const pixel = executed + EXECUTED_CHANNELS * i;
    for (int c = 0; c < 3; ++c)
    {
      most = fmax(most, fabs(pixel[c] - (double)image->rgba[4 * i + c]));
    }
    most = fmax(most, fabs(1 - pixel[3] - (double)image->rgba[4 * i + 3]));
    most = fmax(most, fabs(pixel[4] - (double)image->visibility[i]));
  }
  return most;
}

/*
 * Positions are floats of up to 40 voxels, 4e-6; the steepest opacity is 1.6 a voxel, on the way of
 * the eye and of the light; sums of some 100 floats of up to 1 add 1e-5. In perspective the
 * engine's path lengths are linear over h = 31 light pixels, through Gauss's points: off by h^2 /
 * 12 at most, as |L''| <= 1; V = exp(-tau L) by no more than that over e.
 */
static double rounding(const chi_occlusion_plan* plan)
{
  const double h = 31 * plan->light_scale * fmax(fabs(plan->slope_dx), fabs(plan->slope_dy));
  return 1e-4 + h * h / 12 / exp(1);
}

static void a_plan_carried_out_is_the_picture(void)
{
  for (int k = 0; k < 32; ++k)
  {
    fogged f;
    const int parallel = k & 1, half_size = k >> 1 & 1, skips = k >> 2 & 1, surface = k >> 3 & 1;
    make_fogged(&f, parallel, surface);
    f.s->params.method = k >> 4 ? CHI_OCCLUSION_PUBLISHED : CHI_OCCLUSION_ORDINATES;
    f.s->params.half_size = half_size;
    f.s->params.skip = skips ? CHI_SKIP_ALL : CHI_SKIP_NOTHING;
    f.s->params.sample_distance = surface ? 0.5 : 1;
    f.s->params.strength = surface ? 0.8 : 1;
    add_plane(f.s, 0.2, -0.1, -1, -92);
    const chi_occlusion_plan plan = describe(f.s);
    const chi_occlusion_image image = render(f.s);
    double* const executed = draw(&plan, 0);
    CHECK(largest_difference(executed, &image) < rounding(&plan));
    double darkest = 1, most = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      darkest = fmin(darkest, (double)image.visibility[i]);
      most = fmax(most, (double)image.rgba[4 * i + 3]);
    }
    CHECK(most > 0.9 && (!surface || darkest < 0.5)); /* there is something to compare */
    free(executed);
    free_scene(f.s);
  }
}

/* Pieces of 32 light pixels, and of 16 pixels, end beyond the rim: what they have there is no
 * light's business. */
static void what_lies_beyond_the_rim_blocks_no_light(void)
{
  for (int k = 0; k < 8; ++k)
  {
    fogged f;
    make_fogged(&f, k & 1, 0);
    f.s->params.half_size = k >> 1 & 1;
    f.s->params.method = k >> 2 ? CHI_OCCLUSION_PUBLISHED : CHI_OCCLUSION_ORDINATES;
    f.s->params.light_direction[0] = 0.5; /* from the right, where these pieces are */
    f.s->params.light_direction[2] = 1;
    f.s->camera.width = 67;
    f.s->camera.height = 61;
    for (int i = 0; i < 4; ++i)
    {
      f.s->camera.window[i] *= 0.3; /* the volume goes on to all sides */
    }
    const chi_occlusion_plan plan = describe(f.s);
    const chi_occlusion_image image = render(f.s);
    double* const executed = draw(&plan, 0);
    CHECK(largest_difference(executed, &image) < rounding(&plan));
    for (int corner = 0; corner < 4; ++corner)
    {
      CHECK(image.rgba[4 * (66 * (corner & 1) + 67 * 60 * (corner >> 1)) + 3] > 0.1f);
    }
    free(executed);
    free_scene(f.s);
  }
}

static void rectangles_leave_nothing_out(void)
{
  for (int k = 0; k < 10; ++k)
  {
    fogged f;
    make_fogged(&f, k & 1, k >> 1 & 1);
    f.s->params.half_size = k >> 2 & 1;
    for (int i = 0; i < ENTRIES; ++i)
    {
      f.opacity[i] *= f.opacity[i] < 0.5f && k < 6 ? 0 : 1; /* the ball alone, or in fog */
    }
    if (k >= 8) /* a shadow on its way to a small thing behind, and nothing else */
    {
      f.s->frame.volume = NULL;
      f.s->frame.surface = &f.s->surface;
      for (int i = 0; i < PIXELS; ++i)
      {
        const int x = i % WIDTH, y = i / WIDTH;
        f.s->depth[i] = x < 40 ? 95 : abs(x - 50) < 3 && abs(y - 32) < 3 ? 115 : INFINITY;
      }
    }
    const chi_occlusion_plan plan = describe(f.s);
    double* const less = draw(&plan, 0);
    double* const all = draw(&plan, 1);
    double most = 0;
    for (int i = 0; i < EXECUTED_CHANNELS * PIXELS; ++i)
    {
      most = fmax(most, fabs(less[i] - all[i]));
    }
    /* where light is 1 it stays so, but for weights that are floats, 1.2e-7 a slab */
    CHECK(most <= 1.2e-7 * (double)plan.slabs);
    size_t samples = 0, light = 0;
    for (int64_t g = 0; g < plan.slabs; ++g)
    {
      const chi_rect *const a = plan.samples + g, *const b = plan.light + g;
      const chi_rect* const c[4] = { a, b, plan.blockers + g, plan.receivers + g };
      for (int r = 0; r < 4; ++r)
      {
        const int is_light = r == 1 || r == 2;
        CHECK(c[r]->x0 >= 0 && c[r]->y0 >= 0 &&
          c[r]->x1 <= (is_light ? plan.light_width : plan.width) &&
          c[r]->y1 <= (is_light ? plan.light_height : plan.height));
      }
      samples += (size_t)(a->x1 - a->x0) * (size_t)(a->y1 - a->y0);
      light += (size_t)(b->x1 - b->x0) * (size_t)(b->y1 - b->y0);
    }
    CHECK((samples > 0) == (k < 8) && samples < PIXELS * (size_t)plan.slabs); /* some is spared */
    const size_t buffers = (size_t)plan.light_width * (size_t)plan.light_height;
    CHECK(light > 0 && (k == 6 || k == 7 || light < buffers * (size_t)plan.slabs));
    free(less);
    free(all);
    free_scene(f.s);
  }
}

static void versions_change_with_what_has_changed(void)
{
  enum
  {
    FRAME = 1,
    SAMPLES = 2,
    TABLES = 4
  };
  fogged f;
  make_fogged(&f, 1, 1);
  scene* const s = f.s;
  chi_occlusion_plan last = describe(s);
  CHECK(last.struct_size == sizeof last);
  float* const moved = calloc(PIXELS, sizeof *moved);
  for (int k = 0; k < 12 && moved; ++k)
  {
    int expected = FRAME;
    switch (k)
    {
      case 0: /* nothing */
        expected = 0;
        break;
      case 1:
        s->camera.window[0] -= 1;
        break;
      case 2:
        s->params.strength = 0.5;
        break;
      case 3:
        s->params.directions = 8;
        break;
      case 4:
        s->surface.version = 2;
        break;
      case 5:
        s->surface.depth = moved;
        break;
      case 6:
        add_plane(s, 0, 0, 1, 105);
        break;
      case 7:
        s->volume.index_to_world[3] += 0.25;
        break;
      case 8:
        s->transfer.version = 2;
        expected = FRAME | TABLES;
        break;
      case 9:
        s->transfer.unit_distance = 2;
        expected = FRAME | TABLES;
        break;
      case 10: /* the range of values makes the tables' */
        s->volume.version += 100;
        expected = FRAME | SAMPLES | TABLES;
        break;
      default: /* a picture in between */
        render(s);
        expected = 0;
        break;
    }
    const chi_occlusion_plan plan = describe(s);
    CHECK((plan.frame_version != last.frame_version) == ((expected & FRAME) != 0));
    CHECK((plan.volume_version != last.volume_version) == ((expected & SAMPLES) != 0));
    CHECK((plan.table_version != last.table_version) == ((expected & TABLES) != 0));
    chi_occlusion_stats stats;
    chi_occlusion_get_stats(s->engine, &stats);
    CHECK(stats.reused == !expected);
    last = plan;
  }
  free(moved);
  free_scene(s);
}

static void regions_are_planes_in_index_units(void)
{
  fogged f;
  make_fogged(&f, 0, 0);
  CHECK(describe(f.s).cut == NULL);
  chi_crop_view regions;
  static const double low[3] = { 5, 6, 7 }, high[3] = { 30, 28, 26 };
  crop(f.s, &regions, low, high, 0x1234567);
  const chi_occlusion_plan plan = describe(f.s);
  CHECK(plan.cut && plan.cut->regions == 0x1234567 && plan.cut->grids == 0 && !plan.cut->whole);
  CHECK(plan.cut->ahead > 0);
  for (int k = 0; k < 24; ++k)
  {
    const int plane = k / 4, a = plane / 2;
    const double place = plane & 1 ? high[a] : low[a];
    const double expected = k % 4 == a ? 1 : k % 4 == 3 ? -place : 0;
    CHECK_NEAR((double)plan.cut->plane[plane][k % 4], expected, 4e-6); /* a float of 30 */
  }
  free_scene(f.s);
}

/* Bits, tables of voxels, and that they keep their version where only functions change. */
static void masks_and_labels_are_what_was_given(void)
{
  static uint8_t values[N * N * N], cells[(N - 1) * (N - 1) * (N - 1)];
  static const uint8_t table_of_value[3] = { 1, 0, 2 };
  for (int i = 0; i < N * N * N; ++i)
  {
    values[i] = (uint8_t)(i * 7 % 5); /* 3 and 4 are beyond table_of_value */
    cells[i % (int)sizeof cells] = (uint8_t)(i % 3 == 0 ? 2 : 5);
  }
  fogged f;
  make_fogged(&f, 0, 0);
  chi_mask_view mask = { .struct_size = sizeof mask,
    .values = values,
    .type = CHI_U8,
    .stride = 1,
    .cell_flags = cells,
    .cell_bits = 2,
    .version = 1 };
  f.s->frame.mask = &mask;
  const chi_occlusion_plan plan = describe(f.s);
  CHECK(plan.cut && plan.cut->regions == CHI_CROP_ALL_REGIONS && plan.cut->grids == 2);
  CHECK(!plan.labels && plan.table_entries == plan.entries);
  for (int k = 0; k < plan.cut->grids; ++k)
  {
    const chi_plan_grid* const grid = plan.cut->grid + k;
    const int voxels = grid->offset > 0, side = voxels ? N : N - 1;
    CHECK(grid->step_y == side && grid->step_z == side * side && grid->last[2] == side - 1);
    int differ = 0;
    for (int n = 0; n < side * side * side; ++n)
    {
      const int stays = (int)(grid->bits[n >> 5] >> (n & 31) & 1);
      differ += stays != (voxels ? values[n] > 0 : !(cells[n] & 2));
    }
    CHECK(differ == 0);
  }
  f.s->transfer.version = 2;
  const chi_occlusion_plan edited = describe(f.s);
  CHECK(edited.mask_version == plan.mask_version && edited.table_version != plan.table_version);

  static float rgb[9 * ENTRIES], opacity[3 * ENTRIES];
  f.s->transfer.rgb = rgb;
  f.s->transfer.opacity = opacity;
  f.s->transfer.table_count = 3;
  mask.table_of_value = table_of_value;
  mask.value_count = 3;
  mask.cell_flags = NULL;
  const chi_occlusion_plan labelled = describe(f.s);
  CHECK(labelled.mask_version != plan.mask_version && !labelled.cut && labelled.labels);
  CHECK(labelled.table_entries == ENTRIES && labelled.entries == 3 * ENTRIES);
  int differ = 0;
  for (int i = 0; labelled.labels && i < N * N * N; ++i)
  {
    differ += labelled.labels[i] != (values[i] < 3 ? table_of_value[values[i]] : 0);
  }
  CHECK(differ == 0);
  free_scene(f.s);
}

/* Components come apart, each with its place in its own table. */
static void components_have_samples_and_tables_of_their_own(void)
{
  static float both[2 * N * N * N];
  for (int i = 0; i < N * N * N; ++i)
  {
    both[2 * i] = (float)(i % 101) / 101;
    both[2 * i + 1] = (float)(i % 37);
  }
  fogged f;
  make_fogged(&f, 0, 0);
  chi_transfer_view second = f.s->transfer;
  second.range[1] = 36;
  second.count = ENTRIES / 2;
  const chi_components components = {
    .struct_size = sizeof components, .count = 2, .transfer = { &second }, .weight = { 1, 0.25 }
  };
  CHECK(!describe(f.s).components);
  f.s->frame.components = &components;
  f.s->volume.scalars = both;
  f.s->volume.stride = 2 * sizeof(float);
  const chi_occlusion_plan plan = describe(f.s);
  CHECK(plan.components && plan.components->count == 1 && !plan.components->dependent);
  CHECK(plan.components->weight[0] == 1 && plan.components->weight[1] == 0.25f);
  const chi_plan_component* const more = plan.components->more;
  CHECK(more->entries == ENTRIES / 2 && more->end == ENTRIES / 2 - 1 && more->table && more->rgba);
  int differ = 0;
  for (int i = 0; i < N * N * N; ++i)
  {
    const double own = (double)((const float*)plan.scalars)[i];
    const double other = (double)((const float*)more->scalars)[i];
    const double place = (other - (double)more->base) * (double)more->scale + (double)more->offset;
    differ += own != (double)both[2 * i];
    differ += fabs(place - (double)both[2 * i + 1] / 36 * (ENTRIES / 2 - 1)) > 1e-4; /* floats */
  }
  CHECK(differ == 0);
  free_scene(f.s);
}

/* A frame with one feature, by its bit; 0: none, though it comes near. */
static void features_are_those_of_the_frame(void)
{
  static const uint64_t all[] = { 0, CHI_FEATURE_PUBLISHED, CHI_FEATURE_LAYERS, CHI_FEATURE_CROP,
    CHI_FEATURE_COLORED, CHI_FEATURE_SHADING, CHI_FEATURE_GRADIENT_OPACITY, CHI_FEATURE_EDGES,
    CHI_FEATURE_TRANSFER_PLANE, CHI_FEATURE_MASK, CHI_FEATURE_REDUCTION, CHI_FEATURE_COMPONENTS };
  static float two[2 * N * N * N], layer[4 * PIXELS], ramp[2] = { 0.5f, 1 }, plane[16];
  static uint8_t hidden[N * N * N];
  for (size_t k = 0; k < sizeof all / sizeof all[0]; ++k)
  {
    const uint64_t feature = all[k];
    fogged f;
    make_fogged(&f, 1, 1);
    scene* const s = f.s;
    chi_crop_view regions;
    static const double low[3] = { 5, 5, 5 }, high[3] = { 30, 30, 30 };
    crop(s, &regions, low, high, feature == CHI_FEATURE_CROP ? 1 : CHI_CROP_ALL_REGIONS);
    const chi_layers_view layers = { .struct_size = sizeof layers,
      .depth = layer,
      .rgba = layer,
      .count = feature == CHI_FEATURE_LAYERS };
    s->frame.layers = &layers;
    const chi_mask_view mask = { .struct_size = sizeof mask,
      .values = feature == CHI_FEATURE_MASK ? hidden : NULL,
      .type = CHI_U8,
      .stride = 1 };
    s->frame.mask = &mask;
    const chi_shading_view shading = { .struct_size = sizeof shading };
    s->frame.shading = feature == CHI_FEATURE_SHADING ? &shading : NULL;
    const chi_components components = {
      .struct_size = sizeof components, .count = 2, .transfer = { &s->transfer }, .weight = { 1, 1 }
    };
    if (feature == CHI_FEATURE_COMPONENTS)
    {
      s->frame.components = &components;
      s->volume.scalars = two;
      s->volume.stride = 2 * sizeof(float);
    }
    s->surface.end = feature == CHI_FEATURE_EDGES ? s->depth : NULL;
    s->transfer.gradient_opacity = feature == CHI_FEATURE_GRADIENT_OPACITY ? ramp : NULL;
    s->transfer.gradient_count = 2;
    s->transfer.gradient_end = 1;
    s->transfer.plane = feature == CHI_FEATURE_TRANSFER_PLANE ? plane : NULL;
    s->transfer.plane_count[0] = s->transfer.plane_count[1] = 2;
    s->transfer.plane_range[1] = 1;
    s->params.method = feature == CHI_FEATURE_PUBLISHED ? CHI_OCCLUSION_PUBLISHED : 0;
    s->params.reduction = feature == CHI_FEATURE_REDUCTION ? 2 : 1;
    s->params.colored_attenuation = 1;
    for (int c = 0; c < 3; ++c)
    {
      s->params.attenuation[c] = feature == CHI_FEATURE_COLORED ? 0.5 + 0.1 * c : 0.5;
    }
    CHECK(chi_occlusion_features(&s->frame) == feature);
    const chi_occlusion_plan plan = describe(s);
    CHECK(plan.features == feature);
    const char* const name = chi_occlusion_feature_name(feature);
    CHECK((feature == 0) == !strcmp(name, chi_occlusion_feature_name(CHI_FEATURE_OTHER)));
    for (size_t j = 0; j < k; ++j)
    {
      CHECK(strcmp(name, chi_occlusion_feature_name(all[j])) != 0);
    }
    free_scene(s);
  }
}

static void what_cannot_be_drawn_cannot_be_described(void)
{
  fogged f;
  make_fogged(&f, 1, 0);
  chi_occlusion_plan plan;
  CHECK(chi_occlusion_describe(NULL, NULL, &f.s->frame, &plan) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_occlusion_describe(NULL, f.s->engine, &f.s->frame, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  f.s->params.directions = 0;
  CHECK(
    chi_occlusion_describe(NULL, f.s->engine, &f.s->frame, &plan) == CHI_ERROR_INVALID_ARGUMENT);
  f.s->params.directions = 16;
  f.s->params.sample_distance = 1e-9;
  CHECK(chi_occlusion_describe(NULL, f.s->engine, &f.s->frame, &plan) == CHI_ERROR_TOO_LARGE);
  free_scene(f.s);
}

int main(void)
{
  a_plan_carried_out_is_the_picture();
  what_lies_beyond_the_rim_blocks_no_light();
  rectangles_leave_nothing_out();
  versions_change_with_what_has_changed();
  regions_are_planes_in_index_units();
  masks_and_labels_are_what_was_given();
  components_have_samples_and_tables_of_their_own();
  features_are_those_of_the_frame();
  what_cannot_be_drawn_cannot_be_described();
  return chi_test_report();
}
