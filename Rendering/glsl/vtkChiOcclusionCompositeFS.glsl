// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Lays one mapper's picture over the bound frame buffer. Blending is ONE, ONE_MINUS_SRC_ALPHA, so
// that the alpha written is what the frame buffer's content loses.
//VTK::System::Dec
//VTK::Output::Dec

uniform sampler2D layerTexture;      // premultiplied colour and alpha of the volume
uniform sampler2D visibilityTexture; // of the opaque geometry, 1 where there is none
uniform sampler2D surfaceTexture;    // lit colour of the opaque geometry times the share that it covers, and this
uniform sampler2D specularTexture;   // the part of it that occlusion does not take
uniform int hasSurface;
uniform int hasSpecular;
uniform int rewriteSurface; // replace the geometry's pixels instead of darkening them
uniform int coloredVisibility; // it has three components
uniform int stage; // 0: blending as above; 1: write what the frame buffer's colours are to be
                   // multiplied by, each on its own; 2: what is to be added to them
uniform int dither; // add a pattern within half a step of 8 bits
in vec2 texCoord;           // 0 to 1 over the viewport

// Threshold of a pixel in 0 ... 63 of the 8 x 8 matrix of Bayer 1973: the bits of x ^ y and y, taken
// in turns from the lowest.
int bayer(ivec2 at)
{
  int mixed = (at.x ^ at.y) & 7;
  int sum = 0;
  for (int bit = 0; bit < 3; ++bit)
  {
    sum = 4 * sum + 2 * ((mixed >> bit) & 1) + ((at.y >> bit) & 1);
  }
  return sum;
}

void main()
{
  ivec2 pixel = ivec2(texCoord * vec2(textureSize(layerTexture, 0)));
  vec4 layer = texelFetch(layerTexture, pixel, 0);
  vec3 keep = vec3(1.0 - layer.a);
  if (hasSurface != 0)
  {
    // Schott et al. 2013, Eqs 9 and 10: (occlusion (lit - specular) + specular) (1 - alpha) + volume
    vec3 visibility = texelFetch(visibilityTexture, pixel, 0).rgb;
    visibility = coloredVisibility != 0 ? visibility : visibility.rrr;
    if (hasSpecular != 0)
    {
      layer.rgb += keep * (1.0 - visibility) * texelFetch(specularTexture, pixel, 0).rgb;
    }
    if (rewriteSurface != 0)
    {
      vec4 surface = texelFetch(surfaceTexture, pixel, 0);
      layer.rgb += keep * visibility * surface.rgb;
      keep *= 1.0 - surface.a;
    }
    else
    {
      keep *= visibility;
    }
  }
  // only where something is drawn; the frame buffer rounds what it has and what is added together
  if (dither != 0 && (layer.a > 0.0 || any(lessThan(keep, vec3(1.0)))))
  {
    layer.rgb += (float(bayer(pixel)) - 31.5) / (64.0 * 255.0);
  }
  float through = coloredVisibility != 0 ? (keep.r + keep.g + keep.b) / 3.0 : keep.r;
  gl_FragData[0] = stage == 1 ? vec4(keep, through) : vec4(layer.rgb, 1.0 - through);
}
