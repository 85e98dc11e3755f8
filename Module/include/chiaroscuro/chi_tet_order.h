/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_ORDER_H
#define CHI_TET_ORDER_H

/*
 * Visibility order of tetrahedra. Sources: Williams, "Visibility-Ordering Meshed Polyhedra", 1992
 * (MPVO); Silva, Mitchell & Williams, "An Exact Interactive Time Visibility Ordering Algorithm for
 * Polyhedral Cell Complexes", 1998 (XMPVO); Max, Hanrahan & Crawfis, "Area and Volume Coherence for
 * Efficient Visualization of 3D Scalar Functions", 1990 (power distance); Cook, Max, Silva &
 * Williams, "Image-Space Visibility Ordering for Cell Projection Volume Rendering of Unstructured
 * Data", 2004 (exterior faces at pixels). Documentation/theory/tet_order.md.
 */

#include "chi_camera.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** An order: what is known of a mesh once, and the last keys. One handle serves one thread of calls
 * at a time. */
typedef struct chi_tet_order chi_tet_order;

enum
{
  CHI_TET_ORDER_AUTO = 0,     /**< the first that is exact of: a lift's keys, MPVO, XMPVO */
  CHI_TET_ORDER_CENTROID = 1, /**< distance of the centroid in the world: to the eye, or, parallel,
                                   along the axis */
  CHI_TET_ORDER_TANGENTIAL = 2, /**< power distance of the eye to the circumsphere, in the mesh's
                                   own coordinates */
  CHI_TET_ORDER_MPVO = 3,       /**< topological sort along faces; for convex meshes */
  CHI_TET_ORDER_XMPVO = 4       /**< and along the gaps between exterior faces, as the view's pixels
                                     see them; for any mesh */
};

/** Tetrahedra, borrowed; all must stay as they are while an order made of them lives. */
typedef struct chi_tet_mesh_view
{
  size_t struct_size;
  chi_vec3_view points;     /**< at most 2^31 - 1, any coordinates ("grid space") */
  const uint32_t* vertices; /**< [count x 4], right-handed or flat: (b - a) . ((c - a) x (d - a)) is
                                 not negative */
  size_t count;             /**< below 2^30 - 1 */
} chi_tet_mesh_view;

/** From where one looks. */
typedef struct chi_tet_order_view
{
  size_t struct_size;
  const chi_camera* camera;    /**< at most 16384 pixels a side; XMPVO alone reads the window */
  const double* grid_to_world; /**< row-major 4 x 4, affine; NULL: identity */
} chi_tet_order_view;

/** What is known of the mesh, and of the last keys. Faces are not looked for by CENTROID. */
typedef struct chi_tet_order_info
{
  size_t struct_size;
  int32_t used; /**< CHI_TET_ORDER_... of the keys; never AUTO. TANGENTIAL where AUTO found
                     a lift, whichever */
  int32_t lift; /**< 1: keys are exact: the lift is convex across all faces, and the mesh is convex
                   or part of the convex surface over its points */
  int64_t cycles;         /**< broken in the last keys */
  int64_t interior_faces; /**< between two tetrahedra */
  int64_t boundary_faces; /**< of one tetrahedron */
  int64_t bad_faces;      /**< of more than two, or of two on the same side */
  int64_t tied_faces;     /**< of the lift: where keys do not tell one side from the other */
  int64_t wrong_faces;    /**< of the lift: where keys go the wrong way */
  int32_t pieces;         /**< parts that hang together by faces */
  int32_t convex;         /**< 1: the mesh fills a convex body, up to the rounding of coordinates */
  int32_t reused;         /**< 1: the last keys stand */
  size_t bytes;           /**< held */
  double seconds_analysis, seconds_keys; /**< of wall clock */
  int64_t sorted; /**< tetrahedra whose places were looked for in the last topological sort: all, or
                       those between which relations have turned since the order before */
} chi_tet_order_info;

