/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Stress cases whose invariant is a picture of the same scene in friendlier numbers. */

#include "occlusion_stress.h"

#include "counting_host.h"
#include "occlusion_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  SIZE = 24, /* voxels along each axis */
  VOXELS = SIZE * SIZE * SIZE,
  WIDTH = 56,
  PIXELS = WIDTH * WIDTH
};

/* Two balls of 24^3, a tilted surface through them, seen from the side. */
typedef struct scene
{
  const chi_exec* exec;
  stress_report report;
  void* user;
  chi_occlusion* engine;
  reference_volume volume;
  reference_frame *frame, *original;
  float *depth, *depth0; /* [PIXELS] now, and of the original */
  float *now, *kept;     /* [PIXELS][5] RGBA and visibility */
} scene;

static void tell(const scene* s, const char* name, double parameter, const char* invariant,
  double measured, double bound)
{
  const stress_row row = { name, parameter, invariant, measured, bound };
  s->report(s->user, &row);
}

static int draw(scene* s, float* out)
{
  chi_occlusion_image image;
  const chi_status status = chi_occlusion_render(s->exec, s->engine, &s->frame->frame);
  chi_occlusion_get_image(s->engine, &image);
  for (int i = 0; status == CHI_OK && i < PIXELS; ++i)
  {
    memcpy(out + 5 * i, image.rgba + 4 * i, 4 * sizeof *out);
    out[5 * i + 4] = image.visibility[i];
  }
  return status == CHI_OK;
}

/* Starts anew from the original scene, and draws it into `kept`. */
static int restart(scene* s, int parallel)
{
  const double center[3] = { 11.5, 11.5, 11.5 }, turn[2] = { 30, 20 };
  const reference_view view = reference_turned_view(center, 60, turn, 40, WIDTH, parallel);
  reference_frame* const f = s->frame;
  reference_frame_init(f, &s->volume, &view, 100);
  f->transfer.unit_distance = 1.5;
  for (int i = 0; i < REFERENCE_ENTRIES; ++i)
  {
    f->rgb[3 * i] = (float)i / (REFERENCE_ENTRIES - 1);
    f->rgb[3 * i + 1] = 0.5f;
  }
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth0[i] = i % WIDTH < 36 ? (float)(58 + 0.3 * (i % WIDTH)) : INFINITY;
  }
  memcpy(s->depth, s->depth0, PIXELS * sizeof *s->depth);
  f->params.bias = -1;
  f->surface =
    (chi_surface_view){ .struct_size = sizeof f->surface, .depth = s->depth, .version = 1 };
  f->frame.surface = &f->surface;
  const int ok = draw(s, s->kept);
  memcpy(s->original, f, sizeof *f);
  return ok;
}

/* Draws the changed scene; mean and largest difference to the kept picture, NaN where there is no
 * picture or it is not finite. */
static void compare(scene* s, double* mean, double* worst)
{
  ++s->frame->volume.version;
  ++s->frame->transfer.version;
  ++s->frame->surface.version;
  *mean = *worst = draw(s, s->now) ? 0 : NAN;
  for (int i = 0; i < 5 * PIXELS && *worst == *worst; ++i)
  {
    const double d = fabs((double)s->now[i] - (double)s->kept[i]);
    *worst = d <= *worst ? *worst : d;
    *mean += d / (5 * PIXELS);
  }
  *mean = *worst == *worst ? *mean : NAN;
}

/*
 * A depth that rounds to the other side of a slab moves one pixel's blocker by that slab: few
 * pixels may differ by a step of light, none by more; the others by their floats' last bits.
 */
static void tell_same(scene* s, const char* name, double parameter)
{
  double mean, worst;
  compare(s, &mean, &worst);
  tell(s, name, parameter, "the same picture, mean", mean, 1e-5);
  tell(s, name, parameter, "the same picture, worst pixel", worst, 0.02);
}

/* All lengths times `scale`, then everything moved by `far` along each axis. */
static void transform(scene* s, double scale, double far)
{
  reference_frame* const f = s->frame;
  const reference_frame* const from = s->original;
  for (int i = 0; i < 12; ++i)
  {
    f->volume.index_to_world[i] = scale * from->volume.index_to_world[i];
    f->camera.world_to_eye[i] = from->camera.world_to_eye[i] * (i % 4 == 3 ? scale : 1);
  }
  for (int r = 0; r < 3; ++r)
  {
    f->volume.index_to_world[4 * r + 3] += far;
    for (int c = 0; c < 3; ++c)
    {
      f->camera.world_to_eye[4 * r + 3] -= far * from->camera.world_to_eye[4 * r + c];
    }
  }
  for (int i = 0; i < 4; ++i)
  {
    f->camera.window[i] = from->camera.window[i] * (from->camera.parallel ? scale : 1);
  }
  f->camera.near_depth = from->camera.near_depth * scale;
  f->transfer.unit_distance = from->transfer.unit_distance * scale;
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = (float)(scale * (double)s->depth0[i]);
  }
}

