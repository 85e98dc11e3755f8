/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The occlusion engine's picture: against a ray cast, over numbers of slices, without grain. */

#include "chi_test.h"
#include "occlusion_reference.h"

static chi_occlusion* engine_create(void)
{
  chi_occlusion* engine = NULL;
  CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
  return engine;
}

static const float* render(chi_occlusion* engine, const reference_frame* f)
{
  chi_occlusion_image image = { 0 };
  const chi_status status = chi_occlusion_render(NULL, engine, &f->frame);
  CHECK(status == CHI_OK);
  chi_occlusion_get_image(engine, &image);
  CHECK(image.rgba != NULL);
  return status == CHI_OK ? image.rgba : NULL;
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Mean and 99th percentile of differences, sorted in place; in units of 1/255. */
static void summarize(double* d, size_t count, double out[2])
{
  out[0] = out[1] = 0;
  qsort(d, count, sizeof *d, ascending);
  for (size_t i = 0; i < count; ++i)
  {
    out[0] += 255 * d[i] / (double)count;
  }
  out[1] = count ? 255 * d[(size_t)(0.99 * (double)(count - 1))] : 0;
}

static double marschner_lobb(double x, double y, double z)
{
  const double pi = 3.14159265358979324, r = sqrt(x * x + y * y);
  const double rho = cos(2 * pi * 6 * cos(0.5 * pi * r));
  return (1 - sin(0.5 * pi * z) + 0.25 * (1 + rho)) / (2 * 1.25);
}

static int make_marschner_lobb(reference_volume* v, size_t size)
{
  const size_t n[3] = { size, size, size };
  if (!reference_volume_create(v, n))
  {
    return 0;
  }
  for (size_t i = 0; i < size * size * size; ++i)
  {
    const double step = 2 / (double)(size - 1);
    v->extinction[i] = (float)marschner_lobb(step * (double)(i % size) - 1,
      step * (double)(i / size % size) - 1, step * (double)(i / (size * size)) - 1);
  }
  reference_volume_finish(v);
  return 1;
}

/* A smooth transfer function: a bump of opacity, colours that run through the spectrum. */
static void smooth_transfer(reference_frame* f)
{
  f->transfer.range[0] = 0;
  f->transfer.range[1] = 1;
  f->transfer.unit_distance = 1;
  for (int i = 0; i < REFERENCE_ENTRIES; ++i)
  {
    const double s = (double)i / (REFERENCE_ENTRIES - 1);
    f->opacity[i] = (float)(0.25 * exp(-50 * (s - 0.5) * (s - 0.5)));
    f->rgb[3 * i] = (float)s;
    f->rgb[3 * i + 1] = (float)(1 - s);
    f->rgb[3 * i + 2] = (float)(4 * s * (1 - s));
  }
}

/* One pixel in double precision, 50 steps a voxel; extinction from the opacity's own formula. */
static void cast_ray(
  const reference_volume* v, const reference_frame* f, double px, double py, double out[4])
{
  const chi_camera* const c = &f->camera;
  const double x = c->window[0] + px / c->width * (c->window[1] - c->window[0]);
  const double y = c->window[2] + py / c->height * (c->window[3] - c->window[2]);
  double start[3], direction[3], length = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double* const m = c->world_to_eye; /* rigid: the inverse turn is the transpose */
    const double sign = a == 2 ? -1 : 1;     /* index space is the world with z negated */
    const double moved[3] = { (c->parallel ? x : 0) - m[3], (c->parallel ? y : 0) - m[7], -m[11] };
    start[a] = sign * (m[a] * moved[0] + m[4 + a] * moved[1] + m[8 + a] * moved[2]);
    direction[a] =
      sign * (m[a] * (c->parallel ? 0 : x) + m[4 + a] * (c->parallel ? 0 : y) - m[8 + a]);
    length += direction[a] * direction[a];
  }
  length = sqrt(length);
  double t0 = c->near_depth, t1 = 1e9;
  for (int a = 0; a < 3; ++a)
  {
    const double low = -start[a] / direction[a];
    const double high = ((double)v->n[a] - 1 - start[a]) / direction[a];
    t0 = fmax(t0, fmin(low, high));
    t1 = fmin(t1, fmax(low, high));
  }
  double clear = 1;
  memset(out, 0, 4 * sizeof *out);
  const long steps = t1 > t0 ? (long)ceil(50 * (t1 - t0) * length) : 0;
  for (long k = 0; k < steps; ++k)
  {
    const double dt = (t1 - t0) / (double)steps, t = t0 + ((double)k + 0.5) * dt;
    const double at[3] = { start[0] + t * direction[0], start[1] + t * direction[1],
      start[2] + t * direction[2] };
    const double s = reference_extinction(v, at);
    const double alpha = 0.25 * exp(-50 * (s - 0.5) * (s - 0.5));
    const double step = exp(log1p(-alpha) * dt * length);
    const double color[3] = { s, 1 - s, 4 * s * (1 - s) };
    for (int k3 = 0; k3 < 3; ++k3)
    {
      out[k3] += clear * (1 - step) * color[k3];
    }
    clear *= step;
  }
  out[3] = 1 - clear;
}

