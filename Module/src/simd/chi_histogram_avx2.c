/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_histogram_kernels.inl"

const chi_histogram_kernels chi_histogram_kernels_avx2 = { put_block };
