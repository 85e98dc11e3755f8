/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Shading by gradients and gradient opacity, judged by closed forms and by a march of our own. */

#include "occlusion_shaded.h"

static void a_ramp_has_lamberts_brightness_in_any_frame(void)
{
  const double g[3] = { 0.3, -0.5, 0.8 };
  for (int k = 0; k < 4; ++k)
  {
    double n[3], l[3] = { 0.3, -0.4, -0.7 };
    scene_init(frames[k]);
    fill_ramp(g);
    cut_border();
    the.shading.ambient = 0.1;
    the.shading.diffuse = 0.6;
    add_light(CHI_LIGHT_DIRECTIONAL, l[0], l[1], l[2]);
    world_gradient(frames[k], g, n);
    normalize(n);
    normalize(l);
    const float* const p = centre_of(render(NULL, CHI_OK));
    CHECK(p[3] > 0.5f);
    /* differences of floats as large as 20 */
    CHECK_NEAR(p[0] / p[3], 0.1 + 0.6 * fabs(dot(n, l)), 2e-5);
    the.shading.two_sided = 0;
    const float* const q = centre_of(render(NULL, CHI_OK));
    CHECK_NEAR(q[0] / q[3], 0.1 + 0.6 * fmax(dot(n, l), 0), 2e-5);
  }
}

static void a_light_at_the_eye_has_phongs_highlight(void)
{
  const double g[3] = { 0.2, 0.1, -0.9 };
  double n[3];
  scene_init(identity);
  the.camera.parallel = 0;
  the.camera.window[0] = the.camera.window[2] = -1e-3; /* rays along the axis, but for 1e-3 */
  the.camera.window[1] = the.camera.window[3] = 1e-3;
  fill_ramp(g);
  cut_border();
  the.shading.diffuse = 0.3;
  the.shading.specular = 0.5;
  the.shading.specular_power = 7;
  add_light(CHI_LIGHT_EYE, 0, 0, 0);
  world_gradient(identity, g, n);
  normalize(n);
  const float* const p = centre_of(render(NULL, CHI_OK));
  const double highlight = pow(2 * n[2] * n[2] - 1, 7);
  CHECK(highlight > 0.2);
  CHECK_NEAR(p[0] / p[3], 0.3 * fabs(n[2]) + 0.5 * highlight, 1e-4);
  /* what faces away from one-sided light is dark */
  the.shading.two_sided = 0;
  const float* const away = centre_of(render(NULL, CHI_OK));
  CHECK_NEAR(away[0] / away[3], n[2] < 0 ? 0.3 * -n[2] + 0.5 * highlight : 0, 1e-4);
}

static void gradient_opacity_scales_the_optical_thickness(void)
{
  const double g[3] = { 0.3, -0.5, 0.8 };
  for (int k = 0; k < 4; ++k)
  {
    double n[3], edge = 0;
    scene_init(frames[k]);
    fill_ramp(g);
    cut_border();
    the.frame.shading = NULL;
    const double all = log(1 - (double)centre_of(render(NULL, CHI_OK))[3]);
    world_gradient(frames[k], g, n);
    for (int a = 0; a < 3; ++a)
    {
      edge += sqrt(frames[k][a] * frames[k][a] + frames[k][3 + a] * frames[k][3 + a] +
                frames[k][6 + a] * frames[k][6 + a]) /
        3;
    }
    const double magnitude = sqrt(dot(n, n)) * edge;
    the.transfer.gradient_opacity = the.share;
    the.transfer.gradient_end = 4;
    for (int i = 0; i < ENTRIES; ++i)
    {
      the.share[i] = 0.9f * (float)i / (ENTRIES - 1);
    }
    const double part = log(1 - (double)centre_of(render(NULL, CHI_OK))[3]);
    CHECK(magnitude < 4);
    CHECK_NEAR(part / all, 0.9 * magnitude / 4, 1e-4);
    the.transfer.gradient_end = 0.9 * magnitude; /* beyond: the last entry */
    CHECK_NEAR(log(1 - (double)centre_of(render(NULL, CHI_OK))[3]) / all, 0.9, 1e-4);
  }
}

