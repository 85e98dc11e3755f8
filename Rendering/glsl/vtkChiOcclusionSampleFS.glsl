// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Samples of one slab: fetch, classify, composite, as the core's kernels do it
// (simd/chi_occlusion_sample.inl). Output 0 goes under what the rays have met already (blending
// ONE_MINUS_DST_ALPHA, ONE), and so do the weights of layers, WEIGHTS outputs; the last output is the
// optical thickness of the slab along the view axis.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

// Index position of a pixel at a slice, counted from this pixel and the slab's first slice.
uniform vec2 firstPixel;
uniform vec3 position;
uniform vec3 positionX; // its change a pixel
uniform vec3 positionY;
uniform vec3 direction; // its change a slice
uniform vec3 directionX;
uniform vec3 directionY;
uniform vec3 boxLow;
uniform vec3 boxHigh;
#if CLIPS > 0
uniform vec4 clip[CLIPS];
#endif
uniform vec2 raySlope;     // of pixel (0, 0)
uniform vec2 raySlopeStep; // its change a pixel
uniform float slice;       // world distance between slices
uniform int segments;
uniform int startsHere; // nothing has been sampled before the first slice
uniform float firstSlice;

#if HAS_SURFACE
uniform sampler2D surfaceTexture; // depth in slices, ...
#endif

//CHI::Functions::Dec

