/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_COMPONENTS_INTERNAL_H
#define CHI_COMPONENTS_INTERNAL_H

#include "chi_occlusion_internal.h"

/* What is kept of the components besides the first one (dependent: the last one), which has the
 * place of a single one. Numbers k count that one as 0. */
typedef struct chi_component_set
{
  chi_bricks bricks[CHI_MAX_COMPONENTS - 1];
  chi_classification classification[CHI_MAX_COMPONENTS - 1];
  int64_t non_finite;
} chi_component_set;

/* What the set was made from, besides the volume and the frame's own transfer. */
typedef struct chi_component_key
{
  const void* tables[CHI_MAX_COMPONENTS][2];
  uint64_t version[CHI_MAX_COMPONENTS];
  size_t entries[CHI_MAX_COMPONENTS];
  double numbers[CHI_MAX_COMPONENTS][3], weight[CHI_MAX_COMPONENTS];
  int64_t count, dependent;
} chi_component_key;

int chi_transfer_is_valid(const chi_transfer_view* transfer);
int chi_components_are_valid(const chi_components* c, const chi_volume_view* volume);
chi_component_key chi_components_key(const chi_components* c);

/* The samples of component k; c may be NULL. */
chi_volume_view chi_component_view(const chi_volume_view* volume, const chi_components* c, int k);

chi_status chi_components_build(const chi_exec* exec, chi_component_set* set,
  const chi_volume_view* volume, const chi_components* c);

/* `own` has been classified; its bricks become those that any component makes visible. */
chi_status chi_components_classify(const chi_exec* exec, chi_component_set* set,
  chi_classification* own, const chi_bricks* bricks, const chi_components* c, int dilate);

/* What both engines need of them; `type` is the volume's. */
void chi_components_prepare(
  const chi_component_set* set, const chi_components* c, int type, chi_plan_components* out);

/* The same for the kernels, from out->plan; `more` has room for CHI_MAX_COMPONENTS - 1. */
void chi_components_frame(const chi_component_set* set, const chi_sample_frame* own,
  chi_sample_frame* more, chi_component_frame* out);

void chi_components_free(const chi_exec* exec, chi_component_set* set);

#endif
