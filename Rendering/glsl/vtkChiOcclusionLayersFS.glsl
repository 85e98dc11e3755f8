// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Layers where nothing absorbs: they go under what the rays have met already (blending
// ONE_MINUS_DST_ALPHA, ONE). Output 0 takes their alpha, the others the transmittance in front of
// each, and the same alpha, so that blending multiplies it by what lies before.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D layersTexture; // slots a picture apart, the nearest first: depth in slices, alpha, ...
uniform vec2 layerRange;         // slices
uniform vec4 hole;               // pixels that are left out

void main()
{
  vec2 pixel = floor(texCoord * targetSize);
  if (all(greaterThanEqual(pixel, hole.xy)) && all(lessThan(pixel, hole.zw)))
  {
    discard;
  }
  float through = 1.0;
  float weight[3 * WEIGHTS];
  for (int k = 0; k < 3 * WEIGHTS; ++k)
  {
    weight[k] = 0.0;
    if (k < LAYERS)
    {
      vec2 layer = texelFetch(layersTexture, ivec2(pixel) + ivec2(0, k * int(targetSize.y)), 0).rg;
      if (layer.r >= layerRange.x && layer.r < layerRange.y)
      {
        weight[k] = through;
        through *= 1.0 - layer.g;
      }
    }
  }
  float alpha = 1.0 - through;
  gl_FragData[0] = vec4(0.0, 0.0, 0.0, alpha);
  gl_FragData[1] = vec4(weight[0], weight[1], weight[2], alpha);
#if WEIGHTS > 1
  gl_FragData[2] = vec4(weight[3], weight[4], weight[5], alpha);
#endif
}
