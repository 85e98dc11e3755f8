/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_ORDER_H
#define CHI_TET_ORDER_H
/* Visibility order of tetrahedra. Sources: Williams 1992 (MPVO), Silva, Mitchell & Williams 1998
 * (XMPVO), Max, Hanrahan & Crawfis 1990 / Karasick et al. 1997 (tangential distance, power order),
 * Cook, Max, Silva & Williams 2004 (image-space order of exterior faces). */
#include "chi_camera.h"

#ifdef __cplusplus
extern "C"
{
#endif
typedef struct chi_tet_order chi_tet_order;
enum
{
  CHI_TET_ORDER_AUTO = 0,
  CHI_TET_ORDER_CENTROID = 1,   /* distance of the centroid */
  CHI_TET_ORDER_TANGENTIAL = 2, /* power distance to the circumsphere */
  CHI_TET_ORDER_MPVO = 3,       /* adjacency; convex meshes */
  CHI_TET_ORDER_XMPVO = 4       /* adjacency and exterior faces of the view's pixels */
};
/** Tetrahedra, borrowed; all must stay as they are while an order made of them lives. */
typedef struct chi_tet_mesh_view
{
  size_t struct_size;
  chi_vec3_view points;     /* any coordinates ("grid space") */
  const uint32_t* vertices; /* [count x 4], right-handed or flat */
  size_t count;
} chi_tet_mesh_view;

typedef struct chi_tet_order_view /* from where one looks */
{
  size_t struct_size;
  const chi_camera* camera;
  const double* grid_to_world; /* row-major 4 x 4, affine; NULL: identity */
} chi_tet_order_view;

typedef struct chi_tet_order_info
{
  size_t struct_size;
  int32_t used;   /* CHI_TET_ORDER_... of the last keys; never AUTO */
  int32_t lift;   /* 1: an exact lift is known (keys are exact), 0: not */
  int64_t cycles; /* broken in the last keys */
  int64_t interior_faces, boundary_faces, bad_faces /* shared by more than two */;
  int64_t tied_faces, wrong_faces; /* of the lift: faces across which keys tie or are wrong */
  int32_t pieces,
    convex; /* connected components; 1: the union of the mesh is convex as far as faces tell */
  int32_t reused; /* the last keys stand */
  size_t bytes;   /* held */
  double seconds_analysis, seconds_keys;
} chi_tet_order_info;

CHI_API CHI_NODISCARD chi_status chi_tet_order_create(
  const chi_exec*, const chi_tet_mesh_view*, int32_t method, chi_tet_order**);
CHI_API void chi_tet_order_destroy(const chi_exec*, chi_tet_order*);
/* keys[i]: ascending from the farthest to the nearest; equal keys: by index. `bits`: keys < 2^bits,
 * <= 32. */
CHI_API CHI_NODISCARD chi_status chi_tet_order_keys(
  const chi_exec*, chi_tet_order*, const chi_tet_order_view*, uint32_t* keys, int32_t* bits);
CHI_API void chi_tet_order_get_info(const chi_tet_order*, chi_tet_order_info*);

#ifdef __cplusplus
}
#endif
#endif
