// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Colour and opacity of the largest scalars along the rays, as chi_tet_draw.c finds them. Output 0 is
// the picture.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord; // 0 to 1 over the target
uniform vec2 targetSize;

uniform sampler2D placeTexture; // places of scalar and opacity in the tables; negative: none
uniform float maximumPath;      // that opacity is taken over

//CHI::Functions::Dec

void main()
{
  vec2 place = texelFetch(placeTexture, ivec2(texCoord * targetSize), 0).rg;
  if (place.x < 0.0)
  {
    gl_FragData[0] = vec4(0.0);
    return;
  }
  float depth = maximumPath * entryAt(place.y).a;
#if IMAGE_OPACITY
  float alpha = 1.0 - exp(-depth);
#else
  float alpha = min(depth, 1.0);
#endif
  gl_FragData[0] = vec4(entryAt(place.x).rgb * alpha, alpha);
}
