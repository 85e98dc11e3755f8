/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The kernels of one precision: REAL, its integer of the same size INTEGER, ROOT, NAME(verb). */

/* One component, a constant step apart: a loop for each type. */
static void NAME(load_component)(
  const chi_derived_source* source, const char* at, size_t count, REAL* restrict row)
{
  const size_t stride = source->values.stride;
#define CHI_LOAD(code, ctype)                                                                      \
  case code:                                                                                       \
    if (stride == sizeof(ctype))                                                                   \
    {                                                                                              \
      for (size_t i = 0; i < count; ++i)                                                           \
      {                                                                                            \
        ctype x;                                                                                   \
        memcpy(&x, at + i * sizeof x, sizeof x);                                                   \
        row[i] = (REAL)x;                                                                          \
      }                                                                                            \
    }                                                                                              \
    else                                                                                           \
    {                                                                                              \
      for (size_t i = 0; i < count; ++i)                                                           \
      {                                                                                            \
        ctype x;                                                                                   \
        memcpy(&x, at + i * stride, sizeof x);                                                     \
        row[i] = (REAL)x;                                                                          \
      }                                                                                            \
    }                                                                                              \
    break;
  switch (source->values.type)
  {
    CHI_LOAD(CHI_F32, float)
    CHI_LOAD(CHI_F64, double)
    CHI_LOAD(CHI_I8, int8_t)
    CHI_LOAD(CHI_U8, uint8_t)
    CHI_LOAD(CHI_I16, int16_t)
    CHI_LOAD(CHI_U16, uint16_t)
    CHI_LOAD(CHI_I32, int32_t)
    CHI_LOAD(CHI_U32, uint32_t)
    CHI_LOAD(CHI_I64, int64_t)
    CHI_LOAD(CHI_U64, uint64_t)
    default:
      break;
  }
#undef CHI_LOAD
}

static void NAME(load_magnitude)(
  const chi_derived_source* source, const char* at, size_t count, REAL* restrict row)
{
  const chi_array_view* const v = &source->values;
  const size_t size = chi_type_size(v->type);
  for (size_t i = 0; i < count; ++i, at += v->stride)
  {
    double most = 0, sum = 0; /* of squares in units of the largest: none overflows */
    for (size_t k = 0; k < v->components; ++k)
    {
      const double x = fabs(chi_number_at(at + k * size, v->type));
      most = x <= most ? most : x; /* NaN stays */
    }
    for (size_t k = 0; k < v->components && most > 0; ++k)
    {
      const double x = chi_number_at(at + k * size, v->type) / most;
      sum += x * x;
    }
    row[i] = (REAL)(most > 0 ? most * sqrt(sum) : most);
  }
}

static void NAME(load)(const chi_derived_source* source, size_t first, size_t count, void* out)
{
  REAL* const restrict row = (REAL*)out;
  const chi_array_view* const v = &source->values;
  const char* const at = (const char*)v->data + first * v->stride;
  if (source->component < 0)
  {
    NAME(load_magnitude)(source, at, count, row);
  }
  else
  {
    NAME(load_component)
    (source, at + (size_t)source->component * chi_type_size(v->type), count, row);
  }
  const REAL factor = (REAL)source->factor;
  for (size_t i = 0; i < count; ++i)
  {
    const REAL x = row[i] * factor;
    row[i] = x + (x - x); /* infinite: NaN */
  }
  for (size_t i = 0; source->ghosts && i < count; ++i)
  {
    row[i] = source->ghosts[first + i] & CHI_HIDDEN ? (REAL)NAN : row[i];
  }
}

