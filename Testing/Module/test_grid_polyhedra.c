/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Polyhedra: as the cells they are, concave, ill-oriented, with hanging nodes. */

#include "grid_kinds.h"

static const double exact = 1e-14; /* as in test_grid_cells.c */

/* The same cells as polyhedra; `flips`: which faces go the other way round. */
static void add_as_polyhedron(mesh* m, const mesh* from, size_t c, uint32_t flips)
{
  const cell_kind* const kind = kind_of(from->types[c]);
  const int64_t* const ids = from->ids + from->offsets[c];
  int64_t stream[64];
  size_t length = 0;
  stream[length++] = (int64_t)kind->faces;
  for (size_t f = 0; f < kind->faces; ++f)
  {
    const int n = kind->face[f][0];
    stream[length++] = n;
    for (int k = 0; k < n; ++k)
    {
      stream[length++] = ids[kind->face[f][1 + (flips >> f & 1 ? n - 1 - k : k)]];
    }
  }
  add_polyhedron(m, kind->points, ids, length, stream);
}

static void polyhedra_are_split_as_the_cells_they_are(void)
{
  mesh* const m = new_mesh();
  place_cell(m, 12, 0, 0, 0, 1, 1, 1);
  place_cell(m, 14, 0, 0, 1, 1, 1, 1);
  place_cell(m, 10, 1, 0, 0, 1, 1, 1);
  place_cell(m, 13, 0, 1, 0, 1, 1, 1);
  place_cell(m, 15, 0, 0, 0, 1, -1, 1);
  place_cell(m, 16, 0, 0, -1, 1, 1, 1);
  for (uint32_t seed = 0; seed < 200; ++seed)
  {
    shuffle(m, seed);
    mesh* const p = new_mesh();
    memcpy(p->x, m->x, m->points * sizeof m->x[0]);
    p->points = m->points;
    for (size_t c = 0; c < m->cells; ++c)
    {
      add_as_polyhedron(p, m, c, seed % 4 < 2 ? 0 : seed * 0x9e3779b9u >> 24);
    }
    split a = split_of(m), b = split_of(p);
    check_split(&b);
    CHECK(b.counts.extra_points == 0 && b.counts.folded_cells == 0);
    CHECK(a.counts.tetrahedra == b.counts.tetrahedra);
    CHECK_NEAR(a.counts.volume, b.counts.volume, exact * a.counts.volume);
    size_t differ = a.counts.tetrahedra != b.counts.tetrahedra;
    for (size_t t = 0; t < a.counts.tetrahedra && !differ; ++t)
    {
      size_t found = 0;
      for (size_t u = 0; u < b.counts.tetrahedra; ++u)
      {
        id_set x = { .count = 4 }, y = { .count = 4 };
        for (int k = 0; k < 4; ++k)
        {
          x.id[k] = a.vertices[t][k];
          y.id[k] = b.vertices[u][k];
        }
        qsort(x.id, 4, sizeof x.id[0], compare_ids);
        qsort(y.id, 4, sizeof y.id[0], compare_ids);
        found += compare_sets(&x, &y) == 0 && a.cells[t] == b.cells[u];
      }
      differ += found != 1;
    }
    CHECK(differ == 0);
    drop_split(&a);
    drop_split(&b);
    free(p);
  }
  free(m);
}

/* Turn some faces of the last polyhedron round. */
static void flip_faces(mesh* m, uint32_t flips)
{
  int64_t* at = m->faces + m->face_offsets[m->cells - 1];
  for (int64_t f = *at++; f > 0; --f, flips >>= 1)
  {
    const int64_t n = *at++;
    for (int64_t k = 0; k < n / 2 && flips & 1; ++k)
    {
      const int64_t kept = at[k];
      at[k] = at[n - 1 - k];
      at[n - 1 - k] = kept;
    }
    at += n;
  }
}