/* Trilinear, and the sample at the border beyond it. */
static double scalar_at(const double p[3])
{
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    int at[3];
    double weight = 1;
    for (int a = 0; a < 3; ++a)
    {
      const double q = floor(p[a]);
      const int i = (int)q + (corner >> a & 1);
      at[a] = i < 0 ? 0 : i < N ? i : N - 1;
      weight *= corner >> a & 1 ? p[a] - q : 1 - (p[a] - q);
    }
    sum += weight * (double)the.scalars[at[0] + N * (at[1] + N * at[2])];
  }
  return sum;
}

/* chi_shading.h's formula, in double. */
static void shade_at(const double p[3], const double eye[3], double rgb[3])
{
  const double* const m = the.volume.index_to_world;
  double linear[9], g[3], n[3], v[3] = { eye[0], eye[1], eye[2] };
  for (int a = 0; a < 3; ++a)
  {
    double q[3] = { p[0], p[1], p[2] };
    q[a] += 1;
    g[a] = scalar_at(q);
    q[a] -= 2;
    g[a] -= scalar_at(q);
    for (int r = 0; r < 3; ++r)
    {
      linear[3 * r + a] = m[4 * r + a];
    }
  }
  world_gradient(linear, g, n);
  normalize(n);
  normalize(v);
  const chi_shading_view* const s = &the.shading;
  double diffuse[3] = { s->ambient, s->ambient, s->ambient }, specular[3] = { 0, 0, 0 };
  for (size_t k = 0; k < s->light_count; ++k)
  {
    const chi_shading_light* const light = s->lights + k;
    double l[3], reaches = 1;
    memcpy(l, light->kind == CHI_LIGHT_EYE ? v : light->direction, sizeof l);
    normalize(l);
    if (light->kind == CHI_LIGHT_POSITIONAL)
    {
      double axis[3] = { l[0], l[1], l[2] }, d;
      for (int c = 0; c < 3; ++c)
      {
        l[c] = eye[c] - light->position[c];
      }
      d = sqrt(dot(l, l));
      normalize(l);
      reaches =
        1 / (light->attenuation[0] + light->attenuation[1] * d + light->attenuation[2] * d * d);
      const double cosine = dot(l, axis);
      reaches *= cosine >= cos(light->cone_angle_rad) ? pow(cosine, light->exponent) : 0;
    }
    const double facing = fabs(dot(n, l));
    const double factor = light->kind == CHI_LIGHT_EYE ? dot(n, l) : facing;
    double r[3];
    for (int c = 0; c < 3; ++c)
    {
      r[c] = 2 * factor * n[c] - l[c];
    }
    normalize(r);
    const double along = light->kind == CHI_LIGHT_POSITIONAL ? fabs(dot(r, v)) : fmax(dot(r, v), 0);
    for (int c = 0; c < 3; ++c)
    {
      diffuse[c] += s->diffuse * light->diffuse[c] * reaches * facing;
      specular[c] +=
        facing > 0 ? s->specular * light->specular[c] * reaches * pow(along, s->specular_power) : 0;
    }
  }
  for (int c = 0; c < 3; ++c)
  {
    rgb[c] = fmin(diffuse[c] + s->ambient_light[c] + specular[c], 1);
  }
}