/* Mean 1/255, 99 % 2/255 as asked against the GPU ray caster; every 7th pixel is cast. */
static void strength_zero_is_an_unshaded_ray_cast(void)
{
  reference_volume v;
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* const engine = engine_create();
  double* const d = malloc(4 * 128 * 128 * sizeof *d);
  if (f && d && make_marschner_lobb(&v, 41))
  {
    const double center[3] = { 20, 20, 20 }, turn[2] = { 30, 20 };
    for (int parallel = 0; parallel < 2; ++parallel)
    {
      const reference_view view = reference_turned_view(center, 120, turn, 70, 128, parallel);
      reference_frame_init(f, &v, &view, 1);
      smooth_transfer(f);
      f->params.strength = 0;
      f->params.sample_distance = 0.1;
      const float* const rgba = render(engine, f);
      size_t count = 0;
      for (int i = 0; rgba && i < 128 * 128; i += 7)
      {
        double exact[4];
        cast_ray(&v, f, i % 128 + 0.5, i / 128 + 0.5, exact);
        for (int k = 0; k < 4 && exact[3] > 0; ++k)
        {
          d[count++] = fabs((double)rgba[4 * i + k] - exact[k]);
        }
      }
      double e[2];
      summarize(d, count, e);
      printf(
        "strength 0 against rays: mean %.3f/255, 99 %% %.3f/255, %zu values\n", e[0], e[1], count);
      CHECK(count > 3000 && e[0] <= 1 && e[1] <= 2);
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
  free(d);
}

/* What 250 to 2000 slices are compared on: a slab, or a plate with thin fog about it. */
static int make_layers(reference_volume* v, int is_slab)
{
  const size_t n[3] = { 96, 96, 126 };
  if (!reference_volume_create(v, n))
  {
    return 0;
  }
  for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i)
  {
    const size_t x = i % n[0], z = i / (n[0] * n[1]);
    v->extinction[i] = is_slab ? 0.02f : z >= 20 && z < 22 && x < 48 ? 8.0f : 0.01f;
  }
  reference_volume_finish(v);
  return 1;
}

/* Within 2/255 in the mean over the footprint and 10/255 for 99 %, as asked; against 2000. */
static void slices_agree(int is_slab)
{
  enum
  {
    WIDTH = 96,
    PIXELS = WIDTH * WIDTH,
    PROBES = 24 * 24 * 31
  };
  reference_volume v;
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* const engine = engine_create();
  float* const finest = malloc((4 * PIXELS + PROBES) * sizeof *finest);
  float* const visibility = malloc(PROBES * sizeof *visibility);
  double* const position = malloc(3 * PROBES * sizeof *position);
  double* const d = malloc((4 * PIXELS + PROBES) * sizeof *d);
  const double center[3] = { 47.5, 47.5, 62.5 }, turn[2] = { 0, 0 };
  if (f && finest && visibility && position && d && make_layers(&v, is_slab))
  {
    for (int i = 0; i < PROBES; ++i)
    {
      position[3 * i] = 4 * (i % 24) + 2.5;
      position[3 * i + 1] = 4 * (i / 24 % 24) + 2.5;
      position[3 * i + 2] = 100 - 62.5 + 4 * (i / 576) + 1;
    }
    const reference_view view = reference_turned_view(center, 100, turn, 96, WIDTH, 1);
    for (int slices = 2000; slices >= 250; slices /= 2)
    {
      reference_frame_init(f, &v, &view, is_slab ? 1 : 8);
      f->params.bias = 1.5;
      f->params.sample_distance = 125.0 / slices;
      f->probes = (chi_occlusion_probes){ position, visibility, PROBES };
      f->frame.probes = &f->probes;
      const float* const rgba = render(engine, f);
      if (!rgba)
      {
        break;
      }
      if (slices == 2000)
      {
        memcpy(finest, rgba, 4 * PIXELS * sizeof *finest);
        memcpy(finest + 4 * PIXELS, visibility, PROBES * sizeof *finest);
        continue;
      }
      double picture[2], light[2];
      for (int i = 0; i < 4 * PIXELS; ++i)
      {
        d[i] = fabs((double)rgba[i] - (double)finest[i]);
      }
      summarize(d, 4 * PIXELS, picture);
      for (int i = 0; i < PROBES; ++i)
      {
        d[i] = fabs((double)visibility[i] - (double)finest[4 * PIXELS + i]);
      }
      summarize(d, PROBES, light);
      printf("%s, %d slices against 2000: picture %.3f, 99 %% %.3f; V %.3f, 99 %% %.3f of 1/255\n",
        is_slab ? "slab" : "half-plane", slices, picture[0], picture[1], light[0], light[1]);
      CHECK(picture[0] <= 2 && picture[1] <= 10);
      CHECK(light[0] <= 2 && light[1] <= 10);
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
  free(finest);
  free(visibility);
  free(position);
  free(d);
}

static void any_number_of_slices_gives_the_same_light_and_picture(void)
{
  slices_agree(1);
  slices_agree(0);
}

/* Field whose zero is a sphere of radius 36 voxels about the centre of 96^3; opaque inside. */
static int make_sphere(reference_volume* v)
{
  const size_t n[3] = { 96, 96, 96 };
  if (!reference_volume_create(v, n))
  {
    return 0;
  }
  for (size_t i = 0; i < 96 * 96 * 96; ++i)
  {
    const double x = (double)(i % 96) - 47.5, y = (double)(i / 96 % 96) - 47.5;
    const double z = (double)(i / 9216) - 47.5;
    v->extinction[i] = (float)(36 - sqrt(x * x + y * y + z * z));
  }
  reference_volume_finish(v);
  return 1;
}

static void step_transfer(reference_frame* f)
{
  f->transfer.range[0] = -8;
  f->transfer.range[1] = 8;
  f->transfer.unit_distance = 1;
  for (int i = 0; i < REFERENCE_ENTRIES; ++i)
  {
    f->opacity[i] = i > REFERENCE_ENTRIES / 2 ? 0.999f : 0.0f;
  }
}

/* Standard deviation of what a quadratic leaves of 16 x 16 pixels, over their mean; -1 where the
 * mean is not positive. Normal equations in centred pixel coordinates, six unknowns. */
static double grain(const float* rgba, int width, int x0, int y0)
{
  double a[6][7] = { { 0 } }, value[256], mean = 0, sum = 0;
  double basis[256][6];
  for (int i = 0; i < 256; ++i)
  {
    const double x = (i % 16 - 7.5) / 8, y = (i / 16 - 7.5) / 8;
    const double b[6] = { 1, x, y, x * x, x * y, y * y };
    value[i] = (double)rgba[4 * ((y0 + i / 16) * width + x0 + i % 16)];
    mean += value[i] / 256;
    memcpy(basis[i], b, sizeof b);
    for (int r = 0; r < 6; ++r)
    {
      for (int c = 0; c < 6; ++c)
      {
        a[r][c] += b[r] * b[c];
      }
      a[r][6] += b[r] * value[i];
    }
  }
  for (int p = 0; p < 6; ++p)
  {
    for (int r = 0; r < 6; ++r)
    {
      const double factor = r == p ? 0 : a[r][p] / a[p][p];
      for (int c = p; c < 7; ++c)
      {
        a[r][c] -= factor * a[p][c];
      }
    }
  }
  for (int i = 0; i < 256; ++i)
  {
    double rest = value[i];
    for (int r = 0; r < 6; ++r)
    {
      rest -= a[r][6] / a[r][r] * basis[i][r];
    }
    sum += rest * rest / 256;
  }
  return mean > 0 ? sqrt(sum) / mean : -1;
}

static void a_steep_step_leaves_no_grain(void)
{
  reference_volume v;
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* const engine = engine_create();
  const double center[3] = { 47.5, 47.5, 47.5 };
  const double turns[2][2] = { { 0, 0 }, { 30, 20 } };
  if (f && make_sphere(&v))
  {
    for (int k = 0; k < 5; ++k)
    {
      const int pixels = k & 4 ? 512 : 256;
      const reference_view view =
        reference_turned_view(center, 250, turns[k & 1], 96, pixels, k & 2);
      reference_frame_init(f, &v, &view, 1);
      step_transfer(f);
      f->params.bias = -1;
      f->params.sample_distance = 1;
      const float* const rgba = render(engine, f);
      const int half_way = (int)(18.0 / 96 * pixels);
      const int at[5][2] = { { 0, 0 }, { half_way, 0 }, { 0, half_way }, { -half_way, 0 },
        { half_way * 5 / 7, half_way * 5 / 7 } };
      for (int p = 0; p < 5 && rgba; ++p)
      {
        const double g = grain(rgba, pixels, pixels / 2 + at[p][0] - 8, pixels / 2 + at[p][1] - 8);
        if (g > 1.0 / 255)
        {
          printf("grain %.2f/255: view %d, patch %d\n", 255 * g, k, p);
        }
        CHECK(g >= 0 && g <= 2.0 / 255);
      }
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
}

/* Asked: >= 0.97 of its colour, with the default bias, however many slices. */
static void an_open_surface_that_faces_the_eye_keeps_its_colour(void)
{
  reference_volume v;
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* const engine = engine_create();
  const double center[3] = { 47.5, 47.5, 47.5 }, turn[2] = { 0, 0 };
  if (f && make_sphere(&v))
  {
    for (int k = 0; k < 16; ++k)
    {
      const reference_view view = reference_turned_view(center, 250, turn, 96, 96, k & 1);
      reference_frame_init(f, &v, &view, 1);
      step_transfer(f);
      f->params.bias = -1;
      f->params.half_size = k >> 1 & 1;
      f->params.sample_distance = 1.0 / (1 << (k >> 2));
      for (int plane = 0; plane < 2; ++plane)
      {
        if (plane) /* the same with a plane: distance from z = 40.3 */
        {
          for (size_t i = 0; i < 96 * 96 * 96; ++i)
          {
            v.extinction[i] = (float)((double)(i / 9216) - 40.3);
          }
          ++f->volume.version;
        }
        const float* const rgba = render(engine, f);
        const float* const middle = rgba ? rgba + 4 * (96 * 48 + 48) : NULL;
        CHECK(middle && middle[3] > 0.99f);
        CHECK(middle && middle[0] >= 0.97f * middle[3] && middle[0] <= middle[3] * 1.0001f);
        if (middle && middle[0] < 0.97f * middle[3])
        {
          printf("open %s %.4f: parallel %d, half %d, %d slices a voxel\n",
            plane ? "plane" : "sphere", (double)(middle[0] / middle[3]), k & 1, k >> 1 & 1,
            1 << (k >> 2));
        }
      }
      reference_volume_free(&v);
      if (!make_sphere(&v))
      {
        break;
      }
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
}

/* Bilinear a(x + dx, y + dy); light from outside is 1. */
static double tap(const double* a, int n, double x, double y)
{
  const int i = (int)floor(x), j = (int)floor(y);
  const double u = x - i, w = y - j;
  double sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int xi = i + (k & 1), yj = j + (k >> 1);
    const int inside = xi >= 0 && yj >= 0 && xi < n && yj < n;
    sum += (k & 1 ? u : 1 - u) * (k >> 1 ? w : 1 - w) * (inside ? a[xi + n * yj] : 1);
  }
  return sum;
}

/* published() of the numpy prototype, one slice a voxel, at the points. */
static int published_rule(
  const reference_volume* v, int taps, double theta, const reference_points* points, double* out)
{
  const int n = REFERENCE_SIZE;
  double* light = malloc((size_t)(n * n) * sizeof *light);
  double* next = malloc((size_t)(n * n) * sizeof *next);
  if (!light || !next)
  {
    free(light);
    free(next);
    return 0;
  }
  for (int i = 0; i < n * n; ++i)
  {
    light[i] = 1;
  }
  for (int z = 0; z < n; ++z)
  {
    const float* const s = v->extinction + (size_t)(n * n) * (size_t)z;
    for (size_t p = 0; p < points->count; ++p)
    {
      const double* const at = points->position + 3 * p;
      const int i = (int)at[0] + n * (int)at[1];
      if ((int)at[2] == z)
      {
        out[p] = light[i] * exp(-0.5 * (double)s[i]);
      }
    }
    for (int i = 0; i < n * n; ++i)
    {
      light[i] *= exp(-(double)s[i]);
      next[i] = 0;
    }
    for (int k = 0; k < taps; ++k)
    {
      const double r = tan(theta) * sqrt((k + 0.5) / taps);
      const double dx = r * cos((k + 0.5) * 2.39996322972865332);
      const double dy = r * sin((k + 0.5) * 2.39996322972865332);
      for (int i = 0; i < n * n; ++i)
      {
        next[i] += tap(light, n, i % n + dx, i / n + dy) / taps;
      }
    }
    double* const swap = light;
    light = next;
    next = swap;
  }
  free(light);
  free(next);
  return 1;
}

/* The engine's light planes lie between slices, half a voxel off the prototype's, and its V between
 * them is linear: they agree in the mean, not point by point beside an opaque plate. */
static void the_published_rule_is_reproduced(reference_kind kind, double range, double limit)
{
  reference_volume v;
  const reference_view view = reference_parallel_view();
  reference_points points = { NULL, 0 };
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* const engine = engine_create();
  if (f && reference_scene(&v, kind, NULL) && reference_points_create(&points, &v, kind, &view, 1))
  {
    double* const exact = malloc(points.count * sizeof *exact);
    double* const work = malloc(points.count * sizeof *work);
    float* const visibility = malloc(points.count * sizeof *visibility);
    const int taps = 16;
    if (exact && work && visibility &&
      published_rule(&v, taps, 0.78539816339744831, &points, exact))
    {
      reference_frame_init(f, &v, &view, range);
      f->params.method = CHI_OCCLUSION_PUBLISHED;
      f->params.directions = taps;
      f->params.half_size = 0;
      f->params.sample_distance = 1;
      CHECK(reference_probe(NULL, engine, f, &view, &points, visibility) == CHI_OK);
      const reference_error e = reference_compare(visibility, exact, points.count, work);
      printf("published rule, engine against prototype: mean %.4f, 99 %% %.4f, bias %+.4f\n",
        e.mean, e.p99, e.bias);
      CHECK(e.mean <= limit);
    }
    free(exact);
    free(work);
    free(visibility);
    reference_volume_free(&v);
  }
  reference_points_free(&points);
  chi_occlusion_destroy(NULL, engine);
  free(f);
}

int main(void)
{
  strength_zero_is_an_unshaded_ray_cast();
  any_number_of_slices_gives_the_same_light_and_picture();
  an_open_surface_that_faces_the_eye_keeps_its_colour();
  the_published_rule_is_reproduced(REFERENCE_HALF_PLANE, 8, 0.01);
  the_published_rule_is_reproduced(REFERENCE_BALLS, 4.5, 0.01);
  a_steep_step_leaves_no_grain();
  return chi_test_report();
}
