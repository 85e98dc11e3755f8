/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Inner loops of the occlusion renderer; compiled once per instruction set (see the files that
 * include this one). Fused multiply-adds are allowed here: results differ between instruction sets
 * by rounding, and not between threads or schedules.
 */

#include "chi_occlusion_kernels.h"
#include "chi_vec.h"

#include <math.h>

#include "chi_occlusion_sample.inl"

#include "chi_occlusion_light.inl"

#include "chi_vicinity.inl"
