/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_kernels.inl"

const chi_tet_kernels chi_tet_kernels_generic = { ranges, draw, draw_cached, merge };
