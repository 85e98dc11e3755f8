// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiProjectedTetrahedraMapper
 * @brief   draw a mesh of any cells as a volume, exactly: sorted, split and integrated per pixel
 *
 * The mesh is split into tetrahedra, once; these are sorted by visibility, and at every pixel the
 * part of the ray inside each of them is found from the planes of its faces and integrated, so that
 * neither the view nor the shape of a cell matters: perspective, slivers and cells that reach
 * behind the eye are drawn as they are.
 *
 * Set it as the mapper of a vtkVolume, as any volume mapper; no render pass needs to be set.
 *
 * <b>Input.</b> Any vtkDataSet. Of a vtkUnstructuredGrid: tetrahedra, voxels, hexahedra, wedges,
 * pyramids, pentagonal and hexagonal prisms, quadratic cells (every node is a corner of linear
 * ones) and polyhedra; vertices, lines and faces are left out and counted, as are cells of other
 * types, with a warning. Of vtkImageData (with direction matrix), vtkRectilinearGrid,
 * vtkStructuredGrid and vtkExplicitStructuredGrid: all cells. Faces that two cells share are split
 * alike. Duplicate (ghost), hidden and blanked cells (vtkGhostType, vtkUniformGrid) are left out
 * and counted. Composite data are an error: vtkMergeBlocks makes one mesh of them. GetInput() is
 * null unless the input is unstructured; GetDataSetInput() always is the input.
 *
 * <b>Scalars</b> of every VTK type, of points (linear inside each tetrahedron) or of cells
 * (constant), chosen by SetScalarMode and SelectScalarArray. Of several independent components the
 * first is drawn, or what SetVectorMode says; of two dependent ones
 * (vtkVolumeProperty::IndependentComponents off) the first has the colour, the second the opacity,
 * as vtkProjectedTetrahedraMapper has it; of four the first three are the colour, 0 to 255 in
 * unsigned char and 0 to 1 in every other type, as there (beyond, they are cut), linear inside each
 * tetrahedron, and the fourth goes through the scalar opacity, as vtkVolumeProperty and the mappers
 * of images have it; vtkProjectedTetrahedraMapper takes it for the opacity itself, which an opacity
 * function from (0, 0) to (255, 1), or (1, 1), does here. SetOpacityArrayName gives opacity an
 * array of its own, in place of a second or fourth component.
 *
 * <b>Of the vtkVolumeProperty</b> the colour function (RGB or gray), the scalar opacity and its
 * unit distance are read, those of the first component. Opacity means what it means to
 * vtkProjectedTetrahedraMapper, see SetOpacityConvention. With shading on, the renderer's lights
 * shine on the gradient, which is one vector a tetrahedron (values of cells have none), by the
 * formula of vtkGPUVolumeRayCastMapper. The interpolation type means nothing to a mesh. Gradient
 * opacity is left out, with a warning.
 *
 * <b>Opaque geometry</b> of the same renderer, before, behind or inside the mesh, ends the rays
 * where it stands: its depth is drawn once more into a private buffer, one sample a pixel, where
 * it, the camera or the size have changed. Multisampling of the window smooths the geometry, and
 * its edges against the mesh only where the mesh is behind.
 *
 * <b>Translucent geometry</b> is drawn by VTK: before the mesh, which then lies over all of it, or,
 * where the renderer peels volumes (vtkRenderer::UseDepthPeelingForVolumes), after it, and over it.
 * That is named in a warning, once.
 *
 * <b>Several volumes.</b> Those drawn by this mapper and by vtkChiCombinedOcclusionVolumeMapper are
 * composited in the order of their boxes' depth at each pixel, whatever the order in which they
 * were added; where the boxes overlap, the one that the ray enters first is taken to lie in front.
 * Other mappers' volumes are drawn in the order of insertion. Where
 * vtkChiCombinedOcclusionVolumeMapper draws geometry multisampled, its volumes must be added first.
 *
 * <b>Selection.</b> Hardware selection and the pickers that rest on it find the input's cells, see
 * SetPickingOpacity; of points, the one of the found cell that is nearest.
 *
 * <b>Bad input</b> is named once for each cause, by class, array and reason: no scalars, an array
 * that is too short, a broken mesh (with the cell), too many cells for the memory (with an
 * estimate) are errors and draw nothing; an empty mesh, or one without cells of volume, is a
 * warning; cells with points or scalars that are NaN or infinite are left out, counted and warned
 * of.
 *
 * Source: Shirley and Tuchman, "A polygonal approximation to direct scalar volume rendering", 1990;
 * Williams, "Visibility ordering meshed polyhedra", 1992; Moreland and Angel, "A fast high accuracy
 * volume renderer for unstructured data", 2004; the numerics are those of chi_tet.h.
 *
 * @sa vtkVolume vtkVolumeProperty vtkProjectedTetrahedraMapper
 * vtkUnstructuredGridVolumeRayCastMapper
 */

