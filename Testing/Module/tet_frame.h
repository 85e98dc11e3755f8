/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef TET_FRAME_H
#define TET_FRAME_H

/* A frame of a mesh of tet_scenes.h, for tests of the renderer. */
#include "tet_scenes.h"

#include <chiaroscuro/chi_tet.h>

/* With all that the frame points at; it must not be copied. */
typedef struct scene
{
  chi_camera camera;
  chi_grid_view grid;
  chi_array_view scalars;
  chi_tet_field field;
  chi_tet_params params;
  tet_transfer transfer;
  chi_tet_frame frame;
} scene;

static inline void make_scene(scene* s, const tet_mesh* mesh, int view, int parallel, int size)
{
  s->camera = tet_view(view, parallel, size);
  s->grid = tet_mesh_grid(mesh);
  s->scalars = (chi_array_view){ mesh->scalars, mesh->point_count, 1, sizeof(float), CHI_F32 };
  s->field =
    (chi_tet_field){ .struct_size = sizeof s->field, .scalars = &s->scalars, .version = 1 };
  chi_tet_default_params(&s->params);
  tet_transfer_constant(&s->transfer, 0.3);
  s->frame = (chi_tet_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .grid = &s->grid,
    .field = &s->field,
    .transfer = &s->transfer.view,
    .params = &s->params };
}

#endif