static void NAME(range)(const void* row, size_t count, double range[2])
{
  enum
  {
    LANES = 16
  };
  const REAL* const x = (const REAL*)row;
  REAL low[LANES], high[LANES];
  for (int k = 0; k < LANES; ++k)
  {
    low[k] = (REAL)INFINITY;
    high[k] = (REAL)-INFINITY;
  }
  size_t i = 0;
  for (; i + LANES <= count; i += LANES)
  {
    for (int k = 0; k < LANES; ++k)
    {
      low[k] = x[i + (size_t)k] < low[k] ? x[i + (size_t)k] : low[k];
      high[k] = x[i + (size_t)k] > high[k] ? x[i + (size_t)k] : high[k];
    }
  }
  for (; i < count; ++i)
  {
    low[0] = x[i] < low[0] ? x[i] : low[0];
    high[0] = x[i] > high[0] ? x[i] : high[0];
  }
  for (int k = 0; k < LANES; ++k)
  {
    range[0] = (double)low[k] < range[0] ? (double)low[k] : range[0];
    range[1] = (double)high[k] > range[1] ? (double)high[k] : range[1];
  }
}

CHI_INLINE void NAME(across_taps)(size_t count, const size_t taps, const double* weights,
  const void* const* rows, const void* middle_row, void* out_row)
{
  const REAL* const restrict middle = (const REAL*)middle_row;
  REAL* const restrict out = (REAL*)out_row;
  const REAL* row[CHI_DERIVED_TAPS];
  REAL weight[CHI_DERIVED_TAPS];
  for (size_t k = 0; k < taps; ++k)
  {
    row[k] = (const REAL*)rows[k];
    weight[k] = (REAL)weights[k];
  }
  for (size_t i = 0; i < count; ++i)
  {
    const REAL m = middle[i];
    REAL sum = weight[0] * (row[0][i] - m);
    for (size_t k = 1; k < taps; ++k)
    {
      sum += weight[k] * (row[k][i] - m);
    }
    out[i] = sum;
  }
}

static void NAME(across)(size_t count, size_t taps, const double* weights, const void* const* rows,
  const void* middle, void* out)
{
  switch (taps)
  {
    case 0: /* nothing changes; but what is not finite stays so */
      for (size_t i = 0; i < count; ++i)
      {
        ((REAL*)out)[i] = ((const REAL*)middle)[i] - ((const REAL*)middle)[i];
      }
      break;
    case 1:
      NAME(across_taps)(count, 1, weights, rows, middle, out);
      break;
    case 2:
      NAME(across_taps)(count, 2, weights, rows, middle, out);
      break;
    case 3:
      NAME(across_taps)(count, 3, weights, rows, middle, out);
      break;
    case 4:
      NAME(across_taps)(count, 4, weights, rows, middle, out);
      break;
    default:
      NAME(across_taps)(count, 5, weights, rows, middle, out);
      break;
  }
}

CHI_INLINE void NAME(along_taps)(
  const chi_derived_along* a, const size_t taps, const REAL* in, REAL* restrict out)
{
  const REAL* weight[CHI_DERIVED_TAPS];
  const REAL* tap[CHI_DERIVED_TAPS];
  for (size_t k = 0; k < taps; ++k)
  {
    weight[k] = (const REAL*)a->weights + k * a->count;
    tap[k] = in + a->offset[k];
  }
  for (size_t i = a->begin; i < a->end; ++i)
  {
    REAL sum = weight[0][i] * (tap[0][i] - in[i]);
    for (size_t k = 1; k < taps; ++k)
    {
      sum += weight[k][i] * (tap[k][i] - in[i]);
    }
    out[i] = sum;
  }
}

static void NAME(along)(const chi_derived_along* a, const void* row, void* out_row)
{
  const REAL* const in = (const REAL*)row;
  REAL* const out = (REAL*)out_row;
  if (a->begin >= a->end)
  {
    /* no stencil is whole */
  }
  else if (a->taps == 2)
  {
    NAME(along_taps)(a, 2, in, out);
  }
  else if (a->taps == 3)
  {
    NAME(along_taps)(a, 3, in, out);
  }
  else if (a->taps == 4)
  {
    NAME(along_taps)(a, 4, in, out);
  }
  else
  {
    NAME(along_taps)(a, 5, in, out);
  }
  for (size_t i = 0; i < a->count; ++i)
  {
    if (i == a->begin && a->end > a->begin)
    {
      i = a->end - 1;
      continue;
    }
    REAL sum = in[i] - in[i];
    for (size_t k = 0; k < a->width; ++k)
    {
      const REAL weight = (REAL)a->table[i * CHI_DERIVED_WIDTH + k];
      const REAL step = in[a->start[i] + k] - in[i];
      sum += weight == 0 ? 0 : weight * step; /* what has no weight may be NaN */
    }
    out[i] = sum;
  }
}