/* A cube whose top is pressed in to a point, all faces outward or not. */
static void concave_polyhedra_are_split_about_their_centre(void)
{
  size_t extra = 0;
  for (uint32_t seed = 0; seed < 100; ++seed)
  {
    mesh* const m = new_mesh();
    int64_t ids[9];
    for (int k = 0; k < 8; ++k)
    {
      ids[k] = add_point(m, ((k + 1) >> 1) & 1, k >> 1 & 1, k >> 2);
    }
    ids[8] = add_point(m, 0.5, 0.5, 0.625);
    const int64_t stream[] = { 9, 4, 0, 4, 7, 3, 4, 1, 2, 6, 5, 4, 0, 1, 5, 4, 4, 3, 7, 6, 2, 4, 0,
      3, 2, 1, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8 };
    add_polyhedron(m, 9, ids, sizeof stream / sizeof stream[0], stream);
    flip_faces(m, seed & 1 ? seed * 0x9e3779b9u >> 20 : 0);
    shuffle(m, seed);
    split s = split_of(m);
    check_split(&s);
    size_t singles;
    id_set* const boundary = boundary_of(&s, &singles);
    CHECK(singles == 14 && s.counts.folded_cells == 0);
    CHECK_NEAR(s.counts.volume, 1 - 0.375 / 3, exact);
    extra += s.counts.extra_points;
    CHECK(s.counts.tetrahedra == 14 || s.counts.extra_points == 0);
    free(boundary);
    drop_split(&s);
    free(m);
  }
  CHECK(extra > 10 && extra < 100); /* from a bottom corner, or the dent, all faces are seen */
}

/* More faces, and more corners of a face, than any array of a fixed size has room for. */
static void a_prism_of_many_sides(void)
{
  enum
  {
    SIDES = 300
  };
  mesh* const m = new_mesh();
  int64_t ids[2 * SIDES], stream[1 + 2 * (SIDES + 1) + 5 * SIDES];
  size_t length = 0;
  for (int k = 0; k < 2 * SIDES; ++k)
  {
    const double angle = 2 * 3.14159265358979324 * (k % SIDES) / SIDES;
    ids[k] = add_point(m, cos(angle), sin(angle), k / SIDES);
  }
  stream[length++] = SIDES + 2;
  for (int end = 0; end < 2; ++end)
  {
    stream[length++] = SIDES;
    for (int k = 0; k < SIDES; ++k)
    {
      stream[length++] = end ? SIDES + k : SIDES - 1 - k;
    }
  }
  for (int k = 0; k < SIDES; ++k)
  {
    const int next = (k + 1) % SIDES;
    const int64_t side[5] = { 4, k, next, SIDES + next, SIDES + k };
    memcpy(stream + length, side, sizeof side);
    length += 5;
  }
  add_polyhedron(m, 2 * SIDES, ids, length, stream);
  for (uint32_t seed = 0; seed < 10; ++seed)
  {
    shuffle(m, seed);
    split s = split_of(m);
    check_split(&s);
    size_t singles;
    id_set* const boundary = boundary_of(&s, &singles);
    CHECK(singles == 2 * (SIDES - 2) + 2 * SIDES);
    CHECK(s.counts.tetrahedra == 3 * (SIDES - 2)); /* as of a prism of any number of sides */
    CHECK(s.counts.extra_points == 0 && s.counts.folded_cells == 0);
    CHECK_NEAR(s.counts.volume, SIDES / 2.0 * sin(2 * 3.14159265358979324 / SIDES), 1e-13);
    free(boundary);
    drop_split(&s);
  }
  free(m);
}

/* Turn all points about an axis, away from the origin: corners between others are beside them now.
 * `near`: not so far, and rounded to float. */
static void turn(mesh* m, int near)
{
  const double c = cos(0.7), s = sin(0.7), far = near ? 50 : 1e6;
  for (size_t i = 0; i < m->points; ++i)
  {
    double* const x = m->x[i];
    const double y = c * x[1] - s * x[2], z = s * x[1] + c * x[2];
    const double turned[3] = { c * x[0] - s * y + 2 * far, s * x[0] + c * y + far, z - far };
    for (int a = 0; a < 3; ++a)
    {
      x[a] = near ? (double)(float)turned[a] : turned[a];
    }
  }
}

