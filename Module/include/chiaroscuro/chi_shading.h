/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SHADING_H
#define CHI_SHADING_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_MAX_LIGHTS = 16
};

/** Where a light shines from; values of chi_shading_light.kind. */
enum
{
  CHI_LIGHT_EYE = 0,         /**< from the eye's position along every ray */
  CHI_LIGHT_DIRECTIONAL = 1, /**< everywhere along `direction` */
  CHI_LIGHT_POSITIONAL = 2   /**< from `position`, attenuated, in a cone about `direction` */
};

/** One light, in eye coordinates: x to the right, y up, the eye at 0 and looking along -z; lengths
 * are world units. Colours are those of the light times its intensity, >= 0. */
typedef struct chi_shading_light
{
  int64_t kind;          /**< CHI_LIGHT_... */
  double direction[3];   /**< in which it travels, any length > 0; not of CHI_LIGHT_EYE */
  double position[3];    /**< CHI_LIGHT_POSITIONAL */
  double diffuse[3];     /**< red, green, blue */
  double specular[3];    /**< red, green, blue */
  double attenuation[3]; /**< of positional lights: 1 / (a0 + a1 d + a2 d^2) at the distance d;
                              >= 0, all zero stands for (1, 0, 0) */
  double cone_angle_rad; /**< half angle beyond which a positional light is dark; > pi / 2, or 0:
                              it shines everywhere */
  double exponent;       /**< >= 0: inside its cone, times cos(angle off the axis)^exponent */
} chi_shading_light;

/**
 * Shading by the gradient of the scalar (Phong 1975, as vtkGPUVolumeRayCastMapper has it):
 *
 *   colour = clamp(V (albedo (ambient + diffuse sum_l I_l |n.l|) + ambient_light) +
 *                  specular sum_l S_l max(r.v, 0)^power)
 *
 * with the table's colour as albedo, the normal n along the gradient, l and v the directions in
 * which light and eye ray travel, r the mirrored l, and V the visibility, which leaves highlights
 * alone (Schott et al. 2013, Eq. 9). Where the gradient is zero, the ambient terms are left.
 */
typedef struct chi_shading_view
{
  size_t struct_size;
  double ambient;          /**< of the albedo; likewise `diffuse`; >= 0 */
  double diffuse;          /**< >= 0 */
  double specular;         /**< of the lights alone; >= 0 */
  double specular_power;   /**< >= 0 */
  double ambient_light[3]; /**< added, whatever the albedo; >= 0 */
  int32_t two_sided;       /**< non-zero: a normal that faces away is turned round for |n.l|. In r
                                only the factor n.l is, so that of all but CHI_LIGHT_EYE the back
                                has no highlight but a positional light's |r.v| (VTK's rule) */
  int32_t unclamped;       /**< non-zero: colours above 1 are left so, below the picture's alpha */
  const chi_shading_light* lights; /**< [light_count] */
  size_t light_count;              /**< 0 ... CHI_MAX_LIGHTS */
} chi_shading_view;

#ifdef __cplusplus
}
#endif
#endif