static void a_ball_under_lights_of_every_kind_equals_a_march_of_our_own(void)
{
  const double turned[9] = { 0.5, -0.3, 0, 0.3, 0.5, 0, 0, 0, 0.7 };
  scene_init(turned);
  the.camera.parallel = 0;
  the.camera.window[0] = the.camera.window[2] = -0.2;
  the.camera.window[1] = the.camera.window[3] = 0.2;
  the.volume.index_to_world[11] += 20;
  for (int i = 0; i < COUNT; ++i)
  {
    const double x = i % N - 11.5, y = i / N % N - 10.5, z = i / N / N - 12;
    the.scalars[i] = (float)(4 * (12 - sqrt(x * x + y * y + z * z)));
  }
  the.shading.ambient = 0.1;
  the.shading.ambient_light[1] = 0.05;
  the.shading.diffuse = 0.5;
  the.shading.specular = 0.4;
  the.shading.specular_power = 5;
  add_light(CHI_LIGHT_EYE, 0, 0, 0);
  the.light[0].diffuse[0] = 0.2;
  add_light(CHI_LIGHT_DIRECTIONAL, 1, -2, -0.5);
  the.light[1].specular[2] = 0;
  add_light(CHI_LIGHT_POSITIONAL, 0.1, 0.2, -1);
  chi_shading_light* const spot = the.light + 2;
  const double place[3] = { -3, -8, -20 }, falls[3] = { 0.2, 0.05, 0.001 };
  memcpy(spot->position, place, sizeof place);
  memcpy(spot->attenuation, falls, sizeof falls);
  spot->cone_angle_rad = 1.5;
  spot->exponent = 6;
  the.params.sample_distance = 0.05;
  const float* const rgba = render(NULL, CHI_OK);
  const double* const m = the.volume.index_to_world;
  const double sigma = -log(0.95), det = 0.5 * 0.5 + 0.3 * 0.3;
  int compared = 0;
  for (int y = 5; y < PIXELS; y += 10)
  {
    for (int x = 5; x < PIXELS; x += 5)
    {
      const double slope[2] = { -0.2 + 0.4 * (x + 0.5) / PIXELS, -0.2 + 0.4 * (y + 0.5) / PIXELS };
      const double step = 0.05, length = sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
      double color[3] = { 0, 0, 0 }, through = 1;
      for (double z = 25; z < 60; z += step)
      {
        const double eye[3] = { slope[0] * z, slope[1] * z, -z };
        const double dx = eye[0] - m[3], dy = eye[1] - m[7];
        const double p[3] = { (0.5 * dx + 0.3 * dy) / det, (-0.3 * dx + 0.5 * dy) / det,
          (eye[2] - m[11]) / 0.7 };
        int inside = 1;
        for (int a = 0; a < 3; ++a)
        {
          inside &= p[a] >= 0 && p[a] <= N - 1;
        }
        if (inside)
        {
          double rgb[3];
          shade_at(p, eye, rgb);
          const double alpha = 1 - exp(-sigma * step * length);
          for (int c = 0; c < 3; ++c)
          {
            color[c] += through * alpha * rgb[c];
          }
          through *= 1 - alpha;
        }
      }
      for (int c = 0; c < 3; ++c)
      {
        /* both ends of a ray may lie a step off, which adds sigma * step = 0.0026 each */
        CHECK_NEAR(rgba[4 * (y * PIXELS + x) + c], color[c], 0.006);
        compared += color[c] > 0.2;
      }
    }
  }
  CHECK(compared > 40);
}

