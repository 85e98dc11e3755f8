/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Which cells of a brick may be deposited by their mean; included behind
 * chi_scatterplot_kernels.inl.
 */

typedef struct range8
{
  v8 low, high;
} range8;

/* Of the eight corners of each cell of a row. */
CHI_INLINE8 range8 range_of_row(const double* row)
{
  static const size_t corner[8] = { 0, 1, CHI_SCATTER_ROW, CHI_SCATTER_ROW + 1, CHI_SCATTER_LAYER,
    CHI_SCATTER_LAYER + 1, CHI_SCATTER_LAYER + CHI_SCATTER_ROW,
    CHI_SCATTER_LAYER + CHI_SCATTER_ROW + 1 };
  range8 r = { v8_load(row), v8_load(row) };
  for (int k = 1; k < 8; ++k)
  {
    const v8 v = v8_load(row + corner[k]);
    r.low = v8_min(r.low, v);
    r.high = v8_max(r.high, v);
  }
  return r;
}

static void straddling(
  const chi_scatter_plot* plot, const chi_scatter_brick* b, double size, uint8_t* rows)
{
  const m8 lanes = m8_first(b->cells[0]);
  const v8 most = v8_set(size), one = v8_set(1), zero = v8_set(0);
  for (int z = 0; z < b->cells[2]; ++z)
  {
    for (int y = 0; y < b->cells[1]; ++y)
    {
      const int at = z * CHI_SCATTER_LAYER + y * CHI_SCATTER_ROW;
      const int row = z * CHI_SCATTER_BRICK + y;
      const v8 mass = v8_load(b->mass + row * CHI_SCATTER_BRICK);
      const range8 x = range_of_row(b->x + at), v = range_of_row(b->y + at);
      const m8 inside = (x.low >= zero) & (v.low >= zero) & (x.high <= v8_set(plot->bins[0])) &
        (v.high <= v8_set(plot->bins[1]));
      const m8 small = (x.high - x.low <= most) & (v.high - v.low <= most);
      const m8 crosses = (x.high > v8_floor(x.low) + one) ^ (v.high > v8_floor(v.low) + one);
      rows[row] = (uint8_t)m8_bits(lanes & (mass == mass) & inside & small & crosses);
    }
  }
}
