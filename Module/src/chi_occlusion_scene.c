/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_internal.h"
#include "math/chi_mat4.h"

#include <math.h>

double chi_scene_shift(const chi_scene* scene, double from, double to)
{
  /* A ray of constant slope against the pixel's own moves by f s dz / z in perspective. */
  return scene->parallel ? to - from : log(to / from);
}

static void place_pixels(chi_scene* scene, const chi_camera* camera, const double eye_to_index[16])
{
  const double dx = (camera->window[1] - camera->window[0]) / camera->width;
  const double dy = (camera->window[3] - camera->window[2]) / camera->height;
  const double left = camera->window[0] + 0.5 * dx, bottom = camera->window[2] + 0.5 * dy;
  for (int a = 0; a < 3; ++a)
  {
    const double* const row = eye_to_index + 4 * a;
    scene->along_x[a] = row[0] * dx;
    scene->along_y[a] = row[1] * dy;
    const double corner = row[0] * left + row[1] * bottom;
    scene->origin[a] = row[3] + (scene->parallel ? corner : 0);
    scene->axis[a] = -row[2] + (scene->parallel ? 0 : corner);
  }
  scene->slope_x = scene->parallel ? 0 : left;
  scene->slope_dx = scene->parallel ? 0 : dx;
  scene->slope_y = scene->parallel ? 0 : bottom;
  scene->slope_dy = scene->parallel ? 0 : dy;
  scene->pixels_x = 1 / (dx * scene->scale);
  scene->pixels_y = 1 / (dy * scene->scale);
}

/* A plane of world space in index space, of unit normal; 0 where it has no direction. */
static int place_plane(const double m[16], const double p[4], double q[4])
{
  double square = 0;
  for (int a = 0; a < 4; ++a)
  {
    q[a] = p[0] * m[a] + p[1] * m[4 + a] + p[2] * m[8 + a] + (a == 3 ? p[3] : 0);
    square += a < 3 ? q[a] * q[a] : 0;
  }
  const double scale = 1 / sqrt(square);
  int finite = 1;
  for (int a = 0; a < 4; ++a)
  {
    q[a] *= scale;
    finite &= isfinite(q[a]) != 0;
  }
  return finite;
}

/* The frame's clip planes and cropping regions; 0 where a plane has no direction. */
static int place_cuts(chi_scene* scene, const chi_occlusion_frame* frame)
{
  const double* const m = frame->volume->index_to_world;
  int valid = 1;
  scene->clips = (int)frame->clip_plane_count;
  for (int k = 0; k < scene->clips; ++k)
  {
    valid &= place_plane(m, frame->clip_planes + 4 * k, scene->clip[k]);
  }
  scene->regions = frame->crop ? frame->crop->regions & CHI_CROP_ALL_REGIONS : CHI_CROP_ALL_REGIONS;
  for (int k = 0; frame->crop && k < 6; ++k)
  {
    valid &= place_plane(m, frame->crop->planes[k], scene->crop[k]);
  }
  return valid;
}

static double clip_value(const double clip[4], const double p[3])
{
  return clip[0] * p[0] + clip[1] * p[1] + clip[2] * p[2] + clip[3];
}

/* Depths of what one plane leaves of the box, from its corners and its edges' cuts: all planes
 * together leave no more. */
static void narrow_depths(
  const chi_scene* scene, const double clip[4], const double index_to_eye[16], double range[2])
{
  double near = INFINITY, far = -INFINITY;
  for (int corner = 0; corner < 8; ++corner)
  {
    double p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = corner >> a & 1 ? scene->box_high[a] : scene->box_low[a];
    }
    const double here = clip_value(clip, p);
    for (int a = -1; a < 3; ++a)
    {
      double q[3] = { p[0], p[1], p[2] };
      if (a >= 0)
      {
        q[a] = corner >> a & 1 ? scene->box_low[a] : scene->box_high[a];
        const double there = clip_value(clip, q);
        if (!((here < 0) != (there < 0)))
        {
          continue;
        }
        q[a] = p[a] + (q[a] - p[a]) * (here / (here - there));
      }
      else if (here < 0)
      {
        continue;
      }
      const double depth = -(index_to_eye[8] * q[0] + index_to_eye[9] * q[1] +
        index_to_eye[10] * q[2] + index_to_eye[11]);
      near = fmin(near, depth);
      far = fmax(far, depth);
    }
  }
  range[0] = fmax(range[0], near);
  range[1] = fmin(range[1], far);
}

/*
 * A bilinear shift by a whole number of pixels keeps an edge sharp, one by half a pixel blurs it.
 * Of few directions some are always sharp, and what steps a penumbra has come from them. So the
 * shifts of all of them swing to and fro, which blurs each more nearly as all are in the mean.
 * Never so far that light crosses another row in a slab: that costs time (theory/occlusion.md,
 * "Order of the work").
 */