static void every_sample_type_gives_the_same_picture(void)
{
  static uint8_t u8[COUNT];
  static int16_t i16[COUNT];
  static uint16_t u16[COUNT];
  static double f64[COUNT];
  const struct
  {
    const void* scalars;
    chi_type type;
    size_t stride;
  } as[4] = { { u8, CHI_U8, 1 }, { i16, CHI_I16, 2 }, { u16, CHI_U16, 2 }, { f64, CHI_F64, 8 } };
  for (int interpolation = CHI_NEAREST; interpolation <= CHI_LINEAR; ++interpolation)
  {
    uint32_t state = 7;
    static float expected[4 * PIXELS * PIXELS];
    scene_init(frames[1]);
    the.volume.interpolation = interpolation;
    the.transfer.gradient_opacity = the.share;
    the.transfer.gradient_end = 100;
    the.share[0] = 0.1f;
    the.transfer.range[0] = 0;
    the.transfer.range[1] = 256;
    add_light(CHI_LIGHT_DIRECTIONAL, 1, 1, -2);
    the.shading.specular = 0.5;
    for (int i = 0; i < COUNT; ++i)
    {
      u8[i] = (uint8_t)(256 * chi_test_random(&state));
      the.scalars[i] = (float)u8[i];
      i16[i] = u8[i];
      u16[i] = u8[i];
      f64[i] = u8[i];
    }
    memcpy(expected, render(NULL, CHI_OK), sizeof expected);
    CHECK(expected[4 * (PIXELS / 2 * PIXELS + PIXELS / 2)] > 0.1f);
    for (int k = 0; k < 4; ++k)
    {
      the.volume.scalars = as[k].scalars;
      the.volume.type = as[k].type;
      the.volume.stride = as[k].stride;
      const float* const rgba = render(NULL, CHI_OK);
      double largest = 0;
      for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
      {
        largest = fmax(largest, fabs((double)rgba[i] - (double)expected[i]));
      }
      /* doubles are copied to floats around 0: roundings of 1e-7, and nearest samples may turn */
      CHECK(largest <= (as[k].type == CHI_F64 ? 1e-4 : 0));
    }
  }
}

/* What is below 0 would add light to it, what is above 1 take more than there is. */
static void gradient_opacities_are_cut_to_0_and_1(void)
{
  static float expected[4 * PIXELS * PIXELS];
  for (int k = 0; k < 2; ++k)
  {
    uint32_t state = 7;
    scene_init(identity);
    the.params.strength = 1;
    the.transfer.gradient_opacity = the.share;
    the.transfer.gradient_end = 100;
    for (int i = 0; i < COUNT; ++i)
    {
      the.scalars[i] = (float)(200 * chi_test_random(&state) - 100);
    }
    for (int i = 0; i < ENTRIES; ++i)
    {
      the.share[i] = k ? (i % 3 ? (float)(i % 3 * 1000 - 1500) : NAN) : i % 3 == 2;
    }
    const float* const rgba = render(NULL, CHI_OK);
    CHECK(k == 0 || memcmp(rgba, expected, sizeof expected) == 0);
    memcpy(expected, rgba, sizeof expected);
  }
  CHECK(expected[4 * (PIXELS / 2 * PIXELS + PIXELS / 2) + 3] > 0.1f);
}

/* The gradient belongs to the sample, in the middle of its segment, and not to the segment's end.
 */
static void nearest_gradients_look_the_same_from_both_sides(void)
{
  const double turned[9] = { -1, 0, 0, 0, 1, 0, 0, 0, -1 };
  static float alpha[2][PIXELS * PIXELS];
  for (int side = 0; side < 2; ++side)
  {
    uint32_t state = 7;
    scene_init(side ? turned : identity);
    the.volume.interpolation = CHI_NEAREST;
    the.params.sample_distance = 0.5; /* middles lie a quarter of a voxel off its faces */
    the.transfer.gradient_opacity = the.share;
    the.transfer.gradient_end = 100;
    for (int i = 0; i < ENTRIES; ++i)
    {
      the.share[i] = (float)i / (ENTRIES - 1);
    }
    for (int i = 0; i < COUNT; ++i)
    {
      the.scalars[i] = (float)(200 * chi_test_random(&state) - 100);
    }
    const float* const rgba = render(NULL, CHI_OK);
    for (int i = 0; i < PIXELS * PIXELS; ++i)
    {
      alpha[side][i] = rgba[4 * i + 3];
    }
  }
  double largest = 0, most = 0;
  for (int i = 0; i < PIXELS * PIXELS; ++i)
  {
    const int mirrored = i - i % PIXELS + PIXELS - 1 - i % PIXELS;
    largest = fmax(largest, fabs((double)alpha[0][i] - (double)alpha[1][mirrored]));
    most = fmax(most, (double)alpha[0][i]);
  }
  CHECK(most > 0.3);
  CHECK(largest < 1e-5); /* products of 46 floats in the other order */
}

