/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_MASK_H
#define CHI_MASK_H

/*
 * What is left of a volume. Whatever is cropped or masked neither draws nor blocks light: as if it
 * were not in the data.
 */

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_CROP_ALL_REGIONS = 0x7ffffff
};

/**
 * Cropping regions: three pairs of parallel planes part space into 3 x 3 x 3 regions. A position
 * lies in region i + 3 j + 9 k, where i counts the planes of the first pair on whose positive side
 * (a x + b y + c z + d >= 0, world coordinates) it lies, j those of the second pair, and k those of
 * the third. Cuts are exact: a segment counts by the length that is left of it.
 */
typedef struct chi_crop_view
{
  size_t struct_size;
  double planes[6][4]; /**< low x, high x, low y, ...; not all of a, b, c zero */
  uint32_t regions;    /**< bit r: region r stays; CHI_CROP_ALL_REGIONS: nothing is cropped */
} chi_crop_view;

/**
 * Voxels and cells that are masked, or labelled. All arrays are borrowed, any may be NULL.
 *
 * A voxel is the box of half a sample to all sides of its sample: what lies in it stays where the
 * voxel's value is greater than 0 (NaN is not). A cell lies between samples, or, where the samples
 * are those of cells, is the sample's own voxel; it is hidden where one of its own flags or of its
 * corner points' is among the bits that hide. Cuts are exact where slices lie up to two voxels
 * apart along every axis of the grid; a longer segment may miss voxels between its ends.
 */
typedef struct chi_mask_view
{
  size_t struct_size;
  const void* values;         /**< [samples of the volume], x fastest */
  chi_type type;              /**< of values: any */
  size_t stride;              /**< bytes from one value to the next; >= chi_type_size(type) */
  const uint8_t* point_flags; /**< [points]: samples, or, of cell data, one more along each axis */
  const uint8_t* cell_flags;  /**< [cells]: one less than samples along each axis, at least one;
                                   of cell data, the samples */
  uint8_t point_bits;         /**< of point_flags: the point hides its cells */
  uint8_t cell_bits;          /**< of cell_flags: the cell is hidden */
  uint64_t version;           /**< differs whenever any of the arrays does */
  /** Not NULL: the values are labels, and hide nothing; of a voxel whose value is v, rounded down,
   * table table_of_value[v] of the transfer view is used; table 0 of values that are not within 0
   * ... value_count - 1. A segment counts with the label at its far end: between labels the error
   * is up to half a segment of the one or the other, and shrinks with the distance of slices. */
  const uint8_t* table_of_value; /**< [value_count], each less than the transfer's table_count */
  size_t value_count;
} chi_mask_view;

#ifdef __cplusplus
}
#endif
#endif
