// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Enlarges a picture of fewer pixels along the edges of the surface's depth, as chi_reduction.c does
// it (Kopf et al. 2007, Eq. 3). Output 0 is the picture, output 1 the visibility of surfaces.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D layerTexture;
uniform sampler2D visibilityTexture;
uniform int reduction;
uniform int reducedPixel; // of a block, from its corner a side, that stands for it
#if HAS_GUIDE
uniform sampler2D guideTexture; // depth of the full picture's surface, slabs
uniform float guideFar;         // where there is none

const float none = 1e30;

float guideOf(ivec2 small)
{
  ivec2 pixel = min(reduction * small + reducedPixel, textureSize(guideTexture, 0) - 1);
  return texelFetch(guideTexture, pixel, 0).r;
}
#endif

void main()
{
  ivec2 pixel = ivec2(texCoord * targetSize);
  vec2 at = max(vec2(pixel - reducedPixel) / float(reduction), 0.0);
  ivec2 low = ivec2(at);
  ivec2 high = min(low + 1, textureSize(layerTexture, 0) - 1);
  vec2 f = at - vec2(low);
  ivec2 small[4] = ivec2[4](low, ivec2(high.x, low.y), ivec2(low.x, high.y), high);
  float weight[4] = float[4]((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
#if HAS_GUIDE
  float here = texelFetch(guideTexture, pixel, 0).r;
  float sum = 0.0;
  bool lit[4];
  for (int k = 0; k < 4; ++k)
  {
    float there = guideOf(small[k]);
    float d = min(there, guideFar) - min(here, guideFar);
    lit[k] = here < none && there < none;
    weight[k] /= 1.0 + d * d;
    sum += weight[k];
  }
#else
  float sum = 1.0;
#endif
  vec4 color = vec4(0.0);
  vec4 visibility = vec4(0.0);
  float total = 0.0;
  for (int k = 0; k < 4; ++k)
  {
    color += weight[k] / sum * texelFetch(layerTexture, small[k], 0);
#if HAS_GUIDE
    // only surfaces count for one
    visibility += lit[k] ? weight[k] * texelFetch(visibilityTexture, small[k], 0) : vec4(0.0);
    total += lit[k] ? weight[k] : 0.0;
#endif
  }
  gl_FragData[0] = color;
  gl_FragData[1] = total > 0.0 ? visibility / total : vec4(1.0);
}
