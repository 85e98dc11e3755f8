// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Puts one volume's ids into a buffer of vtkHardwareSelector.
//VTK::System::Dec
//VTK::Output::Dec

uniform sampler2D idTexture; // the colour of an id, and the depth in the window, 1 where there is none
in vec2 texCoord;            // 0 to 1 over the viewport

void main()
{
  vec4 id = texelFetch(idTexture, ivec2(texCoord * vec2(textureSize(idTexture, 0))), 0);
  if (id.a >= 1.0)
  {
    discard;
  }
  gl_FragDepth = id.a;
  gl_FragData[0] = vec4(id.rgb, 1.0);
}
