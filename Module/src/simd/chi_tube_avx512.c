/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tube_kernels.inl"

const chi_tube_kernels chi_tube_kernels_avx512 = { place, turns, ring };
