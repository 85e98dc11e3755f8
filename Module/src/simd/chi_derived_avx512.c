/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_derived_kernels.inl"

const chi_derived_kernels chi_derived_kernels_avx512[2] = CHI_DERIVED_KERNELS;
