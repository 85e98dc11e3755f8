/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Run time against error, of visibility and of the final picture, on four scenes in parallel
 * projection: half-plane above a white surface, random balls, a brain, a brain cut open with
 * fibres.
 *
 *   bench_occlusion_error [FOLDER [SCENE]]     with the files of scenes.py; without, two scenes
 *
 * Prints CSV. Visibility is judged at bias 0 at the points of occlusion_reference.c, pictures of
 * white matter over black at the default bias, 2 voxels (geometry: 1.5), in units of full scale.
 * Exact is the cone of 400 straight rays, step 1/4. With fibres the geometry is what the G-buffer
 * knows of it, over the same thickness; errors named "true" are against the tubes' insides. The
 * picture's pixels are every n-th of those that show anything. Times are of whole frames in which
 * nothing changes that matters.
 *
 * For bench_occlusion_error_vtk, which judges the engines as VTK's users have them, it leaves in
 * FOLDER the volume of each scene, occlusion_error_K.raw, and occlusion_error_K.csv: the exact
 * picture of those pixels, and the exact visibility of the geometry there.
 */

#include "occlusion_reference_picture.h"

#include "chi_bench.h"

#include <math.h>
#include <string.h>

enum
{
  PIXELS = REFERENCE_SIZE * REFERENCE_SIZE,
  RUNS = 3, /* 36 settings a scene: the minimum of 5 would take the time of the peers */
  POINTS = 1500,
  SHOWN = 300 /* about so many are judged a scene */
};

static const char* const names[4] = { "half-plane", "balls", "brain", "brain with fibres" };
static const double quarter = 0.78539816339744831, radius = 0.8;
static const double bias[2] = { 2, 1.5 }; /* by default: of matter, of geometry */

/* Exact values, of the G-buffer's geometry and of the true one. */
typedef struct exact_values
{
  double *visibility, *picture;
} exact_values;

typedef struct judged_scene
{
  const char* name;
  double range; /* largest extinction */
  reference_volume volume;
  reference_view view;
  reference_tubes* tubes;
  float* depth; /* NULL: no geometry */
  reference_surface surface, solid;
  reference_points points;
  int (*shown)[2];
  size_t shown_count;
  exact_values exact, real;
  float* seen;  /* of the engine: points, then pixels */
  double* work; /* likewise */
} judged_scene;

static const reference_rays rays = { 400, 0.25, 0.78539816339744831 };

static void solve_points(void* data, size_t begin, size_t end)
{
  const judged_scene* const s = (const judged_scene*)data;
  for (size_t i = begin; i < end; ++i)
  {
    const double* const at = s->points.position + 3 * i;
    s->exact.visibility[i] =
      reference_visibility(&s->volume, s->depth ? &s->surface : NULL, &s->view, &rays, at);
    if (s->tubes)
    {
      s->real.visibility[i] = reference_visibility(&s->volume, &s->solid, &s->view, &rays, at);
    }
  }
}

static void solve_pixels(void* data, size_t begin, size_t end)
{
  const judged_scene* const s = (const judged_scene*)data;
  for (size_t i = begin; i < end; ++i)
  {
    s->exact.picture[i] = reference_pixel(
      &s->volume, s->depth ? &s->surface : NULL, &s->view, &rays, bias, s->shown[i]);
    if (s->tubes)
    {
      s->real.picture[i] =
        reference_pixel(&s->volume, &s->solid, &s->view, &rays, bias, s->shown[i]);
    }
  }
}

static void judged_free(judged_scene* s)
{
  reference_points_free(&s->points);
  reference_volume_free(&s->volume);
  reference_tubes_free(s->tubes);
  free(s->depth);
  free(s->shown);
  free(s->exact.visibility);
  free(s->seen);
}

