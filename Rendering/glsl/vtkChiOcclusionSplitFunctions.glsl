// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Layers that lie among samples: each cuts a segment in two (chi_layers.c, theory/occlusion.md,
// "Translucent layers").
#if LAYERS > 0
uniform sampler2D layersTexture; // slots a picture apart, the nearest first: depth in slices, alpha, ...
uniform vec2 layerRange;         // slices of this slab

float layerWeight[3 * WEIGHTS]; // transmittance in front of each slot, within the slab
int slot;                       // the next one
vec2 layer;                     // its depth and alpha
ivec2 layerPixel;

void nextLayer()
{
  layer = vec2(1e30, 0.0);
  if (slot < LAYERS)
  {
    layer = texelFetch(layersTexture, layerPixel + ivec2(0, slot * int(targetSize.y)), 0).rg;
  }
}

void startLayers(ivec2 pixel)
{
  layerPixel = pixel;
  slot = 0;
  for (int k = 0; k < 3 * WEIGHTS; ++k)
  {
    layerWeight[k] = 0.0;
  }
  for (nextLayer(); layer.r < layerRange.x; nextLayer())
  {
    ++slot;
  }
}

// A segment whose samples lie from slices.x to slices.y, with the layers in front of slices.z; its
// weight for the eye.
float blendLayers(vec3 slices, float tau, inout float through)
{
  float weight = 0.0;
  float last = 1.0; // left by the samples so far
  for (float end = min(slices.z, layerRange.y); layer.r < end; nextLayer())
  {
    bool inside = layer.r > slices.x && slices.y > slices.x;
    float f = inside ? min((layer.r - slices.x) / (slices.y - slices.x), 1.0) : 0.0;
    float here = exp(-tau * f);
    weight += through * (last - here);
    layerWeight[slot] = through * here;
    through *= 1.0 - layer.g;
    last = here;
    ++slot;
  }
  weight += through * (last - exp(-tau));
  through *= exp(-tau);
  return weight;
}
#endif