static void place_zigzag(chi_scene* scene, double share)
{
  /* Light pixels. More would make steps smaller still, but what a plate casts on a wall at full
   * size misses the exact cone by more than the 0.028 asked for. */
  const double amplitude = share * (scene->scale == 2 ? 0.0625 : 0.045);
  const double shift = chi_scene_shift(
    scene, chi_scene_depth(scene, 0.5), chi_scene_depth(scene, 1.5)); /* nearest = widest */
  const double pixels[2] = { scene->pixels_x, scene->pixels_y };
  const int count = scene->directions / scene->lights; /* of each light */
  /* a quarter off, since depths of whole and half slabs are common */
  scene->zigzag_phase = (int64_t)floor(fmod(scene->start / scene->slab + 0.25, 2));
  for (int i = 0; i < 2 * scene->lights; ++i)
  {
    const int a = i & 1, first = i / 2 * count;
    double widest = 0;
    for (int m = first; m < first + count; ++m)
    {
      widest = fmax(widest, fabs((double)scene->tangent[a][m] * pixels[a] * shift));
    }
    const double most = fmax(ceil(widest), 1);
    for (int m = first; m < first + count; ++m)
    {
      const double room = most - fabs((double)scene->tangent[a][m] * pixels[a] * shift);
      const double side = (((m - first) >> a) & 1 ? -1 : 1) * (pixels[a] < 0 ? -1 : 1);
      scene->zigzag[a][m] = scene->published ? 0 : (float)(side * fmin(amplitude, 0.5 * room));
    }
  }
}

static void place_picture(
  chi_scene* scene, const chi_camera* camera, const chi_occlusion_params* params)
{
  scene->width = camera->width;
  scene->height = camera->height;
  scene->scale = params->half_size ? 2 : 1;
  scene->light_width = (camera->width - 1) / scene->scale + 1;
  scene->light_height = (camera->height - 1) / scene->scale + 1;
  scene->parallel = camera->parallel != 0;
  scene->published = params->method == CHI_OCCLUSION_PUBLISHED;
  chi_scene_place_lights(scene, params);
}

void chi_scene_build_slabs(chi_scene* scene, const chi_camera* camera,
  const chi_occlusion_params* params, const double depths[2], int64_t slabs)
{
  static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  place_picture(scene, camera, params);
  place_pixels(scene, camera, identity);
  scene->group = 1;
  scene->slabs = scene->volume_end = slabs;
  scene->volume_begin = 0;
  scene->start = depths[0];
  scene->slice = scene->slab = scene->voxel = (depths[1] - depths[0]) / (double)slabs;
  /* what light there is must be known of a whole slab before it is drawn: light planes lie in the
   * middle of slabs */
  scene->bias = scene->sample_bias = fmax(params->bias / scene->slab, 1.5);
  /* The swing blurs by the slab: where these are thinner than what light moves by in a voxel that
   * is a pixel wide, each swings so much less, and all together blur alike. */
  double steepest = 0;
  for (int m = 0; m < scene->directions; ++m)
  {
    steepest = fmax(steepest, hypot((double)scene->tangent[0][m], (double)scene->tangent[1][m]));
  }
  const double shift = chi_scene_shift(scene, chi_scene_depth(scene, 0.5), depths[1]) *
    fmax(fabs(scene->pixels_x), fabs(scene->pixels_y)) / (double)slabs;
  const double usual = steepest / scene->scale;
  place_zigzag(scene, usual > 0 ? fmin(steepest * shift / usual, 1) : 1);
}