static void extents_and_offsets(scene* s)
{
  static const double far[3] = { 1e5, 1e7, -1e7 };
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    if (!restart(s, parallel))
    {
      continue;
    }
    for (int power = -9; power <= 9; power += 3)
    {
      transform(s, pow(10, power), 0);
      tell_same(
        s, parallel ? "voxel's size, parallel" : "voxel's size, perspective", pow(10, power));
    }
    for (int k = 0; k < 3; ++k)
    {
      transform(s, 1, far[k]);
      tell_same(
        s, parallel ? "coordinates moved, parallel" : "coordinates moved, perspective", far[k]);
    }
    transform(s, 1e-3, 1e7); /* 1e7 is 2^-29 of a voxel in doubles there: 2e-9 / 1e-3 */
    tell_same(s, "voxels of 0.001, coordinates moved", 1e7);
  }
}

/* Nothing lies before the scene, so where clipping begins cannot matter. */
static void near_and_far(scene* s)
{
  for (int power = -9; power <= -1; power += 2)
  {
    if (restart(s, 0))
    {
      s->frame->camera.near_depth = 100 * pow(10, power);
      tell_same(s, "near plane over the scene's depth", pow(10, power));
    }
  }
  /* Geometry far behind: where the volume ends the light does not change any more. */
  static const double behind[3] = { 1e3, 1e5, 1e7 };
  for (int k = 0; k < 3; ++k)
  {
    if (!restart(s, 1))
    {
      continue;
    }
    double worst = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      s->depth[i] = (float)(60 * behind[k]);
    }
    ++s->frame->surface.version;
    const int ok = draw(s, s->now);
    for (int i = 0; ok && i < PIXELS; ++i)
    {
      /* parallel light comes from beyond the window's sides there */
      worst = fmax(worst, fabs(1 - (double)s->now[5 * i + 4]));
    }
    tell(s, "geometry's depth over the volume's", behind[k], "unshadowed", ok ? worst : NAN, 1e-6);
  }
}

/* Darker or as dark, pixel by pixel, as the extinction grows; rays end at alpha 0.998. */
static void more_extinction(scene* s)
{
  if (!restart(s, 0))
  {
    return;
  }
  s->frame->transfer.unit_distance = 1.5e13;
  double alpha = 0, light = 0;
  int ok = draw(s, s->kept);
  for (int power = -11; power <= 13 && ok; ++power)
  {
    s->frame->transfer.unit_distance = 1.5 * pow(10, -power);
    ++s->frame->transfer.version;
    ok = draw(s, s->now);
    for (int i = 0; ok && i < PIXELS; ++i)
    {
      const double was = (double)s->kept[5 * i + 3], is = (double)s->now[5 * i + 3];
      alpha = fmax(alpha, fmin(was, 0.998) - is);
      light =
        fmax(light, (1 - is) * (double)s->now[5 * i + 4] - (1 - was) * (double)s->kept[5 * i + 4]);
      ok = ok && isfinite(is) && isfinite(s->now[5 * i]) && isfinite(s->now[5 * i + 4]);
    }
    memcpy(s->kept, s->now, 5 * PIXELS * sizeof *s->now);
  }
  tell(s, "extinction times 1e-12 ... 1e12", 1e12, "alpha grows, loss", ok ? alpha : NAN, 1e-6);
  /* Behind what is opaque V is not asked for: so what of the surface reaches the eye. Half-size
   * light is read by a parabola, which may overshoot by 1/12 of a step. */
  tell(s, "extinction times 1e-12 ... 1e12", 1e12, "light of the surface falls, gain",
    ok ? light : NAN, 1.0 / 12);
}

static const float non_finite[3] = { NAN, INFINITY, -INFINITY };

