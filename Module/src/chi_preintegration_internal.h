/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_PREINTEGRATION_INTERNAL_H
#define CHI_PREINTEGRATION_INTERNAL_H

#include "chi_internal.h"

#include <chiaroscuro/chi_preintegration.h>

/* Moreland & Angel's psi to 1e-12: what of the back end's colour passes, before the transmittance
 * is taken off; theory/preintegration.md, Eq. 4. Optical depths may be infinite. */
double chi_psi(double front, double back);

#endif