static void without_a_gradient_the_ambient_light_is_left(void)
{
  scene_init(identity);
  the.shading.ambient = 0.25;
  the.shading.ambient_light[2] = 0.5;
  the.shading.specular = 1;
  for (int k = 0; k < 3; ++k)
  {
    add_light(k, 1, 1, -1);
  }
  const float* const p = centre_of(render(NULL, CHI_OK));
  CHECK_NEAR(p[0] / p[3], 0.25, 1e-5);
  CHECK_NEAR(p[2] / p[3], 0.75, 1e-5);
  /* nor beside what is not finite; and nothing else becomes so */
  for (int i = 0; i < COUNT; i += 3)
  {
    the.scalars[i] = i & 1 ? NAN : (float)INFINITY;
  }
  const float* const q = render(NULL, CHI_OK);
  for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
  {
    CHECK(isfinite(q[i]));
  }
}

static void thin_volumes_stay_finite(void)
{
  const size_t sizes[5][3] = { { 1, 1, 7 }, { 2, 2, 2 }, { 1, 5, 3 }, { 9, 1, 2 }, { 3, 2, 1 } };
  for (int type = 0; type < 2; ++type)
  {
    for (int k = 0; k < 5; ++k)
    {
      scene_init(identity);
      const size_t count = sizes[k][0] * sizes[k][1] * sizes[k][2];
      uint8_t* const exact = (uint8_t*)malloc(count * (type ? 4 : 1)); /* ASan sees overruns */
      for (size_t i = 0; i < count; ++i)
      {
        exact[i] = (uint8_t)(17 * i);
        if (type)
        {
          ((float*)(void*)exact)[i] = (float)(17 * i % 256);
        }
      }
      the.volume.is_cell_data = 1; /* so that one sample has a volume */
      the.volume.scalars = exact;
      the.volume.type = type ? CHI_F32 : CHI_U8;
      the.volume.stride = type ? 4 : 1;
      memcpy(the.volume.dimensions, sizes[k], sizeof the.volume.dimensions);
      the.volume.index_to_world[3] = the.volume.index_to_world[7] = 0;
      the.transfer.gradient_opacity = the.share;
      add_light(CHI_LIGHT_EYE, 0, 0, 0);
      const float* const rgba = render(NULL, CHI_OK);
      double sum = 0;
      for (int i = 0; i < 4 * PIXELS * PIXELS; ++i)
      {
        sum += rgba[i];
      }
      CHECK(isfinite(sum) && sum > 0);
      free(exact);
    }
  }
}

static void any_schedule_gives_the_same_bits(void)
{
  static float expected[4 * PIXELS * PIXELS];
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  uint32_t state = 3;
  scene_init(frames[1]);
  the.params.strength = 1;
  the.transfer.gradient_opacity = the.share;
  the.share[1] = 0.2f;
  the.shading.specular = 0.5;
  add_light(CHI_LIGHT_EYE, 0, 0, 0);
  add_light(CHI_LIGHT_DIRECTIONAL, 1, 1, -2);
  for (int i = 0; i < COUNT; ++i)
  {
    the.scalars[i] = (float)chi_test_random(&state);
  }
  memcpy(expected, render(NULL, CHI_OK), sizeof expected);
  CHECK(memcmp(expected, render(&backwards, CHI_OK), sizeof expected) == 0);
}

