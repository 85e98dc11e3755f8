/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_KERNELS_H
#define CHI_TET_KERNELS_H

/* The inner loops that draw tetrahedra, once per instruction set; chosen at load. */

#include <chiaroscuro/chi_preintegration.h>

#include <stddef.h>
#include <stdint.h>

enum
{
  CHI_TET_TILE = 64, /* pixels a side: 64 KB of floats, half of a second cache's share */
  CHI_TET_TILE_SHIFT = 6,
  CHI_TET_TILE_PIXELS = CHI_TET_TILE * CHI_TET_TILE,
  CHI_TET_CUTS = 32,      /* clip planes */
  CHI_TET_PLANE_STEP = 2, /* entries of a table of two quantities that a part of a segment may cross
                             either way: colour and extinction are taken as linear in it */
  CHI_TET_PLANE_PARTS = 64, /* of a segment at most */
  CHI_TET_QUANTITIES = 5,   /* that may be linear in a tetrahedron: scalar, the opacity's, */
  CHI_TET_COLORS = 2        /* and from here direct colours */
};

/* World units. Tetrahedra with a vertex that is farther from the eye along an axis are left out:
 * what pixels evaluate are floats, whose range squares of lengths have to stay within. */
#define CHI_TET_FAR 1e18

/* A point in the eye's space: x to the right, y up, z the depth along the view axis. */
typedef struct chi_tet_point
{
  double x, y, z;
  float scalar, opacity; /* what colour and opacity are looked up at */
} chi_tet_point;

/* What all tiles of a frame share. */
typedef struct chi_tet_scene
{
  const chi_tet_point* points;
  const uint32_t* vertices;    /* [tetrahedra x 4] */
  const uint32_t* cells;       /* [tetrahedra] index into values of cells; NULL: the identity */
  const float* cell_scalars;   /* values of cells in place of those of points; NULL */
  const float* cell_opacities; /* likewise */
  const float* seconds;        /* [tetrahedra] in place of opacities; NULL */
  double first[2], step[2];    /* of pixel centres: at depth 1 in perspective, else world units */
  double near_depth;
  int32_t width, height;
  int32_t parallel;
  int32_t separate;     /* opacity is looked up at `opacity` */
  const double* planes; /* [plane_count x 4] in the eye's space: a x + b y + c z + d >= 0 stays */
  size_t plane_count;
  const float* depth; /* [height x width] of the surface; NULL: none */

  float base, scale, end;       /* table position = (scalar - base) * scale, 0 ... end */
  float base_y, scale_y, end_y; /* the opacity's, or the second quantity's */
  const float (*plane)[4];      /* [plane_rows][count + 1]: a table of two quantities; NULL */
  int32_t plane_rows;
  const chi_segment_tables* tables;
  int32_t fine;             /* neighbouring entries are so much alike that the nearest will do */
  const float* extinction;  /* [count + 1] of the tables, one after the other */
  const float (*shades)[6]; /* [tetrahedra] factor of the colour, and what is added; NULL */
  float color_limit;        /* of shaded colours */
  int32_t maximum;          /* 1: maximum intensity: opacity is that of a path of */
  float maximum_of_unit;    /* so much length, by the convention: */
  int32_t image_opacity;    /* 1: 1 - exp(-extinction x length), 0: extinction x length */
  const float (*colors)[3]; /* direct ones of points, or of cells as cell_scalars; NULL */
  int32_t limited;          /* 1: no more is drawn than what lies between these depths: */
  float limits[2];
  float knot; /* share of the way between them where light has a knot */
} chi_tet_scene;

typedef struct chi_tet_tally
{
  int64_t tetrahedra, flat, delicate, fragments, saturated, left, splatted;
} chi_tet_tally;

/* Fragments of a tile, front to back, as they are kept from frame to frame. */
typedef struct chi_tet_cached
{
  uint16_t* pixel;     /* of the tile */
  uint16_t (*ends)[2]; /* places of both scalars in the table, 0 ... 65535 */
  float* length;       /* world units */
  size_t count;
} chi_tet_cached;

/* A tetrahedron at a pixel, found by other means than the planes of its faces. */
typedef struct chi_tet_fragment
{
  int32_t pixel;                      /* of the tile */
  float length;                       /* along the view axis */
  float value[CHI_TET_QUANTITIES][2]; /* where the ray enters and leaves */
} chi_tet_fragment;

