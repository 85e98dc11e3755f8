/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * A simplex of any shape, without divisions by its area. The part of it below a line y = Y is one
 * to three simplices whose shares of the volume are products of ratios in [0, 1]; along x the share
 * of a simplex below a column line is in closed form (3), (4). What lies in a bin is the second
 * difference of these shares, to a few units in the last place of the whole mass, however thin or
 * flat the simplex is.
 */

/* A simplex within another, by the x of its corners and its share of the other's volume. */
typedef struct part
{
  double x[4], share;
} part;

/* What lies below a line; and the x of the points where edges cross it. */
typedef struct section
{
  part parts[3];
  int count;
  double low, high;
} section;

CHI_INLINE8 double determinant(double a, double d, double b, double c)
{
  const double bc = b * c;
  return fma(a, d, -bc) + fma(-b, c, bc); /* 0 if and only if the products are equal (Kahan) */
}

CHI_INLINE8 int is_singular(int corners, const double* x, const double* y)
{
  const double ax = x[1] - x[0], ay = y[1] - y[0], bx = x[2] - x[0], by = y[2] - y[0];
  if (determinant(ax, by, bx, ay) != 0)
  {
    return 0;
  }
  if (corners == 3)
  {
    return 1;
  }
  const double cx = x[3] - x[0], cy = y[3] - y[0];
  return determinant(ax, cy, cx, ay) == 0 && determinant(bx, cy, cx, by) == 0;
}

CHI_INLINE8 void sort2(double* a, double* b)
{
  const double low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low;
  *b = high;
}

CHI_INLINE8 void sort_corners(double* s, int corners)
{
  if (corners == 4)
  {
    sort2(s, s + 1);
    sort2(s + 2, s + 3);
    sort2(s, s + 2);
    sort2(s + 1, s + 3);
    sort2(s + 1, s + 2);
  }
  else
  {
    sort2(s, s + 1);
    sort2(s + 1, s + 2);
    sort2(s, s + 1);
  }
}

CHI_INLINE8 double cross(section* s, double xa, double xb, double t)
{
  const double x = xa + t * (xb - xa);
  s->low = x < s->low ? x : s->low;
  s->high = x > s->high ? x : s->high;
  return x;
}

CHI_INLINE8 void add_part(section* s, double a, double b, double c, double d, double share)
{
  s->parts[s->count++] = (part){ { a, b, c, d }, share };
}

/* Below `line`; corners sorted by y. */
static void cut_below(section* s, int corners, const double* x, const double* y, double line)
{
  s->count = 0;
  s->low = INFINITY;
  s->high = -INFINITY;
  if (line <= y[0])
  {
    return;
  }
  if (line >= y[corners - 1]) /* infinite where all of it is asked for */
  {
    add_part(s, x[0], x[1], x[2], corners == 4 ? x[3] : 0, 1);
    return;
  }
  const double a = line - y[0];
  if (corners == 3)
  {
    const double ac = a / (y[2] - y[0]), at_ac = cross(s, x[0], x[2], ac);
    if (line <= y[1])
    {
      const double ab = a / (y[1] - y[0]);
      add_part(s, x[0], cross(s, x[0], x[1], ab), at_ac, 0, ab * ac);
      return;
    }
    const double bc = (line - y[1]) / (y[2] - y[1]), at_bc = cross(s, x[1], x[2], bc);
    add_part(s, x[0], x[1], at_bc, 0, bc);
    add_part(s, x[0], at_bc, at_ac, 0, (1 - bc) * ac);
    return;
  }
  const double ad = a / (y[3] - y[0]), at_ad = cross(s, x[0], x[3], ad);
  if (line <= y[1])
  {
    const double ab = a / (y[1] - y[0]), ac = a / (y[2] - y[0]);
    add_part(s, x[0], cross(s, x[0], x[1], ab), cross(s, x[0], x[2], ac), at_ad, ab * ac * ad);
    return;
  }
  const double bd = (line - y[1]) / (y[3] - y[1]), at_bd = cross(s, x[1], x[3], bd);
  if (line <= y[2])
  {
    const double ac = a / (y[2] - y[0]), at_ac = cross(s, x[0], x[2], ac);
    const double bc = (line - y[1]) / (y[2] - y[1]), at_bc = cross(s, x[1], x[2], bc);
    add_part(s, x[0], x[1], at_ac, at_ad, ac * ad);
    add_part(s, at_ad, x[1], at_ac, at_bd, ac * (1 - ad) * bd);
    add_part(s, at_ac, x[1], at_bc, at_bd, (1 - ac) * bc * bd);
    return;
  }
  const double cd = (line - y[2]) / (y[3] - y[2]), at_cd = cross(s, x[2], x[3], cd);
  add_part(s, x[0], x[1], x[2], at_ad, ad);
  add_part(s, at_ad, x[1], x[2], at_bd, (1 - ad) * bd);
  add_part(s, at_ad, at_bd, x[2], at_cd, (1 - ad) * (1 - bd) * cd);
}