static void what_is_out_of_range_is_refused(void)
{
  double* const value[] = { &the.shading.ambient, &the.shading.diffuse, &the.shading.specular,
    &the.shading.specular_power, the.shading.ambient_light, the.light[0].diffuse,
    the.light[0].specular, the.light[0].position, the.light[0].attenuation,
    &the.light[0].cone_angle_rad, &the.light[0].exponent, the.light[0].direction };
  for (size_t i = 0; i < sizeof value / sizeof value[0]; ++i)
  {
    for (int k = 0; k < 2; ++k)
    {
      scene_init(identity);
      add_light(CHI_LIGHT_POSITIONAL, 0, 0, -1);
      const int any_sign = value[i] == the.light[0].position || value[i] == the.light[0].direction;
      *value[i] = k || any_sign ? NAN : -0.1;
      render(NULL, CHI_ERROR_INVALID_ARGUMENT);
    }
  }
  scene_init(identity);
  add_light(CHI_LIGHT_DIRECTIONAL, 0, 0, 0); /* no direction */
  render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  scene_init(identity);
  add_light(3, 0, 0, 1); /* no such kind */
  render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  scene_init(identity);
  the.shading.light_count = CHI_MAX_LIGHTS + 1;
  render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  scene_init(identity);
  the.transfer.gradient_opacity = the.share;
  the.transfer.gradient_count = 1;
  render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  the.transfer.gradient_count = ENTRIES;
  the.transfer.gradient_end = 0;
  render(NULL, CHI_ERROR_INVALID_ARGUMENT);
  the.transfer.gradient_end = 1;
  render(NULL, CHI_OK);
}

static void the_picture_does_not_depend_on_the_unit_of_length_or_of_the_scalar(void)
{
  static float expected[4 * PIXELS * PIXELS];
  for (int k = 0; k < 2; ++k)
  {
    const double length = k ? 1e-6 : 1, unit = k ? 1e12 : 1;
    double linear[9];
    uint32_t state = 11;
    for (int i = 0; i < 9; ++i)
    {
      linear[i] = frames[1][i] * length;
    }
    scene_init(linear);
    the.volume.index_to_world[11] += 60 - 60 * length;
    for (int i = 0; i < 4; ++i)
    {
      the.camera.window[i] = (the.camera.window[i] + 0.0371) * length; /* no edge on a centre */
    }
    the.camera.near_depth *= length;
    the.transfer.unit_distance = length;
    the.transfer.range[0] = 0;
    the.transfer.range[1] = unit;
    the.transfer.gradient_opacity = the.share;
    the.transfer.gradient_end = 0.5 * unit;
    the.share[0] = 0.2f;
    the.shading.specular = 0.5;
    add_light(CHI_LIGHT_DIRECTIONAL, 1, 1, -2);
    add_light(CHI_LIGHT_POSITIONAL, 1, 1, -2);
    the.light[1].attenuation[1] = 0.1 / length;
    for (int i = 0; i < COUNT; ++i)
    {
      the.scalars[i] = (float)(unit * chi_test_random(&state));
    }
    const float* const rgba = render(NULL, CHI_OK);
    double largest = 0;
    for (int i = 0; i < 4 * PIXELS * PIXELS && k; ++i)
    {
      largest = fmax(largest, fabs((double)rgba[i] - (double)expected[i]));
    }
    CHECK_NEAR(largest, 0, 1e-4); /* roundings of positions, on noise */
    memcpy(expected, rgba, sizeof expected);
  }
  CHECK(expected[4 * (PIXELS / 2 * PIXELS + PIXELS / 2)] > 0.05f);
}

int main(void)
{
  a_ramp_has_lamberts_brightness_in_any_frame();
  a_light_at_the_eye_has_phongs_highlight();
  gradient_opacity_scales_the_optical_thickness();
  a_ball_under_lights_of_every_kind_equals_a_march_of_our_own();
  every_sample_type_gives_the_same_picture();
  gradient_opacities_are_cut_to_0_and_1();
  nearest_gradients_look_the_same_from_both_sides();
  without_a_gradient_the_ambient_light_is_left();
  thin_volumes_stay_finite();
  any_schedule_gives_the_same_bits();
  what_is_out_of_range_is_refused();
  the_picture_does_not_depend_on_the_unit_of_length_or_of_the_scalar();
  return chi_test_report();
}
