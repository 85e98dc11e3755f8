// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// From the samples of a pixel to at most two surfaces: the nearest one, with the share of the pixel
// that it covers, and the mean of what is behind it.
//VTK::System::Dec
//VTK::Output::Dec

uniform sampler2DMS colorSamples;
uniform sampler2DMS specularSamples;
uniform sampler2DMS depthSamples; // window depth, 1 where there is nothing
uniform int sampleCount;
uniform vec4 depthRow; // of the projection: elements (2, 2), (2, 3), (3, 2), (3, 3)
uniform float reach;   // of one surface within a pixel, world units, or a unit of depth
in vec2 texCoord;      // 0 to 1 over the textures

float eyeDepth(float window)
{
  float z = 2.0 * window - 1.0;
  return (z * depthRow.w - depthRow.y) / (z * depthRow.z - depthRow.x);
}

void main()
{
  ivec2 pixel = ivec2(texCoord * vec2(textureSize(depthSamples)));
  float nearest = 1.0;
  for (int i = 0; i < sampleCount; ++i)
  {
    nearest = min(nearest, texelFetch(depthSamples, pixel, i).r);
  }
  float depth = eyeDepth(nearest);
  float limit = depth + reach * (depthRow.w != 0.0 ? 1.0 : depth);
  vec4 color[2] = vec4[2](vec4(0.0), vec4(0.0)); // in front, behind
  vec4 specular[2] = vec4[2](vec4(0.0), vec4(0.0));
  vec2 window = vec2(0.0);
  vec2 count = vec2(0.0);
  for (int i = 0; i < sampleCount; ++i)
  {
    float here = texelFetch(depthSamples, pixel, i).r;
    if (here < 1.0)
    {
      int which = eyeDepth(here) <= limit ? 0 : 1;
      color[which] += vec4(texelFetch(colorSamples, pixel, i).rgb, 1.0);
      specular[which] += vec4(texelFetch(specularSamples, pixel, i).rgb, 0.0);
      window[which] += here;
      count[which] += 1.0;
    }
  }
  float all = float(sampleCount);
  window = vec2(count.x > 0.0 ? window.x / count.x : 1.0, count.y > 0.0 ? window.y / count.y : 1.0);
  if (count.x == all)
  {
    gl_FragData[0] = color[0] / all;
    gl_FragData[1] = specular[0] / all;
    gl_FragData[2] = vec4(0.0);
    gl_FragData[3] = vec4(window.x, window.x, 1.0, 0.0);
    return;
  }
  float rest = all - count.x;
  gl_FragData[0] = color[1] / rest;
  gl_FragData[1] = specular[1] / rest;
  gl_FragData[2] = color[0] / all;
  // light is blocked by one of the two, the one that covers more
  gl_FragData[3] = vec4(window.y, 2.0 * count.x >= all ? window.x : window.y, window.x, 0.0);
}
