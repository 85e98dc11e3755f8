/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_derived_kernels.h"
#include "chi_internal.h"
#include "chi_vec.h"

#include <chiaroscuro/chi_grid.h>

#include <math.h>

#define CHI_HIDDEN CHI_GRID_HIDDEN_POINT

#define REAL float
#define INTEGER int32_t
#define ROOT sqrtf
#define NAME(verb) verb##_f32
#include "chi_derived_rows.inl"
#undef REAL
#undef INTEGER
#undef ROOT
#undef NAME

#define REAL double
#define INTEGER int64_t
#define ROOT sqrt
#define NAME(verb) verb##_f64
#include "chi_derived_rows.inl"

#define CHI_DERIVED_KERNELS                                                                        \
  {                                                                                                \
    { sizeof(float), load_f32, range_f32, across_f32, along_f32, curve_f32, finish_f32 },          \
    {                                                                                              \
      sizeof(double), load_f64, range_f64, across_f64, along_f64, curve_f64, finish_f64            \
    }                                                                                              \
  }
