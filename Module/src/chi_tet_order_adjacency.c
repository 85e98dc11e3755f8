/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Faces are dealt into parts by their lowest vertex, so that equal ones meet within a part and a
 * part's hash table stays in the first cache; parts are independent of each other.
 */
#include "chi_tet_order_internal.h"

enum
{
  PART_SHIFT = 8, /* vertices a part */
  HEADS = 4096    /* of a part's hash chains */
};

#define NONE UINT32_MAX
#define BAD (UINT32_MAX - 1)

/* A face: its vertices ascending, a's highest bit tells whether that is the outward sense. */
typedef struct face
{
  uint32_t a, b, c, id; /* id: 4 t + i */
} face;

typedef struct match_job
{
  const chi_tet_mesh_view* mesh;
  size_t parts, chunk;
  uint32_t* counts; /* [chunks x parts]: then where each chunk's faces go */
  size_t* starts;   /* [parts + 1] */
  face* faces;
  uint32_t* next; /* [faces] chains */
  uint32_t* neighbors;
  int64_t (*tally)[2]; /* [parts] pairs, bad */
} match_job;

static face face_of(const uint32_t* v, size_t t, size_t i)
{
  const uint8_t* const at = chi_order_face[i];
  uint32_t a = v[at[0]], b = v[at[1]], c = v[at[2]], swaps = 0, x;
#define CHI_SORT(p, q)                                                                             \
  if (q < p)                                                                                       \
  {                                                                                                \
    x = p;                                                                                         \
    p = q;                                                                                         \
    q = x;                                                                                         \
    ++swaps;                                                                                       \
  }
  CHI_SORT(a, b)
  CHI_SORT(b, c)
  CHI_SORT(a, b)
#undef CHI_SORT
  return (face){ a | (swaps & 1) << 31, b, c, (uint32_t)(4 * t + i) };
}

static size_t part_of(const face* f)
{
  return (f->a & 0x7fffffffu) >> PART_SHIFT;
}

static void count_faces(void* data, size_t begin, size_t end)
{
  const match_job* const it = (const match_job*)data;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    uint32_t* const count = it->counts + chunk * it->parts;
    memset(count, 0, it->parts * sizeof *count);
    for (size_t t = chunk * it->chunk; t < it->mesh->count && t < (chunk + 1) * it->chunk; ++t)
    {
      for (size_t i = 0; i < 4; ++i)
      {
        const face f = face_of(it->mesh->vertices + 4 * t, t, i);
        ++count[part_of(&f)];
      }
    }
  }
}

static void deal_faces(void* data, size_t begin, size_t end)
{
  const match_job* const it = (const match_job*)data;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    uint32_t* const next = it->counts + chunk * it->parts;
    for (size_t t = chunk * it->chunk; t < it->mesh->count && t < (chunk + 1) * it->chunk; ++t)
    {
      for (size_t i = 0; i < 4; ++i)
      {
        const face f = face_of(it->mesh->vertices + 4 * t, t, i);
        const size_t part = part_of(&f);
        it->faces[it->starts[part] + next[part]++] = f;
      }
    }
  }
}

/* The neighbour that a face had is none; 1 where it had one. */
static int part_from(const match_job* it, uint32_t neighbor, const face* f)
{
  for (size_t i = 0; neighbor != NONE && i < 4; ++i)
  {
    const face g = face_of(it->mesh->vertices + 4 * (size_t)neighbor, neighbor, i);
    if ((g.a ^ f->a) << 1 == 0 && g.b == f->b && g.c == f->c)
    {
      it->neighbors[g.id] = BAD;
    }
  }
  return neighbor != NONE;
}

/* Two tetrahedra that run through a face in opposite senses are neighbours. Of a face that more
 * than two have, or two on the same side, nobody is. */