/* Every n-th of the points, those that a tube hides left out. */
static void thin_points(judged_scene* s)
{
  const size_t step = s->points.count / POINTS + 1;
  size_t kept = 0;
  for (size_t i = 0; i < s->points.count; i += step)
  {
    const double* const at = s->points.position + 3 * i;
    if (!s->tubes || !reference_tubes_contain(s->tubes, at))
    {
      memmove(s->points.position + 3 * kept++, at, 3 * sizeof *at);
    }
  }
  s->points.count = kept;
}

/* Pixels with a surface or matter behind them, every n-th. */
static void choose_pixels(judged_scene* s)
{
  size_t count = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    const int x = i % REFERENCE_SIZE, y = i / REFERENCE_SIZE;
    int any = s->depth && s->depth[i] < INFINITY;
    for (int z = 0; z < REFERENCE_SIZE && !any; ++z)
    {
      any = s->volume.extinction[i + PIXELS * z] > 0;
    }
    if (any)
    {
      s->shown[count][0] = x;
      s->shown[count++][1] = y;
    }
  }
  const size_t step = count / SHOWN + 1;
  s->shown_count = 0;
  for (size_t i = step / 2; i < count; i += step)
  {
    memmove(s->shown[s->shown_count++], s->shown[i], sizeof s->shown[i]);
  }
}

/* A white plane behind the half-plane, which shows its penumbra. */
static int add_plane(judged_scene* s)
{
  const double at[3] = { 0, 0, 64 };
  s->depth = malloc(PIXELS * sizeof *s->depth);
  for (int i = 0; s->depth && i < PIXELS; ++i)
  {
    s->depth[i] = (float)reference_depth(&s->view, at);
  }
  return s->depth != NULL;
}

static int add_fibres(judged_scene* s, const char* file)
{
  s->tubes = reference_tubes_read(file, radius);
  s->depth = malloc(PIXELS * sizeof *s->depth);
  if (!s->tubes || !s->depth)
  {
    return 0;
  }
  reference_tubes_depth(s->tubes, &s->view, s->depth);
  return 1;
}

static int judge(judged_scene* s, int which, const char* folder, chi_bench_pool* threads)
{
  static const double ranges[4] = { 8, 4.5, 0.6, 0.6 };
  char file[2][1024];
  snprintf(file[0], sizeof file[0], "%s/%s", folder ? folder : ".",
    which == 3 ? "brain_cut128.raw" : "brain128.raw");
  snprintf(file[1], sizeof file[1], "%s/fibres128.raw", folder ? folder : ".");
  *s = (judged_scene){
    .name = names[which], .range = ranges[which], .view = reference_parallel_view()
  };
  const reference_kind kind = which == 0 ? REFERENCE_HALF_PLANE
    : which == 1                         ? REFERENCE_BALLS
                                         : REFERENCE_RAW;
  s->shown = malloc(PIXELS * sizeof *s->shown);
  if (!s->shown || !reference_scene(&s->volume, kind, file[0]) ||
    !reference_points_create(&s->points, &s->volume, kind, &s->view, 1) ||
    (which == 0 && !add_plane(s)) || (which == 3 && !add_fibres(s, file[1])))
  {
    return 0;
  }
  if (s->depth)
  {
    s->surface = (reference_surface){ s->depth, 1, INFINITY, NULL, NULL };
    for (int i = 0; i < PIXELS; ++i)
    {
      s->surface.nearest = fmin(s->surface.nearest, (double)s->depth[i]);
    }
    s->solid = s->surface;
    s->solid.contains = reference_tubes_contain;
    s->solid.solid = s->tubes;
  }
  thin_points(s);
  choose_pixels(s);
  const size_t count = s->points.count + s->shown_count;
  s->exact.visibility = malloc(3 * count * sizeof(double));
  s->seen = malloc(count * sizeof *s->seen);
  if (!s->exact.visibility || !s->seen)
  {
    return 0;
  }
  s->exact.picture = s->exact.visibility + s->points.count;
  s->real.visibility = s->exact.visibility + count;
  s->real.picture = s->real.visibility + s->points.count;
  s->work = s->exact.visibility + 2 * count;
  chi_bench_for(threads, s->points.count, solve_points, s);
  chi_bench_for(threads, s->shown_count, solve_pixels, s);
  return 1;
}