static split split_of_floats(const mesh* m)
{
  split s;
  chi_grid_view view = view_of(m);
  float* const x = malloc(3 * m->points * sizeof *x);
  for (size_t i = 0; i < 3 * m->points && x; ++i)
  {
    x[i] = (float)m->x[i / 3][i % 3];
  }
  const void* const doubles = view.points.data;
  view.points = (chi_vec3_view){ x, m->points, 3 * sizeof *x, CHI_F32 };
  CHECK(make_split(&s, NULL, &view) == CHI_OK);
  view.points.data = doubles;
  drop_view(&view);
  free(x);
  return s;
}

/* A cube beside four of half its size: the large one is a polyhedron whose side has four faces, and
 * the faces around it have five corners. */
static void hanging_nodes_conform(void)
{
  for (uint32_t seed = 0; seed < 300; ++seed)
  {
    mesh* const m = new_mesh();
    for (int k = 0; k < 4; ++k)
    {
      const double y = 0.5 * (k & 1), z = 0.5 * (k >> 1);
      static const double corner[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 },
        { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } };
      int64_t ids[8];
      for (int c = 0; c < 8; ++c)
      {
        ids[c] =
          share_point(m, 1 + 0.5 * corner[c][0], y + 0.5 * corner[c][1], z + 0.5 * corner[c][2]);
      }
      add_cell(m, 12, 8, ids);
    }
    int64_t p[3][3], q[2][2], ids[13], stream[64];
    size_t count = 0, length = 0;
    for (int j = 0; j < 3; ++j)
    {
      for (int k = 0; k < 3; ++k)
      {
        ids[count++] = p[j][k] = share_point(m, 1, 0.5 * j, 0.5 * k);
      }
    }
    for (int j = 0; j < 2; ++j)
    {
      for (int k = 0; k < 2; ++k)
      {
        ids[count++] = q[j][k] = add_point(m, 0, j, k);
      }
    }
    stream[length++] = 9;
    for (int j = 0; j < 4; ++j)
    {
      const int y = j & 1, z = j >> 1;
      const int64_t face[5] = { 4, p[y][z], p[y + 1][z], p[y + 1][z + 1], p[y][z + 1] };
      memcpy(stream + length, face, sizeof face);
      length += 5;
    }
    const int64_t rest[29] = { 5, q[0][0], p[0][0], p[0][1], p[0][2], q[0][1], /* y = 0 */
      5, q[1][0], q[1][1], p[2][2], p[2][1], p[2][0],                          /* y = 1 */
      5, q[0][0], q[1][0], p[2][0], p[1][0], p[0][0],                          /* z = 0 */
      5, q[0][1], p[0][2], p[1][2], p[2][2], q[1][1],                          /* z = 1 */
      4, q[0][0], q[0][1], q[1][1], q[1][0] };
    memcpy(stream + length, rest, sizeof rest);
    length += 29;
    add_polyhedron(m, count, ids, length, stream);
    shuffle(m, seed);
    if (seed % 3 > 0)
    {
      turn(m, seed % 3 == 2);
    }
    split s = seed % 3 == 2 ? split_of_floats(m) : split_of(m);
    check_split(&s);
    CHECK(s.counts.folded_cells == 0 && s.counts.extra_points == 0);
    /* turned points are known to 2^-33 in double, 2^-18 in float at their places, along each axis;
     * the area is 8: 8 sqrt(3) < 14 */
    static const double tolerance[3] = { 1e-14, 14 * 0x1p-33, 14 * 0x1p-18 };
    CHECK_NEAR(s.counts.volume, 1.5, tolerance[seed % 3]);
    /* 12 faces of small cubes, 4 of five corners, one side */
    size_t singles;
    id_set* const boundary = boundary_of(&s, &singles);
    CHECK(singles == 12 * 2 + 4 * 3 + 2);
    free(boundary);
    drop_split(&s);
    free(m);
  }
}

int main(void)
{
  polyhedra_are_split_as_the_cells_they_are();
  concave_polyhedra_are_split_about_their_centre();
  a_prism_of_many_sides();
  hanging_nodes_conform();
  return chi_test_report();
}
