// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Visibility of the surfaces that lie between two light planes, or, with BEYOND, behind the last one:
// these read every direction at the offset that is left. With LAYERS, of the translucent layers there,
// an output each, to be added; 0 where a layer lies elsewhere.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

#if LAYERS > 0
uniform sampler2D layersTexture; // slots a picture apart: depth, alpha, plane that is received, shift
#else
uniform sampler2D surfaceTexture; // depth, plane that is received, ...
#endif
uniform float above;              // number of the plane above; BEYOND: of the last one

#if BEYOND
#if LAYERS == 0
uniform sampler2D surfaceMoreTexture; // ..., shift a unit of slope, ...
#endif
uniform sampler2D lightTexture0;      // its border is light from outside: 1
uniform sampler2D lightTexture1;
uniform sampler2D lightTexture2;
uniform sampler2D lightTexture3;
#if TAPS > 0
uniform vec2 direction[TAPS];
#else
uniform vec2 direction[16];
uniform vec4 share[4];
#endif
uniform vec2 lightPixels; // light pixels a unit of shift
uniform vec3 colors;      // 1: those that this light is for

vec4 tap(sampler2D from, vec2 at)
{
  vec2 low = floor(at - 0.5);
  vec2 f = at - 0.5 - low;
  vec2 pixel = 1.0 / vec2(textureSize(from, 0));
  vec2 a = (low + 0.5) * pixel;
  vec2 b = (low + 1.5) * pixel;
  return mix(mix(textureLod(from, a, 0.0), textureLod(from, vec2(b.x, a.y), 0.0), f.x),
    mix(textureLod(from, vec2(a.x, b.y), 0.0), textureLod(from, b, 0.0), f.x), f.y);
}

#if TAPS == 0
float four(sampler2D from, int k, vec2 at, vec2 unit)
{
  return dot(share[k], vec4(tap(from, at + direction[4 * k] * unit).r,
    tap(from, at + direction[4 * k + 1] * unit).g, tap(from, at + direction[4 * k + 2] * unit).b,
    tap(from, at + direction[4 * k + 3] * unit).a));
}
#endif

bool receives(float plane)
{
  return plane > above && plane < 1e30;
}

// Of one channel, of a plane this shift behind the last.
vec3 lightAt(ivec2 pixel, float plane, float shift)
{
  vec2 unit = lightPixels * shift;
  vec2 at = (vec2(pixel) + 0.5) / float(LIGHT_SCALE);
#if TAPS > 0
  float sum = 0.0;
  for (int k = 0; k < TAPS; ++k)
  {
    sum += tap(lightTexture0, at + direction[k] * unit).r / float(TAPS);
  }
#else
  float sum = four(lightTexture0, 0, at, unit);
#endif
#if TARGETS > 1
  sum += four(lightTexture1, 1, at, unit);
#endif
#if TARGETS > 2
  sum += four(lightTexture2, 2, at, unit);
#endif
#if TARGETS > 3
  sum += four(lightTexture3, 3, at, unit);
#endif
  return sum * colors;
}

#else
uniform sampler2D planeTexture0; // below
uniform sampler2D planeTexture1; // above
uniform float last;              // 1: there is no plane above this pair
uniform vec2 planeThere;         // 0: before the first plane, where all light arrives
uniform vec3 lightWeight[3];     // of light pixels -1, 0, 1 at offsets -1/4, 0, 1/4

// In the light pixels at the rim the place is moved to their middle.
vec3 weights(int pixel, int size)
{
  return pixel == 0 || pixel == 2 * size - 1 ? lightWeight[1]
    : (pixel & 1) == 0                       ? lightWeight[0]
                                             : lightWeight[2];
}

bool receives(float plane)
{
  return (plane < above || (plane == above && last > 0.0)) && plane >= above - 1.0;
}

vec3 lightAt(ivec2 pixel, float plane, float shift)
{
#if LIGHT_SCALE == 1
  LIGHT below = texelFetch(planeTexture0, pixel, 0).CHANNELS;
  LIGHT upper = texelFetch(planeTexture1, pixel, 0).CHANNELS;
#else
  ivec2 size = textureSize(planeTexture0, 0);
  LIGHT below = LIGHT(0.0);
  LIGHT upper = LIGHT(0.0);
  vec3 u = weights(pixel.x, size.x);
  vec3 v = weights(pixel.y, size.y);
  for (int b = 0; b < 3; ++b)
  {
    for (int a = 0; a < 3; ++a)
    {
      ivec2 q = clamp(pixel / 2 + ivec2(a - 1, b - 1), ivec2(0), size - 1);
      below += u[a] * v[b] * texelFetch(planeTexture0, q, 0).CHANNELS;
      upper += u[a] * v[b] * texelFetch(planeTexture1, q, 0).CHANNELS;
    }
  }
#endif
  below = mix(LIGHT(1.0), clamp(below, 0.0, 1.0), planeThere.x);
  upper = mix(LIGHT(1.0), clamp(upper, 0.0, 1.0), planeThere.y);
  return vec3(mix(below, upper, plane - above + 1.0));
}
#endif

#if LAYERS > 0
vec4 layer(ivec2 pixel, int k)
{
  vec2 place = texelFetch(layersTexture, pixel + ivec2(0, k * int(targetSize.y)), 0).ba;
  return vec4(receives(place.x) ? lightAt(pixel, place.x, place.y) : vec3(0.0), 0.0);
}
#endif

void main()
{
  ivec2 pixel = ivec2(texCoord * targetSize);
#if LAYERS > 0
  gl_FragData[0] = layer(pixel, 0);
#if LAYERS > 1
  gl_FragData[1] = layer(pixel, 1);
#endif
#if LAYERS > 2
  gl_FragData[2] = layer(pixel, 2);
#endif
#if LAYERS > 3
  gl_FragData[3] = layer(pixel, 3);
#endif
#if LAYERS > 4
  gl_FragData[4] = layer(pixel, 4);
#endif
#else
  float plane = texelFetch(surfaceTexture, pixel, 0).g;
  if (!receives(plane))
  {
    discard;
  }
#if BEYOND
  float shift = texelFetch(surfaceMoreTexture, pixel, 0).g;
#else
  float shift = 0.0;
#endif
  gl_FragData[0] = vec4(lightAt(pixel, plane, shift), 0.0);
#endif
}
