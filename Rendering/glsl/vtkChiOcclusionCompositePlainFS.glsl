// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// vtkChiOcclusionCompositeFS where there is no geometry to darken and no pattern to add: a software
// rasteriser takes a third of the time for it.
//VTK::System::Dec
//VTK::Output::Dec

uniform sampler2D layerTexture; // premultiplied colour and alpha of the volume
in vec2 texCoord;               // 0 to 1 over the viewport

void main()
{
  ivec2 pixel = ivec2(texCoord * vec2(textureSize(layerTexture, 0)));
  gl_FragData[0] = texelFetch(layerTexture, pixel, 0);
}