/* The inverse of a symmetric matrix (xx, yy, zz, xy, xz, yz); NaN where it has none: the axes' unit
 * vectors span a volume of less than 1e-10. */
CHI_INLINE INTEGER NAME(invert)(const REAL g[6], REAL c[6])
{
  const REAL xx = g[1] * g[2] - g[5] * g[5], yy = g[0] * g[2] - g[4] * g[4];
  const REAL zz = g[0] * g[1] - g[3] * g[3], xy = g[4] * g[5] - g[3] * g[2];
  const REAL xz = g[3] * g[5] - g[4] * g[1], yz = g[3] * g[4] - g[5] * g[0];
  const REAL determinant = g[0] * xx + g[3] * xy + g[4] * xz;
  const INTEGER good = determinant > (REAL)1e-20 * g[0] * g[1] * g[2];
  const REAL factor = good ? 1 / determinant : (REAL)NAN;
  c[0] = xx * factor;
  c[1] = yy * factor;
  c[2] = zz * factor;
  c[3] = xy * factor;
  c[4] = xz * factor;
  c[5] = yz * factor;
  return good;
}

/* Documentation/theory/derived.md, equations (5) and (6). */
static void NAME(curve)(chi_derived_rows* rows, const chi_derived_form* form)
{
  static const int at[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
  INTEGER bad = 0;
  for (size_t i = 0; i < rows->count; ++i)
  {
    REAL j[3][3], product[6], c[6], g[3], p[3];
    for (int x = 0; x < 3; ++x)
    {
      g[x] = ((const REAL*)rows->first[0][x])[i];
      for (int a = 0; a < 3; ++a)
      {
        j[x][a] = ((const REAL*)rows->first[1 + x][a])[i];
      }
    }
    for (int k = 0; k < 6; ++k)
    {
      const int a = at[k][0], b = at[k][1];
      product[k] = j[0][a] * j[0][b] + j[1][a] * j[1][b] + j[2][a] * j[2][b];
      product[k] += k < 3 ? (REAL)form->inactive[k] : 0;
    }
    bad += 1 - NAME(invert)(product, c);
    const REAL u[3] = { c[0] * g[0] + c[3] * g[1] + c[4] * g[2],
      c[3] * g[0] + c[1] * g[1] + c[5] * g[2], c[4] * g[0] + c[5] * g[1] + c[2] * g[2] };
    for (int x = 0; x < 3; ++x)
    {
      p[x] = j[x][0] * u[0] + j[x][1] * u[1] + j[x][2] * u[2];
    }
    for (int k = 0; k < 6; ++k)
    {
      ((REAL*)rows->metric[k])[i] = c[k];
      if (form->is_second)
      {
        REAL* const h = (REAL*)rows->second[0][k] + i;
        for (int x = 0; x < 3; ++x)
        {
          *h -= p[x] * ((const REAL*)rows->second[1 + x][k])[i];
        }
      }
    }
  }
  rows->bad += (size_t)bad;
}

/* Documentation/theory/derived.md, equations (1) to (4). */
CHI_INLINE void NAME(finish_rows)(chi_derived_rows* rows, const chi_derived_form* form,
  const int is_orthogonal, const int is_second, const int is_varying)
{
  const REAL *const x = (const REAL*)rows->first[0][0], *const y = (const REAL*)rows->first[0][1];
  const REAL* const z = (const REAL*)rows->first[0][2];
  const REAL *h[6], *m[6];
  REAL metric[6], factor[4][2];
  for (int k = 0; k < 6; ++k)
  {
    h[k] = (const REAL*)rows->second[0][k];
    m[k] = (const REAL*)rows->metric[k];
    metric[k] = (REAL)form->metric[k];
  }
  for (int k = 0; k < 4; ++k)
  {
    factor[k][0] = (REAL)form->factor[k][0];
    factor[k][1] = (REAL)form->factor[k][1];
  }
  REAL* const restrict magnitude = (REAL*)rows->out[0], * const restrict along = (REAL*)rows->out[1];
  REAL* const restrict laplacian = (REAL*)rows->out[2], * const restrict bend = (REAL*)rows->out[3];
  const REAL threshold = (REAL)form->threshold;
  INTEGER flat = 0, nan = 0;
  for (size_t i = 0; i < rows->count; ++i)
  {
    const REAL g[3] = { x[i], y[i], z[i] };
    REAL p[3] = { g[0], g[1], g[2] };
    REAL c[6];
    if (!is_orthogonal)
    {
      for (int k = 0; k < 6; ++k)
      {
        c[k] = is_varying ? m[k][i] : metric[k];
      }
      p[0] = c[0] * g[0] + c[3] * g[1] + c[4] * g[2];
      p[1] = c[3] * g[0] + c[1] * g[1] + c[5] * g[2];
      p[2] = c[4] * g[0] + c[5] * g[1] + c[2] * g[2];
    }
    const REAL square = p[0] * g[0] + p[1] * g[1] + p[2] * g[2]; /* (1) */
    const REAL length = ROOT(square > 0 ? square : square - square);
    const INTEGER is_flat = length <= threshold;
    flat += is_flat;
    if (!is_second)
    {
      nan += length != length;
      magnitude[i] = length * factor[0][0] * factor[0][1];
      continue;
    }
    const REAL xx = h[0][i], yy = h[1][i], zz = h[2][i], xy = h[3][i], xz = h[4][i], yz = h[5][i];
    const REAL trace = is_orthogonal
      ? xx + yy + zz
      : c[0] * xx + c[1] * yy + c[2] * zz + 2 * (c[3] * xy + c[4] * xz + c[5] * yz); /* (3) */
    const REAL form2 = p[0] * p[0] * xx + p[1] * p[1] * yy + p[2] * p[2] * zz +
      2 * (p[0] * p[1] * xy + p[0] * p[2] * xz + p[1] * p[2] * yz);
    const REAL steep = form2 / square;                     /* (2) */
    const REAL curvature = (trace - steep) / (2 * length); /* (4) */
    const REAL all = trace + length + form2;
    nan += all != all;
    magnitude[i] = length * factor[0][0] * factor[0][1];
    along[i] = (is_flat ? trace - trace : steep) * factor[1][0] * factor[1][1];
    laplacian[i] = trace * factor[2][0] * factor[2][1];
    bend[i] = (is_flat ? trace - trace : curvature) * factor[3][0] * factor[3][1];
  }
  rows->flat += (size_t)flat;
  rows->nan += (size_t)nan;
}

static void NAME(finish)(chi_derived_rows* rows, const chi_derived_form* form)
{
  const int which = (rows->metric[0] ? 2 : form->is_orthogonal ? 0 : 1) + 3 * form->is_second;
  switch (which)
  {
    case 0:
      NAME(finish_rows)(rows, form, 1, 0, 0);
      break;
    case 1:
      NAME(finish_rows)(rows, form, 0, 0, 0);
      break;
    case 2:
      NAME(finish_rows)(rows, form, 0, 0, 1);
      break;
    case 3:
      NAME(finish_rows)(rows, form, 1, 1, 0);
      break;
    case 4:
      NAME(finish_rows)(rows, form, 0, 1, 0);
      break;
    default:
      NAME(finish_rows)(rows, form, 0, 1, 1);
      break;
  }
}
