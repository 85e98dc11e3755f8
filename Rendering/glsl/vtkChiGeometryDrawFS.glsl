// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Draws the private buffer of opaque geometry as the geometry itself would have been.
//VTK::System::Dec
//VTK::Output::Dec

uniform sampler2D colorTexture; // times the share that is covered, and this
uniform sampler2D depthTexture; // window depths; of several samples a pixel: end, most, edge
uniform int samples;
in vec2 texCoord; // 0 to 1 over the viewport

void main()
{
  ivec2 pixel = ivec2(texCoord * vec2(textureSize(colorTexture, 0)));
  vec4 depth = texelFetch(depthTexture, pixel, 0);
  gl_FragDepth = samples != 0 ? depth.g : depth.r;
  if (gl_FragDepth >= 1.0)
  {
    discard;
  }
  gl_FragData[0] = texelFetch(colorTexture, pixel, 0);
}
