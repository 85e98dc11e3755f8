/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_segment_kernels.inl"

const chi_segment_kernels chi_segment_kernels_avx512 = { evaluate };
