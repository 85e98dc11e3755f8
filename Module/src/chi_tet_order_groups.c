/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tetrahedra that a lift does not tell apart, such as those between points of one sphere, have
 * nearly equal keys: within such a group keys are dealt out anew, in the order of its faces.
 */
#include "chi_tet_order_internal.h"

enum
{
  GROUPS_A_TASK = 256,
  ALONE = 255
};

static uint32_t root_of(uint32_t* parent, uint32_t t)
{
  while (parent[t] != t)
  {
    parent[t] = parent[parent[t]];
    t = parent[t];
  }
  return t;
}

/* How many are in groups; -1 where one is too large. slot[t] becomes the size of t's group. */
static int64_t join(uint32_t* parent, uint32_t* slot, size_t n, const uint32_t* pairs, size_t count)
{
  for (size_t t = 0; t < n; ++t)
  {
    parent[t] = (uint32_t)t;
    slot[t] = 0;
  }
  for (size_t i = 0; i < count; ++i)
  {
    const uint32_t a = root_of(parent, pairs[2 * i]), b = root_of(parent, pairs[2 * i + 1]);
    parent[a < b ? b : a] = a < b ? a : b; /* a root is the lowest of its group */
  }
  int64_t members = 0;
  uint32_t most = 0;
  for (uint32_t t = 0; t < n; ++t)
  {
    const uint32_t size = ++slot[root_of(parent, t)];
    most = size > most ? size : most;
    members += size == 2 ? 2 : size > 2;
  }
  return most > CHI_ORDER_GROUP ? -1 : members;
}

/* Groups in the order of their first members, members ascending. */
static void gather(
  chi_order_lift* lift, uint32_t* parent, uint32_t* slot, size_t n, const uint32_t* neighbors)
{
  uint32_t* const starts = (uint32_t*)lift->groups.data;
  chi_order_member* const members = (chi_order_member*)lift->members.data;
  uint32_t at = 0, group = 0;
  for (uint32_t t = 0; t < n; ++t)
  {
    const uint32_t root = root_of(parent, t);
    if (root == t && slot[t] > 1)
    {
      const uint32_t size = slot[t];
      starts[group++] = at;
      slot[t] = at;
      at += size;
    }
    else if (root == t)
    {
      slot[t] = UINT32_MAX;
    }
    if (slot[root] != UINT32_MAX)
    {
      members[slot[root]++].t = t;
    }
  }
  starts[group] = at;
  for (uint32_t g = 0; g < group; ++g)
  {
    for (uint32_t i = starts[g]; i < starts[g + 1]; ++i)
    {
      for (size_t k = 0; k < 4; ++k)
      {
        const uint32_t u = neighbors[4 * (size_t)members[i].t + k];
        members[i].near[k] = ALONE;
        for (uint32_t j = starts[g]; j < starts[g + 1]; ++j)
        {
          members[i].near[k] = members[j].t == u ? (uint8_t)(j - starts[g]) : members[i].near[k];
        }
      }
    }
  }
}

chi_status chi_order_groups_build(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const uint32_t* pairs,
  size_t pair_count)
{
  const size_t n = mesh->count;
  chi_buffer parents = { 0 }, slots = { 0 };
  int64_t members = 0;
  int held = chi_buffer_reserve(exec, &parents, n, sizeof(uint32_t)) &&
    chi_buffer_reserve(exec, &slots, n, sizeof(uint32_t));
  if (held)
  {
    uint32_t *const parent = (uint32_t*)parents.data, *const slot = (uint32_t*)slots.data;
    members = join(parent, slot, n, pairs, pair_count);
    lift->usable = members >= 0;
    size_t groups = 0;
    for (size_t t = 0; t < n && members > 0; ++t)
    {
      groups += parent[t] == t && slot[t] > 1;
    }
    held = members <= 0 ||
      (chi_buffer_reserve(exec, &lift->groups, groups + 1, sizeof(uint32_t)) &&
        chi_buffer_reserve(exec, &lift->members, (size_t)members, sizeof(chi_order_member)));
    if (held && members > 0)
    {
      gather(lift, parent, slot, n, (const uint32_t*)adjacency->neighbors.data);
      lift->group_count = groups;
    }
  }
  chi_buffer_free(exec, &parents);
  chi_buffer_free(exec, &slots);
  return held ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
}

typedef struct repair_job
{
  const chi_order_lift* lift;
  const chi_tet_mesh_view* mesh;
  const chi_order_eye* eye;
  uint32_t* keys;
} repair_job;

/* Of the members behind which none is left the one with the lowest key, and so on; each gets the
 * lowest key left, and a higher one than the last. */
static void repair_group(const repair_job* it, const chi_order_member* members, size_t count)
{
  uint32_t sorted[CHI_ORDER_GROUP], waiting[CHI_ORDER_GROUP] = { 0 }, last = 0;
  uint8_t beyond[CHI_ORDER_GROUP];
  size_t order[CHI_ORDER_GROUP];
  for (size_t i = 0; i < count; ++i)
  {
    double x[4][3];
    chi_order_corners(it->mesh, members[i].t, x);
    beyond[i] = 0;
    for (size_t k = 0; k < 4; ++k)
    {
      const int j = members[i].near[k];
      if (j != ALONE && chi_order_side(it->eye, (const double(*)[3])x, k) > 0)
      {
        beyond[i] |= (uint8_t)(1 << k);
        ++waiting[j];
      }
    }
    const uint32_t key = it->keys[members[i].t];
    size_t at = i;
    for (; at > 0 && sorted[at - 1] > key; --at)
    {
      sorted[at] = sorted[at - 1];
    }
    sorted[at] = key;
  }
  for (size_t done = 0; done < count; ++done)
  {
    size_t next = count;
    for (size_t i = 0; i < count; ++i)
    {
      if (waiting[i] != UINT32_MAX &&
        (next == count || waiting[i] < waiting[next] ||
          (waiting[i] == waiting[next] && it->keys[members[i].t] < it->keys[members[next].t])))
      {
        next = i;
      }
    }
    order[done] = next;
    waiting[next] = UINT32_MAX;
    for (size_t k = 0; k < 4; ++k)
    {
      const size_t j = members[next].near[k];
      if (beyond[next] >> k & 1 && waiting[j] != UINT32_MAX)
      {
        --waiting[j];
      }
    }
  }
  for (size_t i = 0; i < count; ++i)
  {
    last = i && sorted[i] <= last ? last + 1 : sorted[i];
    it->keys[members[order[i]].t] = last;
  }
}

static void repair(void* data, size_t begin, size_t end)
{
  const repair_job* const it = (const repair_job*)data;
  const uint32_t* const starts = (const uint32_t*)it->lift->groups.data;
  for (size_t g = begin * GROUPS_A_TASK; g < end * GROUPS_A_TASK && g < it->lift->group_count; ++g)
  {
    repair_group(
      it, (const chi_order_member*)it->lift->members.data + starts[g], starts[g + 1] - starts[g]);
  }
}

chi_status chi_order_groups_repair(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys)
{
  repair_job job = { lift, mesh, eye, keys };
  return chi_for(exec, (lift->group_count + GROUPS_A_TASK - 1) / GROUPS_A_TASK, repair, &job);
}