/* Takes them, in the order of visibility, to their pixels. */
typedef struct chi_tet_sink chi_tet_sink;
struct chi_tet_sink
{
  void (*put)(chi_tet_sink* sink, uint32_t tetrahedron, const chi_tet_fragment* fragment);
  void (*settle)(chi_tet_sink* sink); /* all that was given before is in its pixel then */
};

/* What a projector leaves of a tetrahedron to be drawn by its planes. */
enum
{
  CHI_TET_REST_NONE,
  CHI_TET_REST_UNMARKED, /* its pixels that are not marked */
  CHI_TET_REST_ALL
};

/* Other means. */
typedef struct chi_tet_projector chi_tet_projector;
struct chi_tet_projector
{
  /* One tetrahedron at the pixels of the tile whose first is `tile`; CHI_TET_REST_... */
  int (*draw)(chi_tet_projector* projector, const chi_tet_scene* scene, uint32_t tetrahedron,
    const int32_t tile[2], chi_tet_sink* sink);
  const uint8_t* marked; /* [CHI_TET_TILE_PIXELS]; or NULL */
  int64_t left;          /* tetrahedra that it has left to their planes */
};

/* Where the fragments of a tile go. */
typedef struct chi_tet_target
{
  float* rgba; /* [CHI_TET_TILE_PIXELS x 4] premultiplied colour and transmittance; of maximum
                  intensity x is the table position of the largest scalar, -1: none, y the
                  opacity's, or y, z, w the direct colour there */
  float stop;  /* drawing ends where no transmittance is larger; 0: never */
  chi_tet_cached* cached; /* also here, `count` of them so far; NULL: nowhere */
  /* What light leaves of colours, of the tile's first pixel: at the knot, and what it would be a
   * slab before and behind; NULL: all */
  const float* light[3];
  size_t light_stride;          /* floats from row to row */
  chi_tet_projector* projector; /* where they come from first; NULL: planes alone */
  /* picking: */
  float* pick_alpha; /* or NULL */
  uint32_t* pick;
  float* pick_depth;
  float pick_opacity;
} chi_tet_target;

/* One row of a tile, drawn between limits, as a layer behind what is in the picture. */
typedef struct chi_tet_slab_row
{
  const float* layer; /* [CHI_TET_TILE x 4] premultiplied colour, transmittance */
  int count;          /* of the tile's pixels, inside of the picture */
  float* rgba;        /* [count x 4] the picture, likewise */
  float* tau;         /* [CHI_TET_TILE] optical thickness along the view axis; 0 outside */
  float slope, slope_x, square; /* a unit of depth is sqrt(square + (slope + x slope_x)^2) long */
  float opaque;                 /* transmittances that are not larger count as none */
} chi_tet_slab_row;

/* Where a window's pixels, and tetrahedra on them, are. */
typedef struct chi_tet_window
{
  const float (*screen)[2]; /* points, pixels; NaN in front of the near plane, and too far off */
  const uint32_t* vertices;
  int32_t width, height;
  int32_t any_beyond; /* a point is NaN */
  int32_t parallel;
  const chi_tet_point* points;
  double first[2], step[2], near_depth; /* as of the scene; for what is NaN */
  float margin; /* a pixel counts as covered if its centre is so near to the box, pixels */
} chi_tet_window;

enum
{
  CHI_TET_OUTSIDE = 0x000000ff,  /* ranges of tetrahedra that lie outside of the window, */
  CHI_TET_UNCOVERED = 0x000001ff /* or cover no pixel's centre: first tile 255, last tile 0 */
};

typedef struct chi_tet_kernels
{
  /* Tiles of tetrahedra begin ... end - 1: first and last one, x and y, a byte each. */
  void (*ranges)(const chi_tet_window* window, size_t begin, size_t end, uint32_t* ranges);
  /* Front to back: `list` lists the tile's tetrahedra (low halves) from the last to the first. */
  void (*draw)(const chi_tet_scene* scene, const uint64_t* list, size_t count, int32_t tile_x,
    int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally);
  /* The same from what has been kept of it, under other colours. */
  void (*draw_cached)(const chi_tet_scene* scene, chi_tet_target* target, chi_tet_tally* tally);
  /* Non-zero: some pixel still lets light through. */
  int (*merge)(const chi_tet_slab_row* row);
} chi_tet_kernels;

extern const chi_tet_kernels chi_tet_kernels_generic;
#if defined(__x86_64__)
extern const chi_tet_kernels chi_tet_kernels_avx2;
extern const chi_tet_kernels chi_tet_kernels_avx512;
#endif

/* Those of this machine. */
const chi_tet_kernels* chi_tet_get_kernels(void);

#endif
