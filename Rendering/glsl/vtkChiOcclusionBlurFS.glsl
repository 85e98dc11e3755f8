// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One slab's light by the published rule: one buffer, of which each light pixel takes the mean of taps,
// attenuated by half the slab, which is what its middle sees, and by the other half (Schott et al.
// 2013, Algorithm 3). Output 0 is the visibility, output 1 the light.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D lightTexture0; // its border is light from outside: 1
uniform vec2 shift[TAPS];        // whole light pixels
uniform vec4 shiftWeight[TAPS];  // of the pixels there, to the right, above, and above to the right
#if HAS_TAU
uniform vec2 path; // slope of the light's way
#endif
#if COLORED
uniform vec3 colors; // 1: those that this light is for
#endif

//CHI::Functions::Dec

void main()
{
  ivec2 q = ivec2(texCoord * targetSize);
  vec2 at = vec2(q) + 0.5;
  float light = 0.0;
  for (int k = 0; k < TAPS; ++k)
  {
    light += tap(lightTexture0, at + shift[k], shiftWeight[k]).r;
  }
  light /= float(TAPS);
#if HAS_TAU
  vec2 slope = raySlope + vec2(q) * raySlopeStep - path;
  float through = exp(-0.5 * attenuation * lightThickness(q) * sqrt(1.0 + dot(slope, slope)));
#else
  float through = 1.0;
#endif
  float seen = light * through;
#if COLORED
  gl_FragData[0] = vec4(seen * colors, 0.0);
#else
  gl_FragData[0] = vec4(seen);
#endif
#if HAS_GEOMETRY
  through *= geometryThrough(q);
#endif
  gl_FragData[1] = vec4(seen * through);
}
