/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_kernels.inl"

const chi_occlusion_kernels chi_kernels_generic = { "generic", CHI_LANES, sample, light, blur,
  halve, path_lengths, farthest, block, enlarge, vicinity };
