/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_COMPONENTS_H
#define CHI_COMPONENTS_H

#include "chi_transfer.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_MAX_COMPONENTS = 4
};

/**
 * Samples of several components: component c of a sample lies c * chi_type_size(type) bytes after
 * the first; the stride of the volume view is that of whole samples. A sample with a component that
 * is not finite is transparent. Shading and gradient opacity are not for several components.
 *
 * Independent: each has its own functions (the frame's transfer is the first one's) and a weight;
 * with extinctions sigma_c, extinction = sum sigma_c^2 / sum w_c sigma_c and emission = sum w_c
 * sigma_c colour_c, over those of positive weight, as vtkGPUVolumeRayCastMapper composes them.
 *
 * Dependent: the frame's transfer makes opacity of the last component. Of two, transfer[0] makes
 * colours of the first one; of four, the first three are red, green and blue: divided by 255 where
 * they are 8-bit integers, else taken as they are, clamped to 0 ... 1.
 */
typedef struct chi_components
{
  size_t struct_size;
  int32_t count;                                             /**< 2 ... 4; dependent: 2 or 4 */
  int32_t dependent;                                         /**< 0: each by itself */
  const chi_transfer_view* transfer[CHI_MAX_COMPONENTS - 1]; /**< of the components after the first,
                        or, dependent of two, the colours' */
  double weight[CHI_MAX_COMPONENTS];                         /**< of independent ones, 0 ... 1 */
} chi_components;

#ifdef __cplusplus
}
#endif
#endif
