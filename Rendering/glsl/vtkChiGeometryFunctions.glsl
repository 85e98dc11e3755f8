// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Goes into the fragment shaders of opaque props.
uniform int chiGeometryMode; // 0 draw, 1 hide, 2 colour and specular part, 3 normal
vec3 chiSpecular = vec3(0.0);
