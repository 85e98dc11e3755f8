// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Counted by an occlusion query: pixels whose rays still have something to meet. Writes nothing.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D layerTexture;
uniform float saturated; // transmittance below which a ray is done
#if HAS_SURFACE
uniform sampler2D surfaceTexture; // depth in slices, ...
uniform float slice;
#endif

void main()
{
  ivec2 pixel = ivec2(texCoord * targetSize);
  if (!(1.0 - texelFetch(layerTexture, pixel, 0).a > saturated))
  {
    discard;
  }
#if HAS_SURFACE
  if (!(texelFetch(surfaceTexture, pixel, 0).r > slice))
  {
    discard;
  }
#endif
  gl_FragData[0] = vec4(1.0);
}
