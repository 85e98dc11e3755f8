/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_PREINTEGRATION_H
#define CHI_PREINTEGRATION_H

/*
 * Volume rendering integral of a segment of a ray along which the scalar is linear: what a cell
 * with a linear scalar adds to a pixel. Sources: Williams & Max, "A Volume Density Optical Model",
 * 1992; Roettger, Kraus & Ertl, "Hardware-Accelerated Volume and Isosurface Rendering Based on
 * Cell-Projection", 2000; Engel, Kraus & Ertl, "High-Quality Pre-Integrated Volume Rendering Using
 * Hardware-Accelerated Pixel Shading", 2001; Kraus, Qiao & Ebert, "Projecting Tetrahedra Without
 * Rendering Artifacts", 2004; Moreland & Angel, "A Fast High Accuracy Volume Renderer for
 * Unstructured Data", 2004. The formulas stand in Documentation/theory/preintegration.md.
 */

#include "chi_transfer.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** How a segment's colour and opacity follow from the transfer function between its ends. */
enum
{
  CHI_PREINTEGRATION_AUTO = 0,    /**< partial where that is good enough, else full */
  CHI_PREINTEGRATION_NONE = 1,    /**< colour and extinction of the middle scalar */
  CHI_PREINTEGRATION_PARTIAL = 2, /**< both linear from end to end: Moreland & Angel's psi */
  CHI_PREINTEGRATION_FULL = 3     /**< all that the transfer function does between the ends */
};

/** What an opacity of the transfer function means. */
enum
{
  CHI_OPACITY_LINEAR = 0, /**< extinction = opacity / unit_distance: vtkProjectedTetrahedraMapper */
  CHI_OPACITY_IMAGE = 1   /**< -ln(1 - min(opacity, 1 - 1e-6)) / unit_distance: the mappers of
                               images, where a path of unit_distance has that opacity */
};

enum
{
  CHI_PSI_SIZE = 128 /**< entries of the table of psi, each way */
};

typedef struct chi_preintegration_params
{
  size_t struct_size;
  int32_t method;             /**< CHI_PREINTEGRATION_...; default AUTO */
  int32_t opacity_convention; /**< CHI_OPACITY_...; default LINEAR */
  double longest_segment;     /**< no segment is longer, world units: what AUTO judges opacity by;
                                   0 = the transfer function's unit distance (default) */
  double segment_range;       /**< no segment's ends differ by more, scalar units: what AUTO judges
                                   linearity over; 0 = the transfer function's range (default) */
  int32_t full_scalars; /**< entries of the full table along each scalar axis, 4 ... 512; 0 = 128 */
  int32_t full_depths; /**< along that of the optical depth, 4 ... 64; 0 = 32. At most 2^22 entries,
                            64 MiB, together */
  int32_t direct_color; /**< non-zero: colour is no function of the scalar but given, and linear
                             between the ends of a segment; rgb is not read. What leaves a segment
                             is c_front (1 - T - w) + c_back w, T being its transmittance. In the
                             tables red stands for the place of what is seen, from front (0) to
                             back (1): `full` holds w / (1 - T); `color` and the other colours
                             mean nothing. Default 0 */
  int32_t reserved;
} chi_preintegration_params;

/**
 * Tables of one transfer function for segments; an engine reads these alone, through
 * Module/src/simd/chi_segment.inl or as textures. Owned by the handle, valid until its next call.
 * A scalar's place in the 1-D tables is x = (scalar - range[0]) / (range[1] - range[0]) * (count -
 * 1), clamped to 0 ... count - 1; colour and extinction are linear from entry to entry, and are not
 * multiplied with each other.
 */