/**
 * Look at a mesh, once.
 *
 * @param[in]  exec    host services, or NULL
 * @param[in]  mesh    tetrahedra, borrowed as long as the order lives
 * @param[in]  method  CHI_TET_ORDER_...
 * @param[out] order   the order; NULL where the call fails
 *
 * @retval CHI_OK                      made
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, unknown method, vertex out of range
 * @retval CHI_ERROR_TOO_LARGE         more points or tetrahedra than stated above
 * @retval CHI_ERROR_OUT_OF_MEMORY     nothing is kept
 * @retval CHI_ERROR_CANCELLED         likewise
 *
 * Precision    a face counts as convex where that is certain in double, and by more than the keys'
 *              resolution: a Delaunay mesh is not trusted.
 * Determinism  same results for any number of threads and any parallel_for.
 * Non-finite   tetrahedra with such coordinates have no lift: AUTO then sorts.
 * Cost         linear; up to 100 bytes a tetrahedron while it runs, then up to 16 with a lift, up
 * to 25 where faces are sorted, and what the exterior faces' pixels take.
 */
CHI_API CHI_NODISCARD chi_status chi_tet_order_create(
  const chi_exec* exec, const chi_tet_mesh_view* mesh, int32_t method, chi_tet_order** order);

CHI_API void chi_tet_order_destroy(const chi_exec* exec, chi_tet_order* order);

/**
 * A key a tetrahedron, ascending from the farthest to the nearest; equal keys are ordered by index.
 *
 * @param[in]     exec   host services, or NULL; alloc and release must be those of create
 * @param[in,out] order  the order
 * @param[in]     view   from where one looks
 * @param[out]    keys   [count]; where it is the array of the last call and so is all that the keys
 *                       depend on, it is taken to hold them still
 * @param[out]    bits   keys are below 2^bits; 1 ... 32
 *
 * @retval CHI_OK                      keys are those of the view
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, singular or non-finite matrix, no pixels or
 * more than stated above; keys are as they were
 * @retval CHI_ERROR_TOO_LARGE         more than 2^32 - 1 exterior faces over all pixels; keys are
 *                                     undefined
 * @retval CHI_ERROR_OUT_OF_MEMORY, CHI_ERROR_CANCELLED  keys are undefined, the order stays usable
 *
 * Precision    keys of a lift have 32 bits; they are wrong only where the eye is nearer to a face's
 *              plane than these tell, below 1e-7 rad for a million cells. Sorts are exact: signs
 * are. Determinism  same keys for any number of threads and any parallel_for. Non-finite tetrahedra
 * with such coordinates stand anywhere. Cost         1 ns a tetrahedron for a lift; a topological
 * sort takes some a hundred times as long. Allocates only where a view has more exterior faces at
 * its pixels than all before.
 */
CHI_API CHI_NODISCARD chi_status chi_tet_order_keys(const chi_exec* exec, chi_tet_order* order,
  const chi_tet_order_view* view, uint32_t* keys, int32_t* bits);

/** All zero but `used` and what the analysis found before the first keys. */
CHI_API void chi_tet_order_get_info(const chi_tet_order* order, chi_tet_order_info* info);

/**
 * How many pairs are in the wrong order: of tetrahedra that follow each other on the ray of a
 * pixel, with disjoint intervals of depth longer than 1e-9 of the extent. Rays are 1e-8 pixels off
 * the centre, so that they lie within no face of a grid that is seen along its axes.
 *
 * @param[in]  exec        host services, or NULL
 * @param[in]  mesh        tetrahedra
 * @param[in]  view        from where one looks
 * @param[in]  keys        [count] as of chi_tet_order_keys
 * @param[out] violations  pairs over all pixels
 *
 * @retval CHI_OK                      counted
 * @retval CHI_ERROR_INVALID_ARGUMENT  as of create and keys
 * @retval CHI_ERROR_TOO_LARGE, CHI_ERROR_OUT_OF_MEMORY, CHI_ERROR_CANCELLED  likewise
 *
 * Precision    planes in double.
 * Determinism  same count for any number of threads and any parallel_for.
 * Non-finite   tetrahedra with such coordinates cover nothing.
 * Cost         a slow path: some 50 ns a tetrahedron and pixel of its box; 8 bytes a tetrahedron
 *              and 24 for each such pixel within 32 rows.
 */
CHI_API CHI_NODISCARD chi_status chi_tet_order_violations(const chi_exec* exec,
  const chi_tet_mesh_view* mesh, const chi_tet_order_view* view, const uint32_t* keys,
  int64_t* violations);

#ifdef __cplusplus
}
#endif
#endif