#ifndef vtkChiProjectedTetrahedraMapper_h
#define vtkChiProjectedTetrahedraMapper_h

#include "vtkChiRenderingModule.h" // for export macro
#include "vtkUnstructuredGridVolumeMapper.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkChiTransferFunction2D;
class vtkImageData;

class VTKCHIRENDERING_EXPORT vtkChiProjectedTetrahedraMapper
  : public vtkUnstructuredGridVolumeMapper
{
public:
  static vtkChiProjectedTetrahedraMapper* New();
  vtkTypeMacro(vtkChiProjectedTetrahedraMapper, vtkUnstructuredGridVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  // The flags of chi_tet.h, chi_tet_order.h and chi_preintegration.h.
  enum VisibilityOrders
  {
    ORDER_AUTO = 0,
    ORDER_CENTROID = 1,
    ORDER_TANGENTIAL = 2,
    ORDER_MPVO = 3,
    ORDER_XMPVO = 4
  };
  enum PreIntegrations
  {
    PREINTEGRATION_AUTO = 0,
    PREINTEGRATION_NONE = 1,
    PREINTEGRATION_PARTIAL = 2,
    PREINTEGRATION_FULL = 3
  };
  enum OpacityConventions
  {
    OPACITY_LINEAR = 0,
    OPACITY_IMAGE = 1
  };
  enum Projections
  {
    PROJECTION_EXACT = 0,
    PROJECTION_PUBLISHED = 1
  };
  enum OcclusionResolutions
  {
    FULL = 0,
    HALF = 1
  };
  enum SkippingKinds
  {
    SKIP_TRANSPARENT = 2, // tetrahedra whose opacity is 0 over their range of scalars
    SKIP_OUTSIDE = 4,     // tetrahedra outside of the window
    SKIP_CLIPPED = 8,     // tetrahedra beyond a clipping plane
    SKIP_HIDDEN = 16,     // tetrahedra behind the opaque geometry of all pixels of their tiles
    SKIP_SATURATED = 32,  // tetrahedra behind tiles that let no light through any more
    SKIP_UNCOVERED = 64,  // tetrahedra that cover no pixel's centre
    SKIP_UNCHANGED = 128, // stages whose sources have not changed since the frame before
    SKIP_EVERY_KIND = 254
  };
  enum Engines
  {
    ENGINE_AUTO = 0,
    ENGINE_CPU = 1,
    ENGINE_OPENGL = 2
  };
  // Those of vtkSmartVolumeMapper.
  enum VectorModes
  {
    DISABLED = -1,
    MAGNITUDE = 0,
    COMPONENT = 1
  };

  using Superclass::SetInputData;
  /**
   * The mesh: any vtkDataSet.
   */
  void SetInputData(vtkDataSet* input) override;

  ///@{
  /**
   * What is drawn of scalars of several independent components: the first (disabled, the default),
   * the magnitude of all, or VectorComponent, 0 to 63 (of fewer, the last).
   */
  vtkSetClampMacro(VectorMode, int, DISABLED, COMPONENT);
  vtkGetMacro(VectorMode, int);
  void SetVectorModeToDisabled() { this->SetVectorMode(DISABLED); }
  void SetVectorModeToMagnitude() { this->SetVectorMode(MAGNITUDE); }
  void SetVectorModeToComponent() { this->SetVectorMode(COMPONENT); }
  vtkSetClampMacro(VectorComponent, int, 0, 63);
  vtkGetMacro(VectorComponent, int);
  ///@}

  ///@{
  /**
   * Name of the array that the opacity function is read at, of the points or cells that the scalars
   * are of; its first component. None, the default, stands for the scalars. An array that is not
   * there is an error, and nothing is drawn.
   */
  vtkSetStringMacro(OpacityArrayName);
  vtkGetStringMacro(OpacityArrayName);
  ///@}

  ///@{
  /**
   * Colour and opacity over two quantities, in place of all transfer functions of
   * vtkVolumeProperty, whose unit distance holds. Null, the default: vtkVolumeProperty's, which may
   * be two-dimensional too (TF_2D). Full pre-integration, as auto, cuts the part of a ray within a
   * cell into parts along both axes; partial takes it as linear.
   */
  void SetTransferFunction2D(vtkChiTransferFunction2D* function);
  vtkChiTransferFunction2D* GetTransferFunction2D();
  ///@}

  ///@{
  /**
   * The array along the y axis of a two-dimensional transfer function, of the points or cells that
   * the scalars are of; its first component. None, the default, stands for the magnitude of the
   * gradient, one a tetrahedron, in units of the scalar a mean cell's edge: the cube root of the
   * mean volume of a cell of the input, in its own coordinates.
   */
  vtkSetStringMacro(Transfer2DYAxisArray);
  vtkGetStringMacro(Transfer2DYAxisArray);
  ///@}

  ///@{
  /**
   * How the tetrahedra are sorted: by the distance of their centroids, as VTK does; by the
   * tangential (power) distance to their circumspheres (Max, Hanrahan and Crawfis 1990), exact for
   * Delaunay meshes; by their faces' neighbours, for convex meshes (MPVO, Williams 1992), and for
   * meshes with holes and concavities (XMPVO, Silva, Mitchell and Williams 1998). Auto, the
   * default, is exact wherever there is an order without cycles; GetNumberOfCycles says where there
   * is none.
   */
  vtkSetClampMacro(VisibilityOrder, int, ORDER_AUTO, ORDER_XMPVO);
  vtkGetMacro(VisibilityOrder, int);
  void SetVisibilityOrderToAuto() { this->SetVisibilityOrder(ORDER_AUTO); }
  void SetVisibilityOrderToCentroid() { this->SetVisibilityOrder(ORDER_CENTROID); }
  void SetVisibilityOrderToTangential() { this->SetVisibilityOrder(ORDER_TANGENTIAL); }
  void SetVisibilityOrderToMPVO() { this->SetVisibilityOrder(ORDER_MPVO); }
  void SetVisibilityOrderToXMPVO() { this->SetVisibilityOrder(ORDER_XMPVO); }
  ///@}

  ///@{
  /**
   * What is known of the transfer function between the two ends of a ray's part in a tetrahedron:
   * nothing but the middle (none); colour and opacity at both ends, linear between them (partial,
   * Moreland and Angel 2004); all of it, by a table of three dimensions (full, Engel, Kraus and
   * Ertl 2001). Auto, the default, takes partial where that is good enough, else full.
   */
  vtkSetClampMacro(PreIntegration, int, PREINTEGRATION_AUTO, PREINTEGRATION_FULL);
  vtkGetMacro(PreIntegration, int);
  void SetPreIntegrationToAuto() { this->SetPreIntegration(PREINTEGRATION_AUTO); }
  void SetPreIntegrationToNone() { this->SetPreIntegration(PREINTEGRATION_NONE); }
  void SetPreIntegrationToPartial() { this->SetPreIntegration(PREINTEGRATION_PARTIAL); }
  void SetPreIntegrationToFull() { this->SetPreIntegration(PREINTEGRATION_FULL); }
  ///@}

  ///@{
  /**
   * Where the ends of a ray's part in a tetrahedron come from. Exact, the default: from the planes
   * of its faces, at every pixel. Published, to compare with: from the triangles about the point
   * where it is thickest (Shirley and Tuchman 1990), over which thickness and scalars are linear,
   * which in perspective they are not; by the CPU engine alone, five times slower. What the near
   * plane, a clipping plane or opaque geometry cuts is drawn exactly even so. Selection and
   * GetNumberOfOrderViolations are exact in any case.
   */
  vtkSetClampMacro(Projection, int, PROJECTION_EXACT, PROJECTION_PUBLISHED);
  vtkGetMacro(Projection, int);
  void SetProjectionToExact() { this->SetProjection(PROJECTION_EXACT); }
  void SetProjectionToPublished() { this->SetProjection(PROJECTION_PUBLISHED); }
  ///@}

  ///@{
  /**
   * In pixels that are touched by a tetrahedron at most two pixels wide and high, draw of all
   * tetrahedra the mean over the pixel's area in place of what the ray of its centre meets: nothing
   * is too small to be seen, optical depths are kept, and edges there are smooth. By the CPU engine
   * alone, in 2 to 5 microseconds a small tetrahedron; frames without small ones take as long as
   * ever. Maximum intensity, the published projection, occlusion and transfer functions of two
   * quantities do without, as does selection. Default off.
   */
  vtkSetMacro(SubpixelSplatting, bool);
  vtkGetMacro(SubpixelSplatting, bool);
  vtkBooleanMacro(SubpixelSplatting, bool);
  ///@}

  ///@{
  /**
   * What an opacity a of vtkVolumeProperty means over its unit distance u. Linear, the default, as
   * to vtkProjectedTetrahedraMapper: extinction a / u a length, so that a path of u has the opacity
   * 1 - exp(-a). Image, as to VTK's mappers of images: extinction -ln(1 - min(a, 1 - 1e-6)) / u, so
   * that a path of u has the opacity a.
   */
  vtkSetClampMacro(OpacityConvention, int, OPACITY_LINEAR, OPACITY_IMAGE);
  vtkGetMacro(OpacityConvention, int);
  void SetOpacityConventionToLinear() { this->SetOpacityConvention(OPACITY_LINEAR); }
  void SetOpacityConventionToImage() { this->SetOpacityConvention(OPACITY_IMAGE); }
  ///@}

  ///@{
  /**
   * In place of the property's unit distance take the cube root of the mesh's volume a cell, in
   * world units, so that opacities look alike whatever the size of the data. Default off.
   */
  vtkSetMacro(AutomaticUnitDistance, bool);
  vtkGetMacro(AutomaticUnitDistance, bool);
  vtkBooleanMacro(AutomaticUnitDistance, bool);
  ///@}

  /**
   * The unit distance that the last frame was drawn with, world units; 0 before the first.
   */
  double GetUsedUnitDistance();

  ///@{
  /**
   * How much of the darkening by occlusion is applied: 0, the default, is none, and costs nothing;
   * 1 the full darkening. Matter is as bright as the part of a cone of light about the direction to
   * the eye that gets to it past the mesh in front (Schott et al. 2009), colours lit by lights and
   * highlights likewise. Opaque geometry in front takes light too, what the eye does not see behind
   * it takes none. The CPU engine draws it; maximum intensity has none.
   */
  vtkSetClampMacro(OcclusionStrength, double, 0.0, 1.0);
  vtkGetMacro(OcclusionStrength, double);
  ///@}

  ///@{
  /**
   * Half angle of the cone of light, in degrees, 1 to 85. A wide cone gives soft, far-reaching
   * darkening, a narrow one hard shadows straight behind things. Default 45.
   */
  vtkSetClampMacro(ConeAngle, double, 1.0, 85.0);
  vtkGetMacro(ConeAngle, double);
  ///@}

  ///@{
  /**
   * Number of directions, of equal solid angle, that the cone is cut into, 4 to 64. The error
   * falls, and the time of the light rises, about in proportion. Default 16.
   */
  vtkSetClampMacro(NumberOfDirections, int, 4, 64);
  vtkGetMacro(NumberOfDirections, int);
  ///@}

  ///@{
  /**
   * Slabs, across the line of sight, that the depths of what is drawn are cut into, 1 to 4096: in
   * each the light takes one step. Default 128. More of them cost time in proportion, fewer make
   * darkening coarse once a slab is thicker than a cell.
   */
  vtkSetClampMacro(NumberOfOcclusionSlabs, int, 1, 4096);
  vtkGetMacro(NumberOfOcclusionSlabs, int);
  ///@}

  ///@{
  /**
   * Visibility is read this much nearer to the eye than the matter, in world units, and by no less
   * than 1.5 slabs; without it an opaque surface shadows itself to half its brightness. Negative
   * values, the default being -1, and 0 stand for twice the cube root of the mesh's volume a cell.
   */
  vtkSetMacro(OcclusionBias, double);
  vtkGetMacro(OcclusionBias, double);
  ///@}

  ///@{
  /**
   * Light planes at full resolution, or, the default, at half: a quarter of the time and memory of
   * the light, soft darkening hardly differs.
   */
  vtkSetClampMacro(OcclusionResolution, int, FULL, HALF);
  vtkGetMacro(OcclusionResolution, int);
  void SetOcclusionResolutionToFull() { this->SetOcclusionResolution(FULL); }
  void SetOcclusionResolutionToHalf() { this->SetOcclusionResolution(HALF); }
  ///@}

  ///@{
  /**
   * Hardware selection (vtkHardwareSelector, vtkPropPicker) finds the input's cell in which the
   * opacity accumulated along the ray passes this, or, where it never does, the one that adds most
   * to the pixel, if that is more than 1/255; at the depth where the ray enters it. 0.001 to 0.99;
   * default 0.5.
   */
  vtkSetClampMacro(PickingOpacity, double, 0.001, 0.99);
  vtkGetMacro(PickingOpacity, double);
  ///@}

  ///@{
  /**
   * Which engine draws: the CPU engine, or the OpenGL engine (OpenGL 3.2, on the graphics card),
   * which draws the same order and makes the same picture within 1/255 in the mean. Its planes are
   * floats: thickness is within 2e-5 of a cell's longest edge where edges are up to 1 : 1000, and
   * within 2e-3 up to 1 : 1e5. Auto, the default, takes the OpenGL engine, unless OpenGL itself is
   * drawn in software. Where the OpenGL engine cannot draw, as meshes beyond the largest texture,
   * the CPU engine does; asked for explicitly, that is a warning, once for each cause. It does not
   * skip saturated tiles, and keeps no fragments.
   */
  vtkSetClampMacro(Engine, int, ENGINE_AUTO, ENGINE_OPENGL);
  vtkGetMacro(Engine, int);
  void SetEngineToAuto() { this->SetEngine(ENGINE_AUTO); }
  void SetEngineToCPU() { this->SetEngine(ENGINE_CPU); }
  void SetEngineToOpenGL() { this->SetEngine(ENGINE_OPENGL); }
  ///@}

  ///@{
  /**
   * The engine that drew the last frame, ENGINE_CPU or ENGINE_OPENGL (ENGINE_AUTO before the first
   * one), and why, to be read by people.
   */
  int GetEngineInUse();
  const char* GetEngineReason();
  ///@}

  ///@{
  /**
   * Add a fixed pattern of 8 x 8 pixels (Bayer 1973), within half a step of 8 bits, where the float
   * picture is drawn into the frame buffer, so that slow changes of brightness show no bands.
   * Default off. GetFloatImage is not touched by it.
   */
  vtkSetMacro(Dither, bool);
  vtkGetMacro(Dither, bool);
  vtkBooleanMacro(Dither, bool);
  ///@}

  ///@{
  /**
   * Pixels of the picture a pixel drawn, along both axes, 1 to 8; more than one is enlarged
   * bilinearly. Default 1. Cells are never left out.
   */
  vtkSetClampMacro(ImageReduction, int, 1, 8);
  vtkGetMacro(ImageReduction, int);
  ///@}

  ///@{
  /**
   * Raise the image reduction while a frame would take longer than what vtkVolume has been allotted
   * (vtkRenderWindow::SetDesiredUpdateRate), as interactors ask for. Default on.
   */
  vtkSetMacro(AutoAdjustQuality, bool);
  vtkGetMacro(AutoAdjustQuality, bool);
  vtkBooleanMacro(AutoAdjustQuality, bool);
  ///@}

  /**
   * The image reduction that the last frame was drawn with.
   */
  int GetUsedImageReduction();

  ///@{
  /**
   * Megabytes (2^20 bytes) that may be kept of what rays meet, 10 bytes for each pair of a
   * tetrahedron and a pixel: while only the transfer function changes and the view stands, the
   * third and later frames are drawn from it, about twice as fast, scalars rounded to 1/65535 of
   * their range. 0 to 65536; default 0: none. Shaded frames, maximum intensity and an opacity array
   * do without.
   */
  vtkSetClampMacro(FragmentCacheLimit, int, 0, 65536);
  vtkGetMacro(FragmentCacheLimit, int);
  ///@}

  ///@{
  /**
   * Leave out work that cannot change the picture by more than 1/255. Default on; the switch is
   * there to prove that it changes nothing.
   */
  vtkSetMacro(Skipping, bool);
  vtkGetMacro(Skipping, bool);
  vtkBooleanMacro(Skipping, bool);
  ///@}

  ///@{
  /**
   * The kinds of work that Skipping leaves out, a sum of SKIP_...: to turn single ones off. Default
   * SKIP_EVERY_KIND.
   */
  vtkSetClampMacro(SkippingMask, int, 0, SKIP_EVERY_KIND);
  vtkGetMacro(SkippingMask, int);
  ///@}

  /**
   * What one kind (SKIP_...) left out of the last frame: tetrahedra; pairs of a tetrahedron and a
   * tile for SKIP_SATURATED; stages for SKIP_UNCHANGED. 0 for anything else.
   */
  vtkIdType GetNumberOfSkipped(int kind);

  /**
   * Copy the last frame of this mapper into `image`: point scalars "RGBA", four floats a pixel,
   * premultiplied colour and alpha of the mesh alone, in front of the opaque geometry, before any
   * rounding to 8 bits. Pixel (0, 0, 0) is the lower left of the viewport. Returns false, with an
   * empty image, where nothing has been drawn.
   */
  bool GetFloatImage(vtkImageData* image);

  ///@{
  /**
   * Of the input's cells in the last frame: tetrahedra that they were split into, flat ones
   * included; of these those of zero volume; and cells that were left out: duplicates on other
   * processes; hidden or blanked ones; vertices, lines, faces and empty ones; cells of types that
   * are not split; cells with points, and tetrahedra with scalars, that are NaN or infinite.
   */
  vtkIdType GetNumberOfTetrahedra();
  vtkIdType GetNumberOfFlatTetrahedra();
  vtkIdType GetNumberOfGhostCells();
  vtkIdType GetNumberOfBlankedCells();
  vtkIdType GetNumberOfLowerDimensionalCells();
  vtkIdType GetNumberOfUnsupportedCells();
  vtkIdType GetNumberOfNonFiniteCells();
  vtkIdType GetNumberOfNonFiniteTetrahedra();
  ///@}

  ///@{
  /**
   * Work of the last frame: pairs of a tetrahedron and a tile of 64 x 64 pixels; pairs of a
   * tetrahedron and a pixel.
   */
  vtkIdType GetNumberOfDrawnTetrahedra();
  vtkIdType GetNumberOfFragments();
  ///@}

  /**
   * Of the drawn tetrahedra those that the published projection has left to the exact one.
   */
  vtkIdType GetNumberOfExactTetrahedra();

  /**
   * Of the drawn tetrahedra those that are small enough for SubpixelSplatting; 0 where it is off.
   */
  vtkIdType GetNumberOfSplattedTetrahedra();

  ///@{
  /**
   * The order (ORDER_..., never auto) and the pre-integration that the last frame was drawn with,
   * and the cycles of visibility that were broken in it.
   */
  int GetUsedVisibilityOrder();
  int GetUsedPreIntegration();
  vtkIdType GetNumberOfCycles();
  ///@}

  /**
   * Count, now, the pairs of tetrahedra in the last frame that follow each other on the ray of a
   * pixel, lie apart by more than 1e-9 of the extent, and were drawn in the wrong order. All pixels
   * are looked at, slowly. -1 where nothing has been drawn.
   */
  vtkIdType GetNumberOfOrderViolations();

  ///@{
  /**
   * Wall-clock seconds of the last frame, stage by stage: looking at inputs and transfer functions;
   * drawing opaque geometry into the private buffer; reading its depth back; splitting cells;
   * fetching scalars; sorting; finding the tiles of each tetrahedron; the pixels; of these the
   * light of occlusion; all of the engine; drawing the result into the frame buffer; everything.
   */
  double GetSecondsCollect();
  double GetSecondsGeometry();
  double GetSecondsReadBack();
  double GetSecondsSplit();
  double GetSecondsScalars();
  double GetSecondsOrder();
  double GetSecondsTiles();
  double GetSecondsDraw();
  double GetSecondsLight();
  double GetSecondsEngine();
  double GetSecondsComposite();
  double GetSecondsTotal();
  ///@}

  ///@{
  /**
   * Bytes beyond the input: of the mesh and its order, kept from frame to frame; of the frame; of
   * the picture; of the kept fragments; of the light planes of occlusion.
   */
  vtkIdType GetMeshBytes();
  vtkIdType GetFrameBytes();
  vtkIdType GetImageBytes();
  vtkIdType GetCacheBytes();
  vtkIdType GetOcclusionBytes();
  ///@}

  /**
   * Whether nothing had changed since the frame before, so that its picture was drawn again.
   */
  bool GetReusedLastFrame();

  /**
   * Bounds of the input; of its finite points where others would make them infinite.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;

  /**
   * Called by vtkVolume. Draws into the frame buffer that is bound, within the viewport that is
   * set; ids instead of colours while a selection is made.
   */
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkChiProjectedTetrahedraMapper();
  ~vtkChiProjectedTetrahedraMapper() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;

  int VectorMode = DISABLED;
  int VectorComponent = 0;
  char* OpacityArrayName = nullptr;
  char* Transfer2DYAxisArray = nullptr;
  int VisibilityOrder = ORDER_AUTO;
  int PreIntegration = PREINTEGRATION_AUTO;
  int Projection = PROJECTION_EXACT;
  bool SubpixelSplatting = false;
  int OpacityConvention = OPACITY_LINEAR;
  bool AutomaticUnitDistance = false;
  double OcclusionStrength = 0.0;
  double ConeAngle = 45.0;
  int NumberOfDirections = 16;
  int NumberOfOcclusionSlabs = 128;
  double OcclusionBias = -1.0;
  int OcclusionResolution = HALF;
  double PickingOpacity = 0.5;
  int Engine = ENGINE_AUTO;
  bool Dither = false;
  int ImageReduction = 1;
  bool AutoAdjustQuality = true;
  int FragmentCacheLimit = 0;
  bool Skipping = true;
  int SkippingMask = SKIP_EVERY_KIND;

private:
  vtkChiProjectedTetrahedraMapper(const vtkChiProjectedTetrahedraMapper&) = delete;
  void operator=(const vtkChiProjectedTetrahedraMapper&) = delete;

  // The five steps of a frame, in their order.
  bool Collect(vtkRenderer* renderer, vtkVolume* volume);
  void Surface(vtkRenderer* renderer);
  bool RenderEngine();
  void Composite(vtkRenderer* renderer, vtkVolume* volume);
  void RenderSelection(vtkRenderer* renderer, vtkVolume* volume);
  void Report();

  vtkDataSet* CollectInput();
  bool CollectMatrix(vtkVolume* volume);
  void CollectParameters(vtkRenderer* renderer, vtkVolume* volume);
  void ReportTranslucent(vtkRenderer* renderer);
  void ReportFailure(int status);
  void SayOnce(const std::string& what, bool isError = false);

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
