/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_scatterplot_kernels.inl"
#include "chi_scatterplot_splat.inl"

const chi_scatter_kernels chi_scatter_kernels_avx512 = { brick, classify, edges, flush, map,
  extremes, sections, straddling };
