// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Goes into the fragment shaders of translucent props: peels one layer after the other off them
// (Everitt, "Interactive Order-Independent Transparency", 2001), or hides them.
uniform int chiLayerMode; // 0 draw, 1 hide, 2 first layer, 3 a further layer, 4 what is left
uniform int chiLayerHasOpaque;
uniform sampler2D chiLayerBefore; // window depth of the layer before, 1 where there was none
uniform sampler2D chiLayerOpaque; // window depth of the opaque geometry

bool chiLayerTakes(float depth)
{
  if (chiLayerMode < 2)
  {
    return chiLayerMode == 0;
  }
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (chiLayerHasOpaque != 0 && !(depth < texelFetch(chiLayerOpaque, pixel, 0).r))
  {
    return false;
  }
  return chiLayerMode == 2 || depth > texelFetch(chiLayerBefore, pixel, 0).r;
}
