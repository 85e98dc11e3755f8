/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples of several components: bricks and tables of each, bricks occupied by any. */

#include "chi_components_internal.h"

#include <math.h>
#include <string.h>

int chi_components_are_valid(const chi_components* c, const chi_volume_view* volume)
{
  const int needed = !c->dependent ? c->count - 1 : c->count == 2;
  if (!volume || c->count < 2 || c->count > CHI_MAX_COMPONENTS || (c->dependent && c->count == 3) ||
    volume->stride < (size_t)c->count * chi_type_size(volume->type))
  {
    return 0;
  }
  for (int k = 0; k < needed; ++k)
  {
    if (!chi_transfer_is_valid(c->transfer[k]))
    {
      return 0;
    }
  }
  for (int k = 0; k < c->count && !c->dependent; ++k)
  {
    if (!(c->weight[k] >= 0 && c->weight[k] <= 1))
    {
      return 0;
    }
  }
  return 1;
}

chi_volume_view chi_component_view(const chi_volume_view* volume, const chi_components* c, int k)
{
  chi_volume_view view = *volume;
  if (c)
  {
    const int at = !c->dependent ? k : k == 0 ? c->count - 1 : k - 1;
    view.scalars = (const char*)volume->scalars + (size_t)at * chi_type_size(volume->type);
  }
  return view;
}

chi_component_key chi_components_key(const chi_components* c)
{
  chi_component_key key;
  memset(&key, 0, sizeof key);
  if (c)
  {
    key.count = c->count;
    key.dependent = c->dependent != 0;
    for (int k = 0; k < c->count; ++k)
    {
      key.weight[k] = c->dependent ? 1 : c->weight[k];
      const chi_transfer_view* const t = !c->dependent && k + 1 < c->count ? c->transfer[k]
        : c->dependent && c->count == 2 && k == 0                          ? c->transfer[0]
                                                                           : NULL;
      if (t)
      {
        key.tables[k][0] = t->rgb;
        key.tables[k][1] = t->opacity;
        key.version[k] = t->version;
        key.entries[k] = t->count;
        key.numbers[k][0] = t->range[0];
        key.numbers[k][1] = t->range[1];
        key.numbers[k][2] = t->unit_distance;
      }
    }
  }
  return key;
}

chi_status chi_components_build(const chi_exec* exec, chi_component_set* set,
  const chi_volume_view* volume, const chi_components* c)
{
  chi_status status = CHI_OK;
  set->non_finite = 0;
  for (int k = 1; c && k < c->count && status == CHI_OK; ++k)
  {
    const chi_volume_view view = chi_component_view(volume, c, k);
    status = chi_bricks_build(exec, &set->bricks[k - 1], &view);
    set->non_finite += status == CHI_OK ? set->bricks[k - 1].non_finite : 0;
  }
  return status;
}

chi_status chi_components_classify(const chi_exec* exec, chi_component_set* set,
  chi_classification* own, const chi_bricks* bricks, const chi_components* c, int dilate)
{
  if (!c || (c->dependent && c->count == 4))
  {
    return CHI_OK;
  }
  const size_t count = bricks->count[0] * bricks->count[1] * bricks->count[2];
  uint8_t* const occupied = (uint8_t*)own->occupied.data;
  chi_status status = CHI_OK;
  if (!c->dependent && !(c->weight[0] > 0))
  {
    memset(occupied, 0, count);
  }
  for (int k = 1; k < c->count && status == CHI_OK; ++k)
  {
    chi_classification* const more = &set->classification[k - 1];
    status = chi_classify(exec, more, &set->bricks[k - 1], c->transfer[k - 1], dilate);
    const uint8_t* const there = (const uint8_t*)more->occupied.data;
    for (size_t i = 0; i < count && status == CHI_OK && !c->dependent && c->weight[k] > 0; ++i)
    {
      occupied[i] |= there[i];
    }
  }
  if (status == CHI_OK)
  {
    own->occupied_bricks = chi_bricks_sum(bricks, occupied, (int32_t*)own->sums.data);
  }
  return status;
}

void chi_components_prepare(
  const chi_component_set* set, const chi_components* c, int type, chi_plan_components* out)
{
  memset(out, 0, sizeof *out);
  out->dependent = c->dependent != 0;
  out->count = c->count - 1;
  for (int k = 0; k < c->count; ++k)
  {
    out->weight[k] = c->dependent ? 1 : (float)c->weight[k];
  }
  for (int k = 0; k < out->count; ++k)
  {
    const chi_bricks* const b = &set->bricks[k];
    chi_plan_component* const more = &out->more[k];
    more->scalars = b->scalars;
    if (c->dependent && c->count == 4)
    {
      /* no table: the position in it is the colour */
      const double first = -b->copy_offset * b->copy_scale;
      const double scale = 1 / (b->copy_scale * (type == CHI_U8 ? 255 : 1));
      more->base = (float)first;
      more->scale = (float)scale;
      more->offset = (float)(((double)more->base - first) * scale);
      more->end = 1;
      continue;
    }
    const chi_classification* const t = &set->classification[k];
    more->base = t->base;
    more->scale = t->scale;
    more->offset = t->offset;
    more->end = (float)(t->entries - 1);
    more->quantum = t->quantum;
    more->entries = (int32_t)t->entries;
    more->table = (const chi_plan_entry*)t->sigma.data;
    more->rgba = (const float(*)[4])t->rgba.data;
  }
}

void chi_components_frame(const chi_component_set* set, const chi_sample_frame* own,
  chi_sample_frame* more, chi_component_frame* out)
{
  out->more = more;
  for (int k = 0; k < out->plan.count; ++k)
  {
    const chi_plan_component* const component = &out->plan.more[k];
    more[k] = *own;
    more[k].scalars = component->scalars;
    more[k].fetch = set->bricks[k].fetch;
    more[k].base = component->base;
    more[k].scale = component->scale;
    more[k].offset = component->offset;
    more[k].table_end = component->end;
    more[k].sigma = component->table;
    more[k].rgba = component->rgba;
    more[k].quantum = component->quantum;
  }
}

void chi_components_free(const chi_exec* exec, chi_component_set* set)
{
  for (int k = 0; k < CHI_MAX_COMPONENTS - 1; ++k)
  {
    chi_bricks_free(exec, &set->bricks[k]);
    chi_classification_free(exec, &set->classification[k]);
  }
}