/* Share of a tetrahedron with corners a <= b <= c <= d below X, for eight X:
 *   (X - a)^3 / ((b - a)(c - a)(d - a))        up to b,
 *   1 - (d - X)^3 / ((d - a)(d - b)(d - c))    from c on, and between                          (3)
 *   ac ad + ac (1 - ad) bd + (1 - ac) bc bd,   pq = (X - p) / (q - p).                           */
CHI_INLINE8 v8 shares4(const double* s, const double* r, v8 at)
{
  const v8 a = at - v8_set(s[0]), b = at - v8_set(s[1]), d = v8_set(s[3]) - at;
  const v8 ac = a * v8_set(r[1]), ad = a * v8_set(r[2]), bd = b * v8_set(r[4]);
  const v8 low = a * v8_set(r[0]) * (ac * ad);
  const v8 high = v8_set(1) - d * v8_set(r[2]) * (d * v8_set(r[4])) * (d * v8_set(r[5]));
  const v8 middle =
    ac * ad + ac * (v8_set(1) - ad) * bd + (v8_set(1) - ac) * (b * v8_set(r[3])) * bd;
  const v8 share = v8_select(b <= v8_set(0), low, v8_select(at >= v8_set(s[2]), high, middle));
  return v8_select(a > v8_set(0), v8_select(d <= v8_set(0), v8_set(1), share), v8_set(0));
}

/* Share of a triangle a <= b <= c: (X - a)^2 / ((b - a)(c - a)) up to b, then
 * 1 - (c - X)^2 / ((c - a)(c - b)).                                                           (4)
 */
CHI_INLINE8 v8 shares3(const double* s, const double* r, v8 at)
{
  const v8 a = at - v8_set(s[0]), c = v8_set(s[2]) - at;
  const v8 low = a * v8_set(r[0]) * (a * v8_set(r[1]));
  const v8 high = v8_set(1) - c * v8_set(r[1]) * (c * v8_set(r[3]));
  const v8 share = v8_select(at <= v8_set(s[1]), low, high);
  return v8_select(a > v8_set(0), v8_select(c <= v8_set(0), v8_set(1), share), v8_set(0));
}

/* sum[k] += factor * share below line first + k, k < count; sum[count] += all of it. */
CHI_INLINE8 void add_shares(
  double* sum, int first, int count, int corners, const part* p, double factor)
{
  double s[4] = { p->x[0], p->x[1], p->x[2], p->x[3] };
  sort_corners(s, corners);
  double r[8];
  /* 1 / 0 stands where no line falls */
  v8_store(r,
    v8_set(1) /
      (v8){ s[1] - s[0], s[2] - s[0], s[3] - s[0], s[2] - s[1], s[3] - s[1], s[3] - s[2], 1, 1 });
  const double share = factor * p->share;
  for (int k = 0; k < count; k += 8)
  {
    const v8 at = v8_set(first + k) + v8_iota();
    const v8 below = corners == 4 ? shares4(s, r, at) : shares3(s, r, at);
    v8_store(sum + k, v8_load(sum + k) + below * share);
  }
  /* what the last vector wrote from `count` on is not read */
  sum[count + 8] += share;
}

/* Bins of a row that a range of x within the plot touches. */
CHI_INLINE8 void find_bins(double low, double high, int n, int* first, int* last)
{
  *first = low < n ? (int)low : n - 1;
  *last = (int)ceil(high) - 1;
  *last = *last < *first ? *first : *last;
}

