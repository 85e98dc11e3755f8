/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* What is left of a volume. */

#include "chi_mask_internal.h"

#include <math.h>

chi_cut_share chi_crop_share(const chi_scene* s, const double corner[8][3])
{
  if (s->regions == CHI_CROP_ALL_REGIONS)
  {
    return CHI_CUT_NOTHING;
  }
  /* A hundredth of a voxel more on both sides: the kernels' positions are floats, and look a little
   * ahead of a segment. */
  const double margin = 0.01;
  int first[3] = { 0, 0, 0 }, last[3] = { 0, 0, 0 };
  for (int k = 0; k < 6; ++k)
  {
    const double* const c = s->crop[k];
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 8; ++i)
    {
      const double value = c[0] * corner[i][0] + c[1] * corner[i][1] + c[2] * corner[i][2] + c[3];
      least = fmin(least, value);
      most = fmax(most, value);
    }
    first[k / 2] += least - margin >= 0;
    last[k / 2] += most + margin >= 0;
  }
  int kept = 0, gone = 0;
  for (int z = first[2]; z <= last[2]; ++z)
  {
    for (int y = first[1]; y <= last[1]; ++y)
    {
      for (int x = first[0]; x <= last[0]; ++x)
      {
        const int stays = (int)(s->regions >> (x + 3 * y + 9 * z) & 1);
        kept |= stays;
        gone |= !stays;
      }
    }
  }
  return !gone ? CHI_CUT_NOTHING : kept ? CHI_CUT_PART : CHI_CUT_ALL;
}
