// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Enlarges a picture of fewer pixels bilinearly, as chi_tet_reduce.c does it. Output 0 is the picture.
//VTK::System::Dec
//VTK::Output::Dec

in vec2 texCoord; // 0 to 1 over the target
uniform vec2 targetSize;

uniform sampler2D layerTexture;
uniform float reduction; // pixels of the target a pixel of the picture

void main()
{
  ivec2 last = textureSize(layerTexture, 0) - 1;
  vec2 at = clamp((floor(texCoord * targetSize) + 0.5) / reduction - 0.5, vec2(0.0), vec2(last));
  ivec2 low = ivec2(at);
  ivec2 high = min(low + 1, last);
  vec2 f = at - vec2(low);
  vec4 below = mix(texelFetch(layerTexture, low, 0), texelFetch(layerTexture, ivec2(high.x, low.y), 0), f.x);
  vec4 above = mix(texelFetch(layerTexture, ivec2(low.x, high.y), 0), texelFetch(layerTexture, high, 0), f.x);
  gl_FragData[0] = mix(below, above, f.y);
}