/* Of a pair of values inside the plot. */
CHI_INLINE8 size_t bin_of(const chi_scatter_plot* plot, double x, double y)
{
  const int i = x < plot->bins[0] ? (int)x : plot->bins[0] - 1;
  const int j = y < plot->bins[1] ? (int)y : plot->bins[1] - 1;
  return (size_t)j * (size_t)plot->bins[0] + (size_t)i;
}

typedef struct row_deposit
{
  int64_t* row; /* its bin 0 */
  size_t step;  /* from bin to bin */
  int bins;     /* of a row */
  double mass;  /* in units */
  int64_t sum, most;
  int64_t* at_most; /* the bin that got most */
} row_deposit;

CHI_INLINE8 void add_bin(row_deposit* d, int bin, double share)
{
  const int64_t n = (int64_t)llrint(d->mass * share);
  if (n != 0)
  {
    int64_t* const at = d->row + (size_t)bin * d->step;
    *at += n;
    d->sum += n;
    const int64_t size = n < 0 ? -n : n;
    if (size > d->most)
    {
      d->most = size;
      d->at_most = at;
    }
  }
}

/* What lies between two lines. */
CHI_INLINE8 void deposit_row(row_deposit* d, int corners, const section* below,
  const section* above, double low, double high, double* scratch)
{
  int first, last;
  find_bins(low, high, d->bins, &first, &last);
  const int lines = last - first;
  if (lines == 0)
  {
    double share = 0;
    for (int i = 0; i < above->count; ++i)
    {
      share += above->parts[i].share;
    }
    for (int i = 0; i < below->count; ++i)
    {
      share -= below->parts[i].share;
    }
    add_bin(d, first, share);
    return;
  }
  memset(scratch, 0, (size_t)(lines + 9) * sizeof *scratch);
  for (int i = 0; i < above->count; ++i)
  {
    add_shares(scratch, first + 1, lines, corners, above->parts + i, 1);
  }
  for (int i = 0; i < below->count; ++i)
  {
    add_shares(scratch, first + 1, lines, corners, below->parts + i, -1);
  }
  scratch[lines] = scratch[lines + 8];
  double before = 0;
  for (int k = 0; k <= lines; ++k)
  {
    add_bin(d, first + k, scratch[k] - before);
    before = scratch[k];
  }
}

/* Corners by y, with x beside. */
CHI_INLINE8 void sort_by_y(int corners, double* x, double* y)
{
  for (int i = 1; i < corners; ++i)
  {
    for (int k = i; k > 0 && y[k] < y[k - 1]; --k)
    {
      const double tx = x[k], ty = y[k];
      x[k] = x[k - 1];
      y[k] = y[k - 1];
      x[k - 1] = tx;
      y[k - 1] = ty;
    }
  }
}

/* A simplex with its mass. */
typedef struct shape
{
  double x[4], y[4], mass;
} shape;

typedef struct box
{
  double low[2], high[2];
} box;

CHI_INLINE8 box box_of(int corners, const shape* s)
{
  box b = { { s->x[0], s->y[0] }, { s->x[0], s->y[0] } };
  for (int c = 1; c < corners; ++c)
  {
    b.low[0] = s->x[c] < b.low[0] ? s->x[c] : b.low[0];
    b.high[0] = s->x[c] > b.high[0] ? s->x[c] : b.high[0];
    b.low[1] = s->y[c] < b.low[1] ? s->y[c] : b.low[1];
    b.high[1] = s->y[c] > b.high[1] ? s->y[c] : b.high[1];
  }
  return b;
}

