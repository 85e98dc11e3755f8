/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_ORDER_INTERNAL_H
#define CHI_TET_ORDER_INTERNAL_H

/* The stages of the visibility order: once a mesh its adjacency, its boundary and a convex lift;
 * once a view keys of the lift, or a topological sort. */

#include "chi_buffer.h"
#include "chi_internal.h"
#include "math/chi_predicates.h"

#include <chiaroscuro/chi_tet_order.h>

enum
{
  CHI_ORDER_CHUNKS = 64, /* of the list of tetrahedra, whatever the number of threads */
  CHI_ORDER_GROUP = 64   /* most tetrahedra that one lift may fail to tell apart */
};

/* The vertices of the face opposite vertex i, counterclockwise as seen from outside. */
static const uint8_t chi_order_face[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };

/* Where in a pixel its ray is, for looking up relations: off the centre by what is of no account in
 * a picture, so that rays of views along a grid lie within no face. */
static const double chi_order_center[2] = { 0.5 + 1e-8, 0.5 + 0.618e-8 };

static inline size_t chi_order_chunk(size_t count)
{
  return (count + CHI_ORDER_CHUNKS - 1) / CHI_ORDER_CHUNKS;
}

static inline void chi_order_corners(const chi_tet_mesh_view* mesh, size_t t, double x[4][3])
{
  for (size_t i = 0; i < 4; ++i)
  {
    chi_view_get(&mesh->points, mesh->vertices[4 * t + i], x[i]);
  }
}

/* Neighbours across faces. */
typedef struct chi_order_adjacency
{
  chi_buffer neighbors; /* uint32 [tetrahedra x 4] beyond the face opposite each vertex; count or
                           more where there is none, or no single one */
  chi_buffer exterior;  /* uint32 [boundary + those of bad ones] such faces, 4 t + i, ascending */
  size_t exterior_count;
  int64_t interior, boundary, bad;
} chi_order_adjacency;

chi_status chi_order_adjacency_build(
  const chi_exec* exec, chi_order_adjacency* adjacency, const chi_tet_mesh_view* mesh);

void chi_order_adjacency_free(const chi_exec* exec, chi_order_adjacency* adjacency);

/* The shape of the union, as far as faces tell. */
typedef struct chi_order_shape
{
  int32_t pieces, convex;
} chi_order_shape;

chi_status chi_order_shape_find(const chi_exec* exec, chi_order_shape* shape,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency);

/* A plane too steep for the integers of the others, in their units. */
typedef struct chi_order_outlier
{
  double plane[4];
  uint32_t t;
} chi_order_outlier;

/* A function that is linear within each tetrahedron, of which the key is the value at the eye. */
typedef struct chi_order_lift
{
  double center[3], frame[9]; /* y = frame (x - center): where edges have no direction on average */
  double form[6];             /* the lift y^T form y, of which xx, yy, zz, xy, yz, zx */
  double scale[4];            /* of the planes */
  chi_buffer planes;          /* int32 [4 x tetrahedra]: gradient, value at the center */
  chi_buffer groups;          /* uint32 [group_count + 1] where its members start */
  chi_buffer members;         /* chi_order_member [member_count] */
  chi_buffer heights;         /* double [points], while it is sought, in place of the form */
  chi_buffer outliers;        /* chi_order_outlier [outlier_count] */
  size_t group_count, member_count, outlier_count;
  int64_t tied, wrong; /* faces */
  int32_t usable;      /* faces that are not told apart lie within small groups, none is wrong */
} chi_order_lift;

/* `general`: 1: forms other than |x|^2 are tried where that is not strictly convex; 2: then
 * heights, which say nothing of bodies that are not convex. */
chi_status chi_order_lift_find(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, int general);
/* Whether all points lie above each plane: then the body need not be convex. */
chi_status chi_order_lift_supports(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, int32_t* supports);
/* A point in the lift's coordinates. */
void chi_order_lower(const chi_order_lift* lift, const double x[3], double y[3]);
/* Heights by vertex that make all interior faces convex, as far as floats tell; `found` 0: none,
 * and lift->form is lost. */
chi_status chi_order_heights_find(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, int* found);
void chi_order_lift_free(const chi_exec* exec, chi_order_lift* lift);

/* Where one looks from, in the mesh's own coordinates. */
typedef struct chi_order_eye
{
  double at[3];      /* perspective: the eye; parallel: the direction towards it */
  double to_eye[16]; /* points to the eye's space */
  int32_t parallel;
  const chi_camera* camera;
} chi_order_eye;

