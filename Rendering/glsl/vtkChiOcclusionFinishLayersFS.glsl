// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Adds the colours of all layers to the picture: times the transmittance in front, times the light.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D layersTexture;     // slots a picture apart: depth, alpha, plane that is received, ...
uniform sampler2D layerColorTexture; // likewise; premultiplied
uniform sampler2D weightTexture0;    // transmittance in front of three slots
uniform sampler2D weightTexture1;    // and of the others
#if LIT
uniform sampler2D lightTexture0; // visibility of a slot
uniform sampler2D lightTexture1;
uniform sampler2D lightTexture2;
uniform sampler2D lightTexture3;
uniform sampler2D lightTexture4;
uniform float strength;
#endif

vec3 color(sampler2D lightTexture, ivec2 pixel, int k)
{
  ivec2 place = pixel + ivec2(0, k * int(targetSize.y));
  vec3 rgb = texelFetch(layerColorTexture, place, 0).rgb;
#if LIT
  // before the first plane all light arrives
  LIGHT v = texelFetch(layersTexture, place, 0).b <= -1.0
    ? LIGHT(1.0) : texelFetch(lightTexture, pixel, 0).CHANNELS;
  rgb *= 1.0 - strength * (1.0 - v);
#endif
  return rgb;
}

#if !LIT
#define lightTexture0 layersTexture
#define lightTexture1 layersTexture
#define lightTexture2 layersTexture
#define lightTexture3 layersTexture
#define lightTexture4 layersTexture
#endif

void main()
{
  ivec2 pixel = ivec2(texCoord * targetSize);
  vec3 weight = texelFetch(weightTexture0, pixel, 0).rgb;
  vec3 sum = weight.x * color(lightTexture0, pixel, 0);
#if LAYERS > 1
  sum += weight.y * color(lightTexture1, pixel, 1);
#endif
#if LAYERS > 2
  sum += weight.z * color(lightTexture2, pixel, 2);
#endif
#if LAYERS > 3
  vec3 further = texelFetch(weightTexture1, pixel, 0).rgb;
  sum += further.x * color(lightTexture3, pixel, 3);
#endif
#if LAYERS > 4
  sum += further.y * color(lightTexture4, pixel, 4);
#endif
  gl_FragData[0] = vec4(sum, 0.0);
}
