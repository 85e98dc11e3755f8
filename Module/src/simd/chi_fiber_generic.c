/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_fiber_kernels.inl"

const chi_fiber_kernels chi_fiber_kernels_generic = { classify };