/* A picture does not tell NaN from infinities, and what they touch only becomes clearer. */
static void bad_voxels(scene* s)
{
  float* const good = malloc(VOXELS * sizeof *good);
  double* const wide = malloc(VOXELS * sizeof *wide);
  float* const values = s->volume.extinction;
  static const int every[4] = { 1000, 100, 10, 2 };
  for (int k = 0; k < 8 && good && wide; ++k)
  {
    memcpy(good, values, VOXELS * sizeof *good);
    if (restart(s, k & 1))
    {
      double differs = 0, opaquer = 0, miscounted = 0;
      float* const first = s->kept;
      float* const clean = malloc(5 * PIXELS * sizeof *clean);
      int ok = clean != NULL;
      if (clean)
      {
        memcpy(clean, s->kept, 5 * PIXELS * sizeof *clean);
      }
      for (int kind = 0; kind < 5 && ok; ++kind)
      {
        uint32_t state = 7;
        int64_t count = 0;
        for (int i = 0; i < VOXELS; ++i)
        {
          state = state * 1664525u + 1013904223u;
          const int bad = (int)((state >> 8) % (uint32_t)every[k / 2]) == 0;
          count += bad;
          values[i] = bad ? non_finite[kind < 3 ? kind : i % 3] : good[i];
          wide[i] = (double)values[i];
        }
        if (kind == 4) /* doubles are copied */
        {
          s->frame->volume.scalars = wide;
          s->frame->volume.type = CHI_F64;
          s->frame->volume.stride = sizeof *wide;
        }
        ++s->frame->volume.version;
        ok = draw(s, s->now);
        chi_occlusion_stats stats;
        chi_occlusion_get_stats(s->engine, &stats);
        miscounted = fmax(miscounted, fabs((double)(stats.non_finite_samples - count)));
        for (int i = 0; ok && i < 5 * PIXELS; ++i)
        {
          ok = isfinite(s->now[i]);
          opaquer = i % 5 == 3 ? fmax(opaquer, (double)s->now[i] - (double)clean[i]) : opaquer;
          differs = kind ? fmax(differs, fabs((double)s->now[i] - (double)first[i])) : 0;
        }
        if (kind == 0)
        {
          memcpy(first, s->now, 5 * PIXELS * sizeof *first);
        }
      }
      const char* const name = k & 1 ? "NaN, +-infinity: one voxel of, parallel"
                                     : "NaN, +-infinity: one voxel of, perspective";
      tell(s, name, every[k / 2], "all kinds alike", ok ? differs : NAN, 2e-4); /* copies: floats */
      tell(s, name, every[k / 2], "nothing is more opaque", ok ? opaquer : NAN, 2e-3 + 1e-5);
      tell(s, name, every[k / 2], "counted", ok ? miscounted : NAN, 0);
      free(clean);
    }
    memcpy(values, good, VOXELS * sizeof *good);
  }
  free(good);
  free(wide);
}

/* Mirrored data under the matrix that mirrors them back, with all that is hard at once. */
static void mirrored(scene* s)
{
  float* const values = malloc(VOXELS * sizeof *values);
  for (int axis = 0; axis < 3 && values; ++axis)
  {
    if (!restart(s, 0))
    {
      continue;
    }
    for (size_t i = 0; i < VOXELS; ++i)
    {
      size_t at[3] = { i % SIZE, i / SIZE % SIZE, i / (SIZE * SIZE) };
      at[axis] = SIZE - 1 - at[axis];
      values[i] = s->volume.extinction[at[0] + SIZE * (at[1] + SIZE * at[2])];
    }
    transform(s, 1e-6, 0);
    double* const m = s->frame->volume.index_to_world;
    for (int r = 0; r < 3; ++r)
    {
      m[4 * r + 3] += (SIZE - 1) * m[4 * r + axis];
      m[4 * r + axis] = -m[4 * r + axis];
    }
    s->frame->volume.scalars = values;
    tell_same(s, "mirrored, voxels of 1e-6, axis", axis);
  }
  free(values);
}

/* Pixel centres of a window an odd number of times as wide are those of the small one, and more. */
static void large_window(scene* s, int window)
{
  const int small = window / 5, width = 5 * small;
  float* const few = malloc((size_t)small * (size_t)small * sizeof *few);
  double worst = few && restart(s, 0) ? 0 : NAN;
  s->frame->frame.surface = NULL;
  for (int large = 0; large < 2 && worst == worst; ++large)
  {
    s->frame->camera.width = s->frame->camera.height = large ? width : small;
    s->frame->params.directions = 4;
    chi_occlusion_image image;
    if (chi_occlusion_render(s->exec, s->engine, &s->frame->frame) != CHI_OK)
    {
      worst = NAN;
      break;
    }
    chi_occlusion_get_image(s->engine, &image);
    for (size_t i = 0; i < (size_t)small * (size_t)small; ++i)
    {
      const size_t x = i % (size_t)small, y = i / (size_t)small, w = (size_t)width;
      if (!large)
      {
        few[i] = image.rgba[4 * i + 3];
        continue;
      }
      worst = fmax(
        worst, fabs((double)few[i] - (double)image.rgba[4 * (5 * x + 2 + w * (5 * y + 2)) + 3]));
    }
  }
  /* index positions are floats of up to 24 + 2^-24 x 24 x 4000 of a pixel's step, extinction
   * changes by 20 a voxel: some 1e-4 of alpha where a ray grazes a ball */
  tell(s, "window", width, "alpha as in a window of a fifth", worst, 1e-3);
  free(few);
}

