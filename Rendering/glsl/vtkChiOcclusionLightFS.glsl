// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One slab's light, up to sixteen directions, four in a texture: shift, attenuate by half the slab,
// which is what its middle sees, and by the other half (Eq. 3 of theory/occlusion.md). Output 0 is
// the visibility, outputs 1 to 4 the light.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D lightTexture0; // its border is light from outside: 1
uniform sampler2D lightTexture1;
uniform sampler2D lightTexture2;
uniform sampler2D lightTexture3;
uniform vec2 shift[16];       // whole light pixels
uniform vec4 shiftWeight[16]; // of the pixels there, to the right, above, and above to the right
uniform vec4 share[4];        // of the directions in the visibility
#if HAS_TAU
uniform vec2 direction[16]; // slopes
#endif
#if COLORED
uniform vec3 colors; // 1: those that this light is for
#endif
#if CONTINUES
uniform sampler2D visibilityTexture; // of the directions that came before
#endif

//CHI::Functions::Dec

vec4 shifted(sampler2D from, int k)
{
  vec2 at = (floor(texCoord * targetSize) + 0.5);
  return vec4(tap(from, at + shift[k], shiftWeight[k]).r,
    tap(from, at + shift[k + 1], shiftWeight[k + 1]).g,
    tap(from, at + shift[k + 2], shiftWeight[k + 2]).b,
    tap(from, at + shift[k + 3], shiftWeight[k + 3]).a);
}

void main()
{
  ivec2 q = ivec2(texCoord * targetSize);
#if HAS_TAU
  float tau = lightThickness(q);
  vec2 slope = raySlope + vec2(q) * raySlopeStep;
#endif
#if HAS_GEOMETRY
  float geometry = geometryThrough(q);
#endif
#if CONTINUES
  float sum = texelFetch(visibilityTexture, q, 0).r;
#else
  float sum = 0.0;
#endif
  vec4 light[4];
  light[0] = shifted(lightTexture0, 0);
#if TARGETS > 1
  light[1] = shifted(lightTexture1, 4);
#endif
#if TARGETS > 2
  light[2] = shifted(lightTexture2, 8);
#endif
#if TARGETS > 3
  light[3] = shifted(lightTexture3, 12);
#endif
  for (int k = 0; k < TARGETS; ++k)
  {
#if HAS_TAU
    // a ray of light through a pixel of slope p has the slope p - s
    vec4 x = slope.x - vec4(direction[4 * k].x, direction[4 * k + 1].x, direction[4 * k + 2].x,
      direction[4 * k + 3].x);
    vec4 y = slope.y - vec4(direction[4 * k].y, direction[4 * k + 1].y, direction[4 * k + 2].y,
      direction[4 * k + 3].y);
    vec4 through = exp(-0.5 * attenuation * tau * sqrt(1.0 + x * x + y * y));
    light[k] *= through;
    sum += dot(light[k], share[k]);
    light[k] *= through;
#else
    sum += dot(light[k], share[k]);
#endif
#if HAS_GEOMETRY
    light[k] *= geometry;
#endif
  }
#if COLORED
  gl_FragData[0] = vec4(sum * colors, 0.0);
#else
  gl_FragData[0] = vec4(sum);
#endif
  gl_FragData[1] = light[0];
#if TARGETS > 1
  gl_FragData[2] = light[1];
#endif
#if TARGETS > 2
  gl_FragData[3] = light[2];
#endif
#if TARGETS > 3
  gl_FragData[4] = light[3];
#endif
}