void main()
{
  vec2 pixel = floor(texCoord * targetSize);
  vec2 d = pixel - firstPixel;
  vec3 p = position + d.x * positionX + d.y * positionY;
  vec3 q = direction + d.x * directionX + d.y * directionY;

  // Where the ray enters and leaves the box, less what is clipped, in slices from the first one.
  float enter = -1.0;
  float leave = float(segments) + 1.0;
  for (int a = 0; a < 3; ++a)
  {
    if (q[a] == 0.0)
    {
      leave = p[a] >= boxLow[a] && p[a] <= boxHigh[a] ? leave : -2.0;
      continue;
    }
    float t0 = (boxLow[a] - p[a]) / q[a];
    float t1 = (boxHigh[a] - p[a]) / q[a];
    enter = max(enter, min(t0, t1));
    leave = min(leave, max(t0, t1));
  }
#if CLIPS > 0
  for (int k = 0; k < CLIPS; ++k)
  {
    float value = dot(clip[k], vec4(p, 1.0));
    float change = dot(clip[k].xyz, q);
    enter = change > 0.0 ? max(enter, -value / change) : enter;
    leave = change < 0.0 ? min(leave, -value / change)
      : change == 0.0 && value < 0.0 ? -2.0 : leave;
  }
#endif

  vec4 color = vec4(0.0);
  float thickness = 0.0;
  float through = 1.0;
#if LAYERS > 0
  startLayers(ivec2(pixel));
#endif
  if (enter < leave && enter < float(segments) && leave > 0.0)
  {
#if HAS_SURFACE
    float surface = texelFetch(surfaceTexture, ivec2(pixel), 0).r - firstSlice;
#endif
    vec3 lastIndex = vec3(textureSize(volumeTexture, 0) - 1);
    vec2 slope = raySlope + pixel * raySlopeStep;
    float ray = sqrt(1.0 + dot(slope, slope));
    float before = -1.0;
    bool known = false; // before: the table position at the near slice
    int first = 0;      // entry of that table
#if HAS_LIGHT
    Planes planes = Planes(LIGHT(1.0), LIGHT(1.0), LIGHT(1.0));
    bool lit = false; // planes are those of this pixel
#endif
    int begin = max(int(floor(enter)), 0);
    int end = min(int(ceil(leave)), segments);
    for (int i = begin; i < end; ++i)
    {
      float near = float(i);
      float start = max(near, enter);
      float far = min(near + 1.0, leave);
      float stop = far; // of samples
      float fraction = max(stop - start, 0.0);
      bool entering = enter >= near || (startsHere != 0 && i == 0);
#if HAS_REGIONS || GRIDS > 0
      Left left = cutSegment(p + (near + 1.0) * q, q, entering ? start - near : -cutAhead,
        start - near, stop - near);
      if (!(left.fraction > 0.0))
      {
        before = -1.0;
        known = true;
        continue;
      }
      entering = entering || !left.before;
      start = near + left.run;
      stop = near + left.stop;
      fraction = left.fraction;
#endif
#if NEAREST
      float place = 0.5 * (start + stop); // the middle's label is the segment's
      float ahead = near - 0.5;
#else
      float place = stop;
      float ahead = near;
#endif
      if (!known && !entering)
      {
        before = tablePosition(p + ahead * q);
#if HAS_LABELS
        first = tableAt(p + ahead * q);
#endif
      }
      float t = tablePosition(p + place * q);
#if HAS_LABELS
      // what was sampled before may be of another table
      int table = tableAt(p + place * q);
      entering = entering || (before >= 0.0 && table != first);
      first = table;
#endif
#if NEAREST
      float t0 = -1.0; // samples are steps: nothing lies between two labels
#else
      float t0 = entering ? -1.0 : before;
#endif
      bool valid = t >= 0.0 && (entering || before >= 0.0);
      before = t;
      known = true;
      if (!valid)
      {
        continue;
      }
      float depth = meanExtinction(first, ENTRIES - 1, quantum, t0, t) * (fraction * slice);
#if COMPONENTS > 0
      float own = depth * ray;
      vec3 rgb = colorOf(first, t0, t, own, through * (1.0 - exp(-own)));
#if NEAREST
      float back = place;
#else
      float back = place - fraction;
#endif
      depth = composeComponents(p + back * q, p + place * q, depth, fraction * slice, rgb);
#endif
#if HAS_SHADING
#if NEAREST
      vec3 middle = p + place * q;
#else
      vec3 middle = p + (stop - 0.5 * fraction) * q;
#endif
      float whole = depth * ray; // the colour's, which knows neither gradients nor surfaces
      if (!(depth > 0.0))
      {
        continue;
      }
      vec3 inside = clamp(middle, vec3(0.0), lastIndex);
      vec3 gradient = gradientAt(inside);
#endif
#if HAS_ROWS
      vec3 rgb;
      depth = extinctionOfTwo(t0, t, secondQuantity(inside, gradient), rgb) * (fraction * slice);
#endif
#if HAS_GRADIENT_OPACITY
      depth *= gradientOpacity(length(gradient));
#endif
      thickness += depth;
#if HAS_SURFACE
      depth *= clamp(surface - near, 0.0, fraction) / max(fraction, 1e-30);
#endif
      if (!(depth > 0.0))
      {
        continue;
      }
      float tau = depth * ray;
      float weight = through * (1.0 - exp(-tau));
#if HAS_ROWS == 0 && COMPONENTS == 0
#if HAS_SHADING
      float seen = through * (1.0 - exp(-whole));
#else
      float whole = tau;
      float seen = weight;
#endif
      vec3 rgb = colorOf(first, t0, t, whole, seen);
#endif
#if LAYERS > 0
      weight = blendLayers(vec3(max(near, enter),
#if HAS_SURFACE
        min(far, surface),
#else
        far,
#endif
        near + 1.0) + firstSlice, tau, through);
#else
      through -= weight;
#endif
      vec3 visibility = vec3(1.0);
#if HAS_LIGHT
      if (!lit)
      {
        planes = planesHere(ivec2(pixel));
        lit = true;
      }
      visibility = vec3(visibilityAt(planes, i));
#endif
#if IS_SHADED
      rgb = shade(rgb, gradient, middle, visibility);
#else
      rgb *= visibility;
#endif
      color.rgb += weight * rgb;
    }
  }
#if LAYERS > 0
  blendLayers(layerRange.yyy, 0.0, through); // behind the slab's samples
#endif
  color.a = 1.0 - through;
  gl_FragData[0] = color;
#if WEIGHTS == 0
  gl_FragData[1] = vec4(thickness);
#else
  gl_FragData[1] = vec4(layerWeight[0], layerWeight[1], layerWeight[2], color.a);
#if WEIGHTS == 1
  gl_FragData[2] = vec4(thickness);
#else
  gl_FragData[2] = vec4(layerWeight[3], layerWeight[4], layerWeight[5], color.a);
  gl_FragData[3] = vec4(thickness);
#endif
#endif
}