/* The volume; and x, y, picture and, where there is a surface, its visibility, at the default bias.
 */
static int write_exact(const judged_scene* s, const char* folder, int which)
{
  char file[2][1024];
  static const char* const ends[2] = { "raw", "csv" };
  for (int k = 0; k < 2; ++k)
  {
    snprintf(file[k], sizeof file[k], "%s/occlusion_error_%d.%s", folder, which, ends[k]);
  }
  FILE* const raw = fopen(file[0], "wb");
  const size_t count = s->volume.n[0] * s->volume.n[1] * s->volume.n[2];
  int ok = raw && fwrite(s->volume.extinction, sizeof(float), count, raw) == count;
  ok = raw && fclose(raw) == 0 && ok;
  FILE* const csv = fopen(file[1], "w");
  for (size_t i = 0; csv && i < s->shown_count; ++i)
  {
    const int* const at = s->shown[i];
    const double depth = s->depth ? (double)s->depth[at[0] + REFERENCE_SIZE * at[1]] : INFINITY;
    double seen = NAN;
    if (depth < INFINITY)
    {
      const double place[3] = { at[0], at[1], s->view.eye[2] + depth - bias[1] };
      seen = reference_visibility(&s->volume, &s->surface, &s->view, &rays, place);
    }
    ok = fprintf(csv, "%d,%d,%.9g,%.9g\n", at[0], at[1], s->exact.picture[i], seen) > 0 && ok;
  }
  return csv && fclose(csv) == 0 && ok;
}

/* Shortest of several frames without probes. */
static double time_frames(const chi_exec* exec, chi_occlusion* engine, reference_frame* f)
{
  double best = INFINITY;
  for (int run = 0; run < RUNS + 1; ++run)
  {
    f->params.bias = run & 1 ? -1 : -2; /* both mean the default */
    const double t0 = chi_bench_now();
    if (chi_occlusion_render(exec, engine, &f->frame) != CHI_OK)
    {
      return NAN;
    }
    best = run ? fmin(best, chi_bench_now() - t0) : best; /* the first also reads the volume */
  }
  return best;
}

static void print_errors(const judged_scene* s, const chi_bench_pool* p, const char* method,
  int directions, double ns, const char* what, const reference_error* e)
{
  const double values[3] = { e->mean, e->rms, e->p99 };
  static const char* const kinds[3] = { "mean", "rms", "p99" };
  for (int k = 0; k < 3; ++k)
  {
    printf("occlusion_error,%s,%s,%d,%zu,%d,%.0f,%.5f,%s_%s\n", s->name, method, directions,
      s->volume.n[0] * s->volume.n[1] * s->volume.n[2], p->threads, ns, values[k], kinds[k], what);
  }
}

static int measure(const chi_exec* exec, chi_occlusion* engine, reference_frame* f, judged_scene* s,
  const char* method, const chi_bench_pool* p)
{
  const double ns = time_frames(exec, engine, f);
  chi_occlusion_image image;
  chi_occlusion_get_image(engine, &image);
  if (!(ns > 0) || !image.rgba)
  {
    return 0;
  }
  float* const picture = s->seen + s->points.count;
  for (size_t i = 0; i < s->shown_count; ++i)
  {
    const size_t at = (size_t)(s->shown[i][0] + REFERENCE_SIZE * s->shown[i][1]);
    const int hit = s->depth && s->depth[at] < INFINITY;
    picture[i] =
      image.rgba[4 * at] + (hit ? (1 - image.rgba[4 * at + 3]) * image.visibility[at] : 0);
  }
  const int directions = f->params.directions;
  f->params.bias = 0;
  if (reference_probe(exec, engine, f, &s->view, &s->points, s->seen) != CHI_OK)
  {
    return 0;
  }
  const exact_values* const exact[2] = { &s->exact, &s->real };
  static const char* const what[2][2] = { { "dV", "picture" }, { "dV_true", "picture_true" } };
  for (int real = 0; real < (s->tubes ? 2 : 1); ++real)
  {
    reference_error e =
      reference_compare(s->seen, exact[real]->visibility, s->points.count, s->work);
    print_errors(s, p, method, directions, ns, what[real][0], &e);
    e = reference_compare(picture, exact[real]->picture, s->shown_count, s->work);
    print_errors(s, p, method, directions, ns, what[real][1], &e);
  }
  fflush(stdout);
  return 1;
}