chi_status chi_order_mesh_check(
  const chi_exec* exec, const chi_tet_mesh_view* given, chi_tet_mesh_view* mesh);

/* Adopts and checks a view; the camera is kept in `camera`, to which the eye refers. */
chi_status chi_order_eye_find(
  const chi_tet_order_view* given, chi_camera* camera, chi_order_eye* eye);

/* 1: the eye is beyond the face of a tetrahedron, -1: on its side, 0: in the face's plane. */
static inline int chi_order_side(const chi_order_eye* eye, const double x[4][3], size_t i)
{
  const uint8_t* const f = chi_order_face[i];
  return eye->parallel ? chi_plane_side_far(x[f[0]], x[f[1]], x[f[2]], eye->at)
                       : chi_plane_side(x[f[0]], x[f[1]], x[f[2]], eye->at);
}

chi_status chi_order_centroid_keys(
  const chi_exec* exec, const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys);
chi_status chi_order_lift_keys(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys);

typedef struct chi_order_member
{
  uint32_t t;
  uint8_t near[4]; /* beyond each face: which member of the group; 255: none */
} chi_order_member;

/* Groups of tetrahedra whose keys tie: kept from the analysis, put right after the keys. */
chi_status chi_order_groups_build(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const uint32_t* pairs,
  size_t pair_count);
chi_status chi_order_groups_repair(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys);

/* The rays of the pixels, and what of them a body covers. */
typedef struct chi_order_window
{
  double first[2], step[2]; /* at depth 1, or in parallel projection */
  double near_depth;
  int32_t size[2], parallel;
} chi_order_window;

typedef struct chi_order_box /* of pixels; empty where y[0] > y[1] */
{
  int16_t x[2], y[2];
} chi_order_box;

chi_order_window chi_order_window_of(const chi_order_eye* eye);
/* x and y of the eye's space, and the depth. */
void chi_order_to_eye(const chi_order_eye* eye, const double x[3], double v[3]);
/* Of the convex hull of points in that space. */
chi_order_box chi_order_box_of(const chi_order_window* w, const double (*v)[3], int count);

/* "from" is drawn before "to". */
typedef struct chi_order_relation
{
  uint32_t from, to;
} chi_order_relation;

typedef struct chi_order_sort
{
  chi_buffer sides;   /* uint8 [tetrahedra]: bit i: the eye is beyond face i, 4 + i: not */
  chi_buffer waiting; /* uint32 [tetrahedra] */
  chi_buffer queue;   /* uint32 [tetrahedra]: the order, farthest first */
  chi_buffer walk;    /* uint32 [2 x tetrahedra], where there are cycles */
  chi_buffer spare;   /* uint32 [tetrahedra] */
  chi_buffer relations, relation_starts;          /* beyond those of faces: from each tetrahedron */
  chi_buffer boxes, bands, counts, events, found; /* of chi_order_exterior_find */
  size_t relation_count;
  int64_t cycles;
  size_t ordered;   /* tetrahedra in the queue as the last keys had them; 0: there were cycles */
  int64_t replaced; /* tetrahedra whose places were looked for */
} chi_order_sort;

typedef struct chi_order_sorter
{
  const chi_tet_mesh_view* mesh;
  const uint32_t* neighbors;
  const chi_order_eye* eye;
  const chi_order_relation* relations; /* sorted by "from"; NULL: none */
  const uint32_t* starts;              /* [count + 1] */
  size_t relation_count;
  const uint8_t* sides;
  uint32_t *waiting, *queue, *keys;
  uint32_t *path, *visit; /* of the search for cycles */
  size_t head, tail;
} chi_order_sorter;

enum
{
  CHI_ORDER_REPAIRED,
  CHI_ORDER_TOO_MUCH, /* to be sorted as a whole; nothing is lost */
  CHI_ORDER_SPOILED   /* likewise, but what is waited for is lost: there is a cycle */
};

/* Puts right what has changed since the last order. */
chi_status chi_order_repair(
  const chi_exec* exec, chi_order_sort* sort, chi_order_sorter* s, size_t count, int* outcome);

/* Ranks along the relations of faces, and of the pairs that chi_order_exterior_find has left. */
chi_status chi_order_sort_find(const chi_exec* exec, chi_order_sort* sort,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const chi_order_eye* eye,
  uint32_t* keys);
void chi_order_sort_free(const chi_exec* exec, chi_order_sort* sort);

/* Relations between faces without neighbours, at the pixels' centres. */
chi_status chi_order_exterior_find(const chi_exec* exec, chi_order_sort* sort,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const chi_order_eye* eye);

#endif
