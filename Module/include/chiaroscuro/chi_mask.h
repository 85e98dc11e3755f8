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

#ifdef __cplusplus
}
#endif
#endif
