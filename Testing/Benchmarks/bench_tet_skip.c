/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * What each kind of skipping of tetrahedra gains where it applies: a million of Marschner-Lobb's
 * signal at 512^2, two threads; each scene has what one kind leaves out, the last one all of it.
 *
 * Prints CSV. Frames with all kinds and without one of them take turns, the camera one degree on
 * each time. Rows: speed-up (error_kind speedup); tetrahedra left out, pairs of a tetrahedron and a
 * tile where saturated, stages where unchanged (skipped); the largest difference of the last
 * picture to that of the work in full, of 255 (max_of_255).
 */

#include "chi_bench.h"
#include "tet_frame.h"

#include <math.h>
#include <string.h>

enum
{
  CUBES = 55, /* a side */
  PIXELS = 512,
  FLOATS = 4 * PIXELS * PIXELS,
  FRAMES = 5,
  ANY = CHI_TET_SKIP_EVERY_KIND & ~CHI_TET_SKIP_UNCHANGED
};

typedef struct kind
{
  const char *name, *scene;
  int32_t flag;
  int counter; /* of chi_tet_stats.skipped */
} kind;

static const kind kinds[] = { { "any", "nothing-to-skip", ANY, 1 },
  { "transparent", "half-transparent", CHI_TET_SKIP_TRANSPARENT, 1 },
  { "outside", "close", CHI_TET_SKIP_OUTSIDE, 2 },
  { "uncovered", "far-away", CHI_TET_SKIP_UNCOVERED, 6 },
  { "clipped", "half-clipped", CHI_TET_SKIP_CLIPPED, 3 },
  { "hidden", "surface-in-the-middle", CHI_TET_SKIP_HIDDEN, 4 },
  { "saturated", "dense", CHI_TET_SKIP_SATURATED, 5 },
  { "unchanged", "nothing-moves", CHI_TET_SKIP_UNCHANGED, 7 }, { "all", "all-of-these", ANY, 1 } };

/* Clip planes: the half z > 0 goes. The eye is on its side. */
static const double plane[4] = { 0, 0, -1, 0 };

/* Half of the window's height at distance 1. */
static double half_of(const kind* k)
{
  const double zoom = k->flag == CHI_TET_SKIP_OUTSIDE ? 0.25
    : k->flag == CHI_TET_SKIP_UNCOVERED               ? 6
                                                      : 1;
  return zoom * tan(0.26179938779914943);
}

static void make(scene* s, const tet_mesh* mesh, const kind* k, float* depth)
{
  static chi_surface_view surface;
  const int all = strcmp(k->name, "all") == 0;
  make_scene(s, mesh, TET_VIEW_SIGNAL, 0, PIXELS);
  s->camera = tet_look(6.6921, 30, 25, 0, PIXELS, half_of(k));
  tet_transfer_signal(&s->transfer, 1);
  s->params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  if (all || k->flag == CHI_TET_SKIP_TRANSPARENT)
  {
    memset(s->transfer.opacity, 0, TET_TABLE / 2 * sizeof(float));
  }
  if (all || k->flag == CHI_TET_SKIP_SATURATED)
  {
    s->transfer.view.unit_distance = 0.02; /* an optical depth of 50 a unit and opacity of 1 */
  }
  if (all || k->flag == CHI_TET_SKIP_CLIPPED)
  {
    s->frame.clip_planes = plane;
    s->frame.clip_plane_count = 1;
  }
  for (int i = 0; i < PIXELS * PIXELS; ++i) /* through the origin, across the view */
  {
    depth[i] = -(float)s->camera.world_to_eye[11];
  }
  surface = (chi_surface_view){ .struct_size = sizeof surface, .depth = depth, .version = 1 };
  s->frame.surface = all || k->flag == CHI_TET_SKIP_HIDDEN ? &surface : NULL;
}

static double render(const chi_exec* exec, chi_tet* tet, scene* s, int32_t skip)
{
  s->params.skip = skip;
  const double start = chi_bench_now();
  if (chi_tet_render(exec, tet, &s->frame) != CHI_OK)
  {
    fprintf(stderr, "a frame failed\n");
    exit(EXIT_FAILURE);
  }
  return chi_bench_now() - start;
}

static double difference(const chi_tet* a, const chi_tet* b)
{
  chi_tet_image p, q;
  chi_tet_get_image(a, &p);
  chi_tet_get_image(b, &q);
  double most = 0;
  for (int i = 0; i < FLOATS; ++i)
  {
    most = fmax(most, fabs((double)p.rgba[i] - (double)q.rgba[i]));
  }
  return 255 * most;
}

static chi_tet* make_renderer(const chi_exec* exec)
{
  chi_tet* tet;
  if (chi_tet_create(exec, &tet) != CHI_OK)
  {
    exit(EXIT_FAILURE);
  }
  return tet;
}

/* Two handles, so that each keeps its own stages. */
static void measure(const chi_exec* exec, const tet_mesh* mesh, const kind* k, float* depth)
{
  static scene s;
  make(&s, mesh, k, depth);
  chi_tet *const tet = make_renderer(exec), *const other = make_renderer(exec);
  const int32_t without = CHI_TET_SKIP_EVERY_KIND & ~k->flag;
  const int still = k->flag == CHI_TET_SKIP_UNCHANGED;
  double with_ns = INFINITY, without_ns = INFINITY;
  render(exec, tet, &s, CHI_TET_SKIP_EVERY_KIND); /* the first has the analysis of the mesh */
  render(exec, other, &s, without);
  for (int frame = 0; frame < FRAMES; ++frame)
  {
    if (!still)
    {
      s.camera = tet_look(6.6921, 31 + frame, 25, 0, PIXELS, half_of(k));
    }
    with_ns = fmin(with_ns, render(exec, tet, &s, CHI_TET_SKIP_EVERY_KIND));
    without_ns = fmin(without_ns, render(exec, other, &s, without));
  }
  chi_tet_stats stats;
  chi_tet_get_stats(tet, &stats);
  int64_t skipped = stats.skipped[k->counter];
  if (strcmp(k->name, "all") == 0) /* of tetrahedra */
  {
    skipped += stats.skipped[3] + stats.skipped[4];
  }
  const struct
  {
    double error;
    const char* kind;
  } rows[3] = { { without_ns / with_ns, "speedup" }, { (double)skipped, "skipped" },
    { difference(tet, other), "max_of_255" } };
  for (int i = 0; i < 3; ++i)
  {
    printf("tet_skip,%s,chi-without-%s,,%zu,2,%.0f,%.5g,%s\n", k->scene, k->name, mesh->count,
      without_ns, rows[i].error, rows[i].kind);
  }
  printf("tet_skip,%s,chi,,%zu,2,%.0f,1,speedup\n", k->scene, mesh->count, with_ns);
  fflush(stdout);
  chi_tet_destroy(exec, tet);
  chi_tet_destroy(exec, other);
}

int main(int argc, char** argv)
{
  chi_bench_pool two = { 2 };
  const chi_exec exec = chi_bench_exec(&two);
  tet_mesh* const mesh =
    tet_mesh_cubes(argc > 1 ? (size_t)atoi(argv[1]) : CUBES, TET_MARSCHNER_LOBB);
  float* const depth = (float*)malloc(PIXELS * PIXELS * sizeof *depth);
  if (!depth)
  {
    return 1;
  }
  printf(CHI_BENCH_HEADER);
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
  {
    measure(&exec, mesh, kinds + k, depth);
  }
  free(depth);
  tet_mesh_free(mesh);
  return 0;
}