typedef struct chi_segment_tables
{
  size_t struct_size;
  int32_t method; /**< CHI_PREINTEGRATION_NONE, _PARTIAL or _FULL: never AUTO */
  int32_t count;  /**< entries of the 1-D tables; each has one more, the last one again */
  double range[2];
  const float (*color)[4]; /**< [count + 1] red, green, blue, extinction per world unit */
  /** [count + 1] extinction; the integral of the extinction from entry 0 to here, world^-1 x
   * entries, as the sum of two floats, larger one first, so that its differences lose nothing; the
   * place on the two scalar axes of `full`, linear from entry to entry. */
  const float (*depth)[4];
  const float* psi; /**< [CHI_PSI_SIZE x CHI_PSI_SIZE] psi(tau_front, tau_back), tau_front fastest;
                         entry i belongs to gamma = i / (CHI_PSI_SIZE - 1) = tau / (1 + tau) */
  /** FULL: colour that leaves a segment, divided by its opacity; NULL of the others.
   * [full_size[2]][full_size[1]][full_size[0]] of red, green, blue, 0; x: place of the front
   * scalar, y: of the back scalar, both as depth[.][3] says; z: entry i belongs to gamma = i /
   * (full_size[2] - 1) = tau / (1 + tau) of the segment's whole optical depth. */
  const float (*full)[4];
  int32_t full_size[3];
  uint64_t version; /**< differs whenever the tables do */
} chi_segment_tables;

/** Owner of the tables, which are made anew only where their sources change. One handle serves one
 * thread of calls at a time. */
typedef struct chi_preintegration chi_preintegration;

/** The defaults named above. Infallible. */
CHI_API void chi_preintegration_default_params(chi_preintegration_params* params);

CHI_API CHI_NODISCARD chi_status chi_preintegration_create(
  const chi_exec* exec, chi_preintegration** preintegration);
CHI_API void chi_preintegration_destroy(const chi_exec* exec, chi_preintegration* preintegration);

/**
 * Make the tables of a transfer function, or keep them where neither it nor the parameters have
 * changed.
 *
 * @param[in]     exec            host services, or NULL; alloc and release must be those of create
 * @param[in,out] preintegration  the tables
 * @param[in]     transfer        rgb (but for direct_color), opacity, count, range, unit_distance
 * and version are read; one table, over the scalar alone
 * @param[in]     params          NULL: the defaults
 *
 * @retval CHI_OK                      the tables are those of transfer and params
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, entry that is not finite, empty range, unit
 * distance or parameter out of range, more than one table, a table over two quantities; the old
 * tables stand
 * @retval CHI_ERROR_OUT_OF_MEMORY     the tables are lost, the handle stays usable
 * @retval CHI_ERROR_CANCELLED         the tables are lost, the handle stays usable
 *
 * Precision    1-D tables in double, stored as float; optical depth of a segment to 1e-6 of itself
 *              plus 1e-7 of its neighbourhood.
 * Determinism  same bits for any number of threads and any parallel_for.
 * Non-finite   rejected.
 */
CHI_API CHI_NODISCARD chi_status chi_preintegration_update(const chi_exec* exec,
  chi_preintegration* preintegration, const chi_transfer_view* transfer,
  const chi_preintegration_params* params);

/** The tables of the last update; all zero and NULL before the first, or where it lost them. */
CHI_API void chi_preintegration_get_tables(
  const chi_preintegration* preintegration, chi_segment_tables* tables);

/**
 * Colour and opacity of segments, as the engines compute them.
 *
 * @param[in]  tables  as of chi_preintegration_get_tables, not empty
 * @param[in]  count   segments
 * @param[in]  x0      [count] place of the front end's scalar in the tables; clamped, NaN: 0
 * @param[in]  x1      [count] of the back end's scalar
 * @param[in]  length  [count] world units; negative, NaN: 0
 * @param[out] rgba    [count x 4] premultiplied colour, opacity; undefined where an input is
 * infinite
 *
 * @retval CHI_OK                      rgba holds all segments
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer with count > 0, unknown method; nothing written
 * @retval CHI_ERROR_NOT_READY         empty tables
 *
 * Precision    see theory/preintegration.md.
 * Determinism  same bits on one instruction set, wherever in the arrays a segment stands; between
 *              instruction sets <= 1e-5.
 * Non-finite   as said above; never in rgba.
 */
CHI_API CHI_NODISCARD chi_status chi_segment_evaluate(const chi_segment_tables* tables,
  size_t count, const float* x0, const float* x1, const float* length, float* rgba);

#ifdef __cplusplus
}
#endif
#endif