/* A simplex that lies within the plot; its corners change places. */
static void deposit_inside(
  const chi_scatter_plot* plot, chi_scatter_sink* sink, int corners, shape* s)
{
  const int64_t all = (int64_t)llrint(s->mass * plot->unit);
  const box b = box_of(corners, s);
  sink->inside += s->mass;
  sink->deposited += all;
  int64_t* const corner_bin = sink->bins + bin_of(plot, b.low[0], b.low[1]);
  if (corner_bin == sink->bins + bin_of(plot, b.high[0], b.high[1]))
  {
    *corner_bin += all;
    return;
  }
  /* rows along the longer side, so that they are few */
  const int turned = b.high[0] - b.low[0] < b.high[1] - b.low[1];
  double *const u = turned ? s->y : s->x, *const v = turned ? s->x : s->y;
  const size_t row_step = turned ? 1 : (size_t)plot->bins[0];
  const int rows = plot->bins[!turned];
  row_deposit d = { .step = turned ? (size_t)plot->bins[0] : 1,
    .bins = plot->bins[turned],
    .mass = s->mass * plot->unit,
    .most = -1 };
  int first, last;
  sort_by_y(corners, u, v);
  find_bins(v[0], v[corners - 1], rows, &first, &last);
  section cut[2];
  cut[0].count = 0;
  cut[0].low = INFINITY;
  cut[0].high = -INFINITY;
  for (int j = first; j <= last; ++j)
  {
    const section* const below = &cut[(j - first) & 1];
    section* const above = &cut[(j - first + 1) & 1];
    cut_below(above, corners, u, v, j == last ? (double)INFINITY : (double)(j + 1));
    double from = below->low < above->low ? below->low : above->low;
    double to = below->high > above->high ? below->high : above->high;
    for (int c = 0; c < corners; ++c)
    {
      if (v[c] >= j && v[c] <= j + 1)
      {
        from = u[c] < from ? u[c] : from;
        to = u[c] > to ? u[c] : to;
      }
    }
    d.row = sink->bins + (size_t)j * row_step;
    deposit_row(&d, corners, below, above, from, to, sink->scratch);
  }
  /* what is left is the rounding of shares */
  *(d.at_most ? d.at_most : corner_bin) += all - d.sum;
}

/* Cut at the plot's left, right, lower and upper end in turn by halving edges that cross it, so
 * that shares are products of ratios; deposit what is inside. */
static void deposit_clipped(
  const chi_scatter_plot* plot, chi_scatter_sink* sink, int corners, shape* s, int end)
{
  if (end == 4)
  {
    deposit_inside(plot, sink, corners, s);
    return;
  }
  const int axis = end >> 1, is_upper = end & 1;
  const double line = is_upper ? plot->bins[axis] : 0;
  double* const v = axis ? s->y : s->x;
  double* const u = axis ? s->x : s->y;
  int low = 0, high = 0;
  for (int c = 1; c < corners; ++c)
  {
    low = v[c] < v[low] ? c : low;
    high = v[c] > v[high] ? c : high;
  }
  if (v[low] < line && v[high] > line)
  {
    const double t = (line - v[low]) / (v[high] - v[low]);
    const double at = u[low] + t * (u[high] - u[low]);
    shape other = *s;
    double* const other_v = axis ? other.y : other.x;
    double* const other_u = axis ? other.x : other.y;
    v[high] = other_v[low] = line;
    u[high] = other_u[low] = at;
    s->mass *= t;
    other.mass *= 1 - t;
    deposit_clipped(plot, sink, corners, s, end);
    deposit_clipped(plot, sink, corners, &other, end);
  }
  else if (is_upper ? v[high] > line : v[low] < line) /* what is all on the end is inside */
  {
    sink->outside += s->mass;
  }
  else
  {
    deposit_clipped(plot, sink, corners, s, end + 1);
  }
}

static void sections(const chi_scatter_plot* plot, chi_scatter_sink* sink, int corners,
  const double* x, const double* y, double mass)
{
  shape s = { .mass = mass };
  for (int c = 0; c < corners; ++c)
  {
    s.x[c] = x[c];
    s.y[c] = y[c];
  }
  const box b = box_of(corners, &s);
  const int32_t* const n = plot->bins;
  if (b.low[0] > n[0] || b.low[1] > n[1] || b.high[0] < 0 || b.high[1] < 0)
  {
    sink->outside += mass;
    return;
  }
  sink->singular += is_singular(corners, x, y) ? mass : 0;
  const int is_inside = b.low[0] >= 0 && b.low[1] >= 0 && b.high[0] <= n[0] && b.high[1] <= n[1];
  deposit_clipped(plot, sink, corners, &s, is_inside ? 4 : 0);
}