chi_status chi_scene_build(
  chi_scene* scene, const chi_occlusion_frame* frame, double surface_near, double surface_far)
{
  const chi_camera* const camera = frame->camera;
  const chi_occlusion_params* const params = frame->params;
  place_picture(scene, camera, params);
  double eye_to_index[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  double near = INFINITY, far = -INFINITY, box[2] = { INFINITY, -INFINITY };
  if (frame->volume)
  {
    double index_to_eye[16];
    chi_mat4_multiply(camera->world_to_eye, frame->volume->index_to_world, index_to_eye);
    if (!chi_mat4_invert_affine(index_to_eye, eye_to_index))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    const double margin = frame->volume->is_cell_data ? 0.5 : 0;
    for (int a = 0; a < 3; ++a)
    {
      scene->box_low[a] = -margin;
      scene->box_high[a] = (double)(frame->volume->dimensions[a] - 1) + margin;
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      double depth = -index_to_eye[11];
      for (int a = 0; a < 3; ++a)
      {
        depth -= index_to_eye[8 + a] * (corner >> a & 1 ? scene->box_high[a] : scene->box_low[a]);
      }
      near = depth < near ? depth : near;
      far = depth > far ? depth : far;
    }
    if (!place_cuts(scene, frame))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    box[0] = near;
    box[1] = far;
    double range[2] = { near, far };
    for (int k = 0; k < scene->clips; ++k)
    {
      narrow_depths(scene, scene->clip[k], index_to_eye, range);
    }
    near = range[0];
    far = range[1];
  }
  place_pixels(scene, camera, eye_to_index);

  /* One voxel: the depth over which the index position moves by one. */
  const double z[3] = { eye_to_index[2], eye_to_index[6], eye_to_index[10] };
  scene->voxel = 1 / sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
  if (!frame->volume)
  {
    if (!(surface_near < INFINITY))
    {
      scene->slabs = scene->volume_begin = scene->volume_end = 0;
      scene->slice = scene->slab = 1;
      scene->group = 1;
      return CHI_OK;
    }
    /* Without a volume the picture sets the scale: one light pixel at the nearest surface. */
    scene->voxel = (scene->parallel ? 1 : surface_near) / fabs(scene->pixels_x);
  }
  scene->slice = params->sample_distance > 0 ? params->sample_distance : scene->voxel;
  if (frame->volume && frame->transfer->plane)
  {
    /* Integrated along the scalar alone: the other quantity must not change much in a slice. */
    scene->slice = fmin(scene->slice, scene->voxel);
  }
  scene->slice *= params->coarsening > 0 ? params->coarsening : 1;
  const double ratio = scene->voxel / scene->slice * (1 + 1e-9);
  if (!(ratio < 0x1p24))
  {
    return CHI_ERROR_TOO_LARGE;
  }
  scene->group = ratio >= 2 ? (int64_t)ratio : 1;
  scene->slab = scene->slice * (double)scene->group;

  const double nearest = camera->near_depth;
  near = near > nearest ? near : nearest;
  const int has_samples = near < far;
  if (!has_samples)
  {
    near = far = surface_near;
  }
  else
  {
    /* Whole slabs that the planes spare: where slices lie does not depend on whether they are. */
    const double low = fmax(box[0], nearest);
    const double before = floor(fmin(fmax(near - low, 0) / scene->slab, 0x1p24));
    const double behind = floor(fmin(fmax(box[1] - far, 0) / scene->slab, 0x1p24));
    if (chi_skip_kinds(params) & CHI_SKIP_CLIPPED)
    {
      scene->clipped_slabs = (int64_t)(before + behind);
    }
    else
    {
      near -= before * scene->slab;
      far += behind * scene->slab;
    }
  }
  if (!(near < INFINITY)) /* neither a sample nor a surface in view */
  {
    scene->slabs = scene->volume_begin = scene->volume_end = 0;
    return CHI_OK;
  }
  /* Light slabs without samples reach out to the geometry, by no more than the volume's own depth
   * or the depth over which light crosses the picture sideways (or 1024 slabs): beyond, geometry in
   * front blocks at the first slab, geometry behind reads each direction at its remaining offset.
   */
  const double wide =
    (scene->light_width > scene->light_height ? scene->light_width : scene->light_height) /
    fmin(fabs(scene->pixels_x), fabs(scene->pixels_y)) * (scene->parallel ? 1 : near);
  double steepest = 1;
  for (int k = 0; k < scene->lights; ++k)
  {
    steepest = fmin(steepest, tan(scene->light[k].cone));
  }
  const double extent =
    fmin(fmax(has_samples ? far - near : 0, wide / steepest), 1024 * scene->slab);
  double front = 0, back = 0;
  if (surface_near < INFINITY)
  {
    front = near - surface_near;
    front = front < 0 ? 0 : front < extent ? front : extent;
    back = surface_far - far;
    back = back < 0 ? 0 : back < extent ? back : extent;
  }
  const double volume_slabs = ceil((far - near) / scene->slab * (1 - 1e-9));
  double front_slabs = front > 0 ? ceil(front / scene->slab) : 0;
  if (near - front_slabs * scene->slab < nearest)
  {
    front_slabs = fmax(floor((near - nearest) / scene->slab), 0); /* surfaces may lie nearer */
  }
  const double back_slabs = back > 0 ? ceil(back / scene->slab) : 0;
  const double total = volume_slabs + front_slabs + back_slabs;
  if (!(total * (double)scene->group < 0x1p24))
  {
    return CHI_ERROR_TOO_LARGE;
  }
  scene->start = near - front_slabs * scene->slab;
  scene->slabs = (int64_t)total;
  scene->volume_begin = (int64_t)front_slabs;
  scene->volume_end = (int64_t)(front_slabs + volume_slabs);
  scene->bias = (params->bias < 0 ? 1.5 * scene->voxel : params->bias) / scene->slab;
  /* Matter is taken to lie in the middle of its segment. Where a step of opacity begins at the near
   * slice it lies half a segment nearer, and less than 1.5 voxels of bias would leave rings of
   * light: so by default there is another half voxel for it, or half a segment where that is
   * longer. */
  const double lead = params->bias < 0 ? 0.5 * fmax(scene->voxel, scene->slice) : 0;
  scene->sample_bias = scene->bias + (lead - 0.5 * scene->slice) / scene->slab;
  place_zigzag(scene, 1);
  return CHI_OK;
}