/* ---- 500 frames of data that change ---- */

/* The data, the camera and the table change in every frame, with a period of 50. */
static void many_frames(scene* s)
{
  counting_host host = { .exec = s->exec };
  const chi_exec exec = counting_exec(&host);
  const chi_exec* const kept_exec = s->exec;
  chi_occlusion* const kept_engine = s->engine;
  float* const good = malloc(VOXELS * sizeof *good);
  double grown = NAN, calls = NAN, differs = NAN;
  s->engine = NULL;
  s->exec = &exec;
  if (good && chi_occlusion_create(&exec, &s->engine) == CHI_OK && restart(s, 0))
  {
    memcpy(good, s->volume.extinction, VOXELS * sizeof *good);
    size_t live = 0, before = 0, most = 0;
    differs = calls = 0;
    for (int frame = 0; frame < 500 && differs == differs; ++frame)
    {
      const int phase = frame % 50;
      const double center[3] = { 11.5, 11.5, 11.5 }, turn[2] = { 7.2 * phase, 20 };
      s->frame->camera = reference_turned_view(center, 60, turn, 40, WIDTH, 0).camera;
      for (int i = 0; i < VOXELS; ++i)
      {
        s->volume.extinction[i] = good[(i + 37 * phase) % VOXELS];
      }
      s->frame->transfer.unit_distance = 1.5 + 0.01 * phase;
      ++s->frame->volume.version;
      ++s->frame->transfer.version;
      before = host.allocations;
      if (!draw(s, s->now))
      {
        differs = NAN;
        break;
      }
      if (frame == 0)
      {
        memcpy(s->kept, s->now, 5 * PIXELS * sizeof *s->kept);
      }
      if (frame >= 50)
      {
        calls = fmax(calls, (double)(host.allocations - before));
        most = host.live > most ? host.live : most;
      }
      else
      {
        live = host.live;
      }
      if (phase == 0)
      {
        differs += memcmp(s->kept, s->now, 5 * PIXELS * sizeof *s->now) != 0;
      }
    }
    grown = most > live ? (double)(most - live) : 0;
    memcpy(s->volume.extinction, good, VOXELS * sizeof *good);
  }
  tell(s, "frames of changing data", 500, "bytes more than after 50", grown, 0);
  /* what new data need while their ranges are found: extremes and counts of layers */
  tell(s, "frames of changing data", 500, "allocations a frame, given back", calls, 2);
  tell(s, "frames of changing data", 500, "pictures unlike those of the first period", differs, 0);
  chi_occlusion_destroy(&exec, s->engine);
  tell(s, "frames of changing data", 500, "bytes left at the end", (double)host.live, 0);
  s->exec = kept_exec;
  s->engine = kept_engine;
  free(good);
}

void occlusion_stress_pictures(const chi_exec* exec, int window, stress_report report, void* user)
{
  scene s = { .exec = exec, .report = report, .user = user };
  const size_t n[3] = { SIZE, SIZE, SIZE };
  s.frame = malloc(sizeof *s.frame);
  s.original = malloc(sizeof *s.original);
  s.depth = malloc(2 * PIXELS * sizeof *s.depth);
  s.kept = malloc(10 * PIXELS * sizeof *s.kept);
  if (s.frame && s.original && s.depth && s.kept && reference_volume_create(&s.volume, n) &&
    chi_occlusion_create(exec, &s.engine) == CHI_OK)
  {
    s.depth0 = s.depth + PIXELS;
    s.now = s.kept + 5 * PIXELS;
    for (size_t i = 0; i < VOXELS; ++i)
    {
      const double x = (double)(i % SIZE), y = (double)(i / SIZE % SIZE), z = (double)(i / 576);
      const double a = 6 - sqrt((x - 8) * (x - 8) + (y - 9) * (y - 9) + (z - 8) * (z - 8));
      const double b = 7 - sqrt((x - 15) * (x - 15) + (y - 14) * (y - 14) + (z - 16) * (z - 16));
      s.volume.extinction[i] = (float)floor(20 * fmax(0, fmin(5, fmax(a, b))));
    }
    extents_and_offsets(&s);
    near_and_far(&s);
    more_extinction(&s);
    bad_voxels(&s);
    mirrored(&s);
    many_frames(&s);
    large_window(&s, window);
  }
  else
  {
    tell(&s, "memory", 0, "is there", NAN, 0);
  }
  chi_occlusion_destroy(exec, s.engine);
  reference_volume_free(&s.volume);
  free(s.frame);
  free(s.original);
  free(s.depth);
  free(s.kept);
}