static void set_up(reference_frame* f, const judged_scene* s)
{
  reference_frame_init(f, &s->volume, &s->view, s->range);
  if (s->depth)
  {
    f->surface =
      (chi_surface_view){ .struct_size = sizeof f->surface, .depth = s->depth, .version = 1 };
    f->frame.surface = &f->surface;
  }
  f->params.cone_angle_rad = quarter;
}

/* The error of the G-buffer's model itself, exact against exact. */
static void compare_models(judged_scene* s, const chi_bench_pool* p)
{
  for (size_t i = 0; i < s->points.count + s->shown_count; ++i)
  {
    s->seen[i] = (float)s->exact.visibility[i];
  }
  reference_error e = reference_compare(s->seen, s->real.visibility, s->points.count, s->work);
  print_errors(s, p, "exact-geometry-buffer", 400, 0, "dV_true", &e);
  e = reference_compare(s->seen + s->points.count, s->real.picture, s->shown_count, s->work);
  print_errors(s, p, "exact-geometry-buffer", 400, 0, "picture_true", &e);
}

static int measure_scene(judged_scene* s, chi_bench_pool* p)
{
  const chi_exec exec = chi_bench_exec(p);
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* engine = NULL;
  int ok = f && chi_occlusion_create(&exec, &engine) == CHI_OK;
  for (int half = 0; half < 2; ++half)
  {
    for (int slices = 1; slices <= 4; slices *= 2)
    {
      for (int directions = 4; ok && directions <= 64; directions *= 2)
      {
        char method[64];
        snprintf(method, sizeof method, "chi-ordinates-%s-%d", half ? "half" : "full", slices);
        set_up(f, s);
        f->params.directions = directions;
        f->params.half_size = half;
        f->params.sample_distance = 1.0 / slices;
        ok = measure(&exec, engine, f, s, method, p);
      }
    }
  }
  for (int taps = 16; ok && taps <= 64; taps *= 4)
  {
    set_up(f, s);
    f->params.method = CHI_OCCLUSION_PUBLISHED;
    f->params.directions = taps;
    f->params.half_size = 0;
    ok = measure(&exec, engine, f, s, "chi-published-full-1", p);
  }
  chi_occlusion_destroy(&exec, engine);
  free(f);
  return ok;
}

int main(int argc, char** argv)
{
  chi_bench_pool two = { 2 };
  int failed = 0;
  printf(CHI_BENCH_HEADER);
  for (int k = 0; k < (argc > 1 ? 4 : 2); ++k)
  {
    judged_scene s;
    const double t0 = chi_bench_now();
    if (argc > 2 && strcmp(argv[2], names[k]) != 0)
    {
      continue;
    }
    int ok = judge(&s, k, argc > 1 ? argv[1] : NULL, &two);
    ok = ok && (argc < 2 || write_exact(&s, argv[1], k));
    const double t1 = chi_bench_now();
    if (ok && s.tubes)
    {
      compare_models(&s, &two);
    }
    ok = ok && measure_scene(&s, &two);
    fprintf(stderr, "# %s: %zu points, %zu pixels, exact %.1f s, engine %.1f s%s\n", s.name,
      s.points.count, s.shown_count, 1e-9 * (t1 - t0), 1e-9 * (chi_bench_now() - t1),
      ok ? "" : ": no memory, or a file cannot be read or written");
    failed += !ok;
    judged_free(&s);
  }
  return failed != 0;
}