static void match_faces(void* data, size_t begin, size_t end)
{
  const match_job* const it = (const match_job*)data;
  uint32_t heads[HEADS];
  for (size_t part = begin; part < end; ++part)
  {
    const size_t first = it->starts[part];
    memset(heads, 0xff, sizeof heads);
    int64_t pairs = 0, bad = 0;
    for (size_t k = first; k < it->starts[part + 1]; ++k)
    {
      const face f = it->faces[k];
      const uint32_t hash =
        ((f.a << 1) * 0x9e3779b1u ^ f.b * 0x85ebca6bu ^ f.c * 0xc2b2ae35u) * 0x27d4eb2fu >> 20;
      uint32_t at = heads[hash];
      while (at != NONE &&
        ((it->faces[first + at].a ^ f.a) << 1 || it->faces[first + at].b != f.b ||
          it->faces[first + at].c != f.c))
      {
        at = it->next[first + at];
      }
      if (at == NONE)
      {
        it->next[k] = heads[hash];
        heads[hash] = (uint32_t)(k - first);
        it->neighbors[f.id] = NONE;
        continue;
      }
      const face* const other = it->faces + first + at;
      uint32_t* const theirs = it->neighbors + other->id;
      if (*theirs == NONE && (other->a ^ f.a) >> 31)
      {
        *theirs = f.id / 4;
        it->neighbors[f.id] = other->id / 4;
        ++pairs;
        continue;
      }
      if (*theirs != BAD)
      {
        ++bad;
        pairs -= part_from(it, *theirs, &f);
        *theirs = BAD;
      }
      it->neighbors[f.id] = BAD;
    }
    it->tally[part][0] = pairs;
    it->tally[part][1] = bad;
  }
}

void chi_order_adjacency_free(const chi_exec* exec, chi_order_adjacency* adjacency)
{
  chi_buffer_free(exec, &adjacency->neighbors);
  chi_buffer_free(exec, &adjacency->exterior);
}

chi_status chi_order_adjacency_build(
  const chi_exec* exec, chi_order_adjacency* adjacency, const chi_tet_mesh_view* mesh)
{
  const size_t n = mesh->count, parts = (mesh->points.count >> PART_SHIFT) + 1;
  chi_buffer counts = { 0 }, starts = { 0 }, faces = { 0 }, next = { 0 }, tally = { 0 };
  chi_status status = CHI_ERROR_OUT_OF_MEMORY;
  if (!chi_buffer_reserve(exec, &adjacency->neighbors, 4 * n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &counts, CHI_ORDER_CHUNKS * parts, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &starts, parts + 1, sizeof(size_t)) ||
    !chi_buffer_reserve(exec, &faces, 4 * n, sizeof(face)) ||
    !chi_buffer_reserve(exec, &next, 4 * n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &tally, parts, 2 * sizeof(int64_t)))
  {
    goto done;
  }
  match_job job = { mesh, parts, chi_order_chunk(n), (uint32_t*)counts.data, (size_t*)starts.data,
    (face*)faces.data, (uint32_t*)next.data, (uint32_t*)adjacency->neighbors.data,
    (int64_t(*)[2])tally.data };
  status = chi_for(exec, CHI_ORDER_CHUNKS, count_faces, &job);
  if (status != CHI_OK)
  {
    goto done;
  }
  size_t sum = 0;
  for (size_t part = 0; part < parts; ++part)
  {
    uint32_t in_part = 0;
    job.starts[part] = sum;
    for (size_t chunk = 0; chunk < CHI_ORDER_CHUNKS; ++chunk)
    {
      uint32_t* const count = job.counts + chunk * parts + part;
      const uint32_t c = *count;
      *count = in_part;
      in_part += c;
    }
    sum += in_part;
  }
  job.starts[parts] = sum;
  status = chi_for(exec, CHI_ORDER_CHUNKS, deal_faces, &job);
  if (status == CHI_OK)
  {
    status = chi_for(exec, parts, match_faces, &job);
  }
  adjacency->interior = adjacency->bad = 0;
  for (size_t part = 0; part < parts && status == CHI_OK; ++part)
  {
    adjacency->interior += job.tally[part][0];
    adjacency->bad += job.tally[part][1];
  }
  size_t exterior = 0;
  for (size_t i = 0; i < 4 * n && status == CHI_OK; ++i)
  {
    exterior += job.neighbors[i] >= n;
  }
  if (status == CHI_OK &&
    !chi_buffer_reserve(exec, &adjacency->exterior, exterior, sizeof(uint32_t)))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  adjacency->boundary = 0;
  adjacency->exterior_count = 0;
  for (size_t i = 0; i < 4 * n && status == CHI_OK; ++i)
  {
    if (job.neighbors[i] >= n)
    {
      ((uint32_t*)adjacency->exterior.data)[adjacency->exterior_count++] = (uint32_t)i;
      adjacency->boundary += job.neighbors[i] == NONE;
    }
  }
done:
  chi_buffer_free(exec, &counts);
  chi_buffer_free(exec, &starts);
  chi_buffer_free(exec, &faces);
  chi_buffer_free(exec, &next);
  chi_buffer_free(exec, &tally);
  return status;
}
