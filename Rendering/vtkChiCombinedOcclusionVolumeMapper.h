// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiCombinedOcclusionVolumeMapper
 * @brief   draw a volume that shades itself and the opaque geometry around it, and is shaded by it
 *
 * A cone of light falls from the eye, or from a little aside, along every line of sight. What
 * absorbs it, voxels and opaque geometry alike, darkens what lies behind: the volume darkens
 * itself, the volume darkens the geometry in and behind it, the geometry darkens the volume, and
 * geometry darkens geometry. The picture needs no light set up and looks alike from any camera, in
 * perspective and parallel projection.
 *
 * Set it as the mapper of a vtkVolume, as any volume mapper; opaque actors of the same renderer
 * take part without being told. The mapper draws them once more into a private buffer (colour and
 * depth; normals on request) where they, the camera or the lights have changed; no render pass
 * needs to be set, the stock pipeline stays as it is.
 *
 * <b>What is honoured.</b> Input vtkImageData (vtkRectilinearGrid is resampled, with a warning);
 * scalars of every VTK type, of points or cells, chosen with SetScalarMode and SelectScalarArray;
 * the volume's full matrix (user matrix, non-uniform scale, mirror), spacing of any sign, direction
 * matrix, extent; of the vtkVolumeProperty the colour function (RGB or gray), the scalar opacity,
 * its unit distance, gradient opacity, 2-D transfer functions, shading (with the renderer's lights,
 * by the same formula as vtkGPUVolumeRayCastMapper; occlusion takes ambient and diffuse light, not
 * highlights), nearest or linear interpolation; of the mapper up to 32 clipping planes, all
 * cropping regions and a mask, binary or of labels with transfer functions of their own; of the
 * input, blanked points and cells (vtkUniformGrid, ghost arrays): what is cut, masked or blanked
 * neither draws nor darkens. Blending is composite. Up to four independent components, each with
 * its functions and weight, and two or four dependent ones (colour and opacity; red, green, blue
 * and opacity, 8-bit or 0 to 1) are composed as vtkGPUVolumeRayCastMapper does; the opacity unit
 * distance of dependent ones is that of the last component, as there.
 *
 * <b>What is not supported yet</b> is named in a warning, once for each cause, and the picture is
 * drawn without it: shading, gradient opacity and 2-D transfer functions of several components,
 * other blend modes, cubic interpolation, sheared projections
 * (stereo in parallel projection is one).
 *
 * <b>Opaque geometry.</b> The pixels of opaque geometry are rewritten once a frame, by the first of
 * these mappers: shaded colour times visibility, under the volume. Where rewriting would lose what
 * the frame already holds (a multisampled frame buffer, FXAA, shadows, screen-space occlusion,
 * a custom render pass), and for further mappers, the pixels are darkened
 * by the visibility instead, which differs by the rounding of the frame buffer only. Highlights are
 * not darkened, but for those of physically based props.
 *
 * <b>Translucent geometry</b> of surfaces does not occlude, and receives light as opaque geometry
 * does. Its four layers nearest to the eye are blended where they lie in the volume, behind it and
 * in front of it, by depth peeling, whatever the renderer's settings of transparency; further ones
 * are counted, and named once. For this the mapper hides such props from the renderer's own drawing
 * (by a render pass in their property keys, between the renderer's start and end events). The frame
 * in which a renderer meets its first mapper is drawn twice, because hiding then comes too late;
 * where the renderer has a pass of its own or does not erase, that frame shows VTK's drawing below
 * the volume. With several volumes, layers go with the first that is drawn. Translucent props
 * whose mappers ignore render passes are left to VTK, and named once.
 *
 * <b>Interaction.</b> Frames that VTK allots less than a second are drawn as well as fits into that
 * time, the next still frame in full (AutoAdjustQuality). Brightness stays: within 0.8 % in the
 * tests. Opaque geometry is drawn in full in all of them, but without anti-aliasing where the
 * picture is smaller; translucent layers are as coarse as the volume.
 *
 * <b>Selection.</b> Hardware selection and the pickers that rest on it find the volume where it is
 * opaque enough (SelectionOpacity), at that depth, with the ids of points or cells. vtkCellPicker
 * casts its own rays through the input, as with any volume mapper.
 *
 * <b>Windows.</b> The frame buffer's alpha is that of VTK's own volume mappers: premultiplied, over
 * whatever background, layer or viewport. Each eye of a stereo pair in perspective sees the volume
 * from its own place.
 *
 * <b>Several volumes</b> in a renderer do not shade each other; each shades, and is shaded by, the
 * geometry. Disjoint volumes are composited in the order of their depth at each pixel, whatever the
 * order in which they were added; where volumes overlap, the one whose box the ray enters first is
 * taken to lie in front. Other mappers' volumes are drawn in the order of insertion, as VTK does.
 *
 * <b>Limits.</b> Geometry of other renderers does not take part, not even where a renderer keeps
 * the depths of the layer below (PreserveDepthBuffer). VTK does not draw volumes whose box lies
 * outside the view, so that a renderer whose only such volume has left the picture shows its
 * geometry unshaded. In ParaView's parallel rendering each process shades with its own part of the
 * data only.
 *
 * Source: Schott, Martin, Grosset, Smith and Hansen, "Ambient Occlusion Effects for Combined
 * Volumes and Tubular Geometry", IEEE TVCG 19(6), 2013; the numerics are those of chi_occlusion.h.
 *
 * @sa vtkVolume vtkVolumeProperty vtkGPUVolumeRayCastMapper
 */

#ifndef vtkChiCombinedOcclusionVolumeMapper_h
#define vtkChiCombinedOcclusionVolumeMapper_h

#include "vtkChiRenderingModule.h" // for export macro
#include "vtkVolumeMapper.h"

#include <memory> // for std::unique_ptr

class vtkChiTransferFunction2D;
class vtkImageData;

class VTKCHIRENDERING_EXPORT vtkChiCombinedOcclusionVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkChiCombinedOcclusionVolumeMapper* New();
  vtkTypeMacro(vtkChiCombinedOcclusionVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum OcclusionMethods
  {
    ORDINATES = 0,
    PUBLISHED = 1
  };
  enum OcclusionResolutions
  {
    FULL = 0,
    HALF = 1
  };
  enum CombineModes
  {
    COMBINE_PRODUCT = 0,
    COMBINE_MINIMUM = 1
  };
  // The flags of chi_occlusion.h.
  enum ColorIntegrations
  {
    COLOR_PREINTEGRATED = 0,
    COLOR_MIDDLE = 1
  };
  enum SkippingKinds
  {
    SKIP_EMPTY_BRICKS = 2,      // samples in bricks that the transfer function makes transparent
    SKIP_SATURATED_RAYS = 4,    // samples of rays that are opaque but for half a step of 255
    SKIP_BEHIND_GEOMETRY = 8,   // samples behind opaque geometry
    SKIP_CLIPPED = 16,          // what lies outside of clipping planes and cropping box as a whole
    SKIP_FOOTPRINT = 32,        // tiles outside of the volume's footprint
    SKIP_SATURATED_LIGHT = 64,  // light that is uniform over a tile
    SKIP_UNREACHED_LIGHT = 128, // light that nothing visible receives any more
    SKIP_UNCHANGED = 256,       // stages whose sources have not changed since the frame before
    SKIP_EVERY_KIND = 510
  };
  enum GeometryAntiAliasings
  {
    GEOMETRY_ALIASED = 0,
    GEOMETRY_MULTISAMPLE = 1,
    GEOMETRY_FXAA = 2,
    GEOMETRY_MULTISAMPLE_AND_FXAA = 3
  };
  enum Engines
  {
    ENGINE_AUTO = 0,
    ENGINE_CPU = 1,
    ENGINE_OPENGL = 2
  };
  enum LightPrecisions
  {
    SINGLE_FLOAT = 0,
    HALF_FLOAT = 1
  };

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
   * Where the light comes from, in view coordinates: x to the right, y up, z towards the eye; of
   * any length, (0, 0, 0) stands for (0, 0, 1). The default, (0, 0, 1), is the eye's side. In
   * perspective the light turns with each line of sight. Light from more than 60 degrees aside is
   * brought to 60, with a warning; what of a tilted cone comes from more than 85 degrees aside
   * comes in at 85. What lies outside the view casts no shadow into it.
   */
  vtkSetVector3Macro(LightDirection, double);
  vtkGetVector3Macro(LightDirection, double);
  ///@}

  ///@{
  /**
   * A second soft light: its direction, likewise, the half angle of its cone in degrees, 1 to 85,
   * and its part in all light, 0 (the default: there is none) to 1. It takes NumberOfDirections
   * again. Not with the published method.
   */
  vtkSetVector3Macro(SecondLightDirection, double);
  vtkGetVector3Macro(SecondLightDirection, double);
  vtkSetClampMacro(SecondLightConeAngle, double, 1.0, 85.0);
  vtkGetMacro(SecondLightConeAngle, double);
  vtkSetClampMacro(SecondLightShare, double, 0.0, 1.0);
  vtkGetMacro(SecondLightShare, double);
  ///@}

  ///@{
  /**
   * Coloured attenuation: factors, 0 to 1000, of the volume's extinction for red, green and blue
   * light. (0.5, 1, 1) lets red light twice as far through, so that what lies in the shadow of
   * tissue reddens; 0 takes a colour out of the occlusion. It holds for light, not for the lines of
   * sight. Default (1, 1, 1); each factor that differs costs light buffers of its own.
   */
  void SetAttenuationColor(double red, double green, double blue);
  void SetAttenuationColor(const double factors[3])
  {
    this->SetAttenuationColor(factors[0], factors[1], factors[2]);
  }
  vtkGetVector3Macro(AttenuationColor, double);
  ///@}

  ///@{
  /**
   * Number of directions, of equal solid angle, that the cone is cut into, 4 to 64. The error
   * falls, and the time rises, about in proportion. With the published method, the number of taps
   * of its blur. Default 16.
   */
  vtkSetClampMacro(NumberOfDirections, int, 4, 64);
  vtkGetMacro(NumberOfDirections, int);
  ///@}

  ///@{
  /**
   * Distance between the slices along the view axis, in world units. 0, the default, takes it from
   * the spacing of the input: one slice a voxel. Under a two-dimensional transfer function no more
   * than that.
   */
  vtkSetClampMacro(SampleDistance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(SampleDistance, double);
  ///@}

  ///@{
  /**
   * Colour and opacity over two quantities, in place of all transfer functions of
   * vtkVolumeProperty, whose unit distance holds; opacity is corrected for the distance of the
   * slices, and integrated along the scalar. Null, the default: vtkVolumeProperty's.
   */
  void SetTransferFunction2D(vtkChiTransferFunction2D* function);
  vtkChiTransferFunction2D* GetTransferFunction2D();
  ///@}

  ///@{
  /**
   * The array along the y axis of a two-dimensional transfer function (SetTransferFunction2D, or
   * vtkVolumeProperty::TF_2D), of the points or cells that the scalars are of; its first component
   * over its own range. None, the default, stands for the magnitude of the gradient. As in
   * vtkGPUVolumeRayCastMapper, but for the opacity, which is corrected for the distance of the
   * slices.
   */
  vtkSetStringMacro(Transfer2DYAxisArray);
  vtkGetStringMacro(Transfer2DYAxisArray);
  ///@}

  ///@{
  /**
   * How much of the darkening is applied: 0 is an unshaded ray cast of the same samples, 1, the
   * default, the full darkening.
   */
  vtkSetClampMacro(OcclusionStrength, double, 0.0, 1.0);
  vtkGetMacro(OcclusionStrength, double);
  ///@}

  ///@{
  /**
   * Visibility is read this much nearer to the eye than the sample, in world units; without it an
   * opaque surface shadows itself to half its brightness. Negative values, the default being -1,
   * stand for 1.5 voxels for geometry and, so that steps of opacity show no rings, 2 for the
   * volume.
   */
  vtkSetMacro(OcclusionBias, double);
  vtkGetMacro(OcclusionBias, double);
  ///@}

  ///@{
  /**
   * Opaque geometry blocks the light from its visible surface over this distance behind it, in
   * world units. Only the first surface along each line of sight is known, so this is how thick
   * things are taken to be. 0, the default, is one slice. Infinite thickness is the published
   * algorithm (Schott et al. 2013, algorithm 3), which gives every fibre a halo that does not fall
   * off with distance.
   */
  vtkSetClampMacro(GeometryThickness, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(GeometryThickness, double);
  void SetGeometryThicknessToInfinity() { this->SetGeometryThickness(VTK_DOUBLE_MAX); }
  ///@}

  ///@{
  /**
   * Share of the light that opaque geometry blocks, 0 to 1: over its thickness in all, or, where
   * that is infinite, in every slice behind it. Default 1. (Schott et al. 2013, algorithm 3)
   */
  vtkSetClampMacro(GeometryOpacity, double, 0.0, 1.0);
  vtkGetMacro(GeometryOpacity, double);
  ///@}

  ///@{
  /**
   * Darken geometry by the geometry around it within a few pixels too, of which the light buffers
   * are too coarse: crevices between fibres, contacts. Default on; part of GeometryToGeometry.
   * (Schott et al. 2013, section 3.2.5)
   */
  vtkSetMacro(VicinityOcclusion, bool);
  vtkGetMacro(VicinityOcclusion, bool);
  vtkBooleanMacro(VicinityOcclusion, bool);
  ///@}

  ///@{
  /**
   * Distance l of the virtual slice whose cone base, of radius l tan(ConeAngle), is the vicinity: a
   * fraction of the volume's diagonal, or, without a volume, of the diagonal of the visible props'
   * bounds. Default 0.005.
   */
  vtkSetClampMacro(VicinityDistance, double, 0.0, 1.0);
  vtkGetMacro(VicinityDistance, double);
  ///@}

  ///@{
  /**
   * A neighbour blocks light when it is nearer to the eye than the surface by more than this, world
   * units, however much nearer: the published rule, which darkens tilted surfaces and gives all
   * fibres halos. 0, the default, compares with the surface's tangent plane and leaves what is
   * farther ahead than the virtual slice to the light buffers; with the published occlusion method
   * it stands for the published rule at a tenth of the virtual slice's distance.
   */
  vtkSetClampMacro(VicinityDepthBias, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(VicinityDepthBias, double);
  ///@}

  ///@{
  /**
   * Number of neighbours that are looked at, 0 to 118. Default 32.
   */
  vtkSetClampMacro(NumberOfVicinitySamples, int, 0, 118);
  vtkGetMacro(NumberOfVicinitySamples, int);
  ///@}

  ///@{
  /**
   * How the light that the volume and far geometry leave and the one that the vicinity leaves
   * become one: their product (default, equation 8), or the smaller (equation 7), which loses the
   * vicinity's detail in the volume's shadow.
   */
  vtkSetClampMacro(CombineMode, int, COMBINE_PRODUCT, COMBINE_MINIMUM);
  vtkGetMacro(CombineMode, int);
  void SetCombineModeToProduct() { this->SetCombineMode(COMBINE_PRODUCT); }
  void SetCombineModeToMinimum() { this->SetCombineMode(COMBINE_MINIMUM); }
  ///@}

  /**
   * The settings of Schott et al. 2013: the published blur at full resolution, vicinity occlusion
   * with 81 samples by the published rule, product, infinite geometry thickness and an occlusion
   * bias of 0. Everything else stays as it is.
   */
  void ApplyPublishedPreset();

  ///@{
  /**
   * Resolution of the light buffers: that of the picture, or half of it in both directions (the
   * default), which is several times faster and at 16 directions also smoother.
   */
  vtkSetClampMacro(OcclusionResolution, int, FULL, HALF);
  vtkGetMacro(OcclusionResolution, int);
  void SetOcclusionResolutionToFull() { this->SetOcclusionResolution(FULL); }
  void SetOcclusionResolutionToHalf() { this->SetOcclusionResolution(HALF); }
  ///@}

  ///@{
  /**
   * How light is carried from slice to slice: by discrete ordinates (the default), one buffer a
   * direction, shifted by its own constant offset; or by the published rule (Schott et al. 2013),
   * one buffer blurred in each slice, for reproduction: it washes out as slices are added.
   */
  vtkSetClampMacro(OcclusionMethod, int, ORDINATES, PUBLISHED);
  vtkGetMacro(OcclusionMethod, int);
  void SetOcclusionMethodToOrdinates() { this->SetOcclusionMethod(ORDINATES); }
  void SetOcclusionMethodToPublished() { this->SetOcclusionMethod(PUBLISHED); }
  ///@}

  ///@{
  /**
   * Who darkens whom; all on by default. SetGeometryOcclusion sets the three that involve geometry.
   */
  vtkSetMacro(VolumeToVolume, bool);
  vtkGetMacro(VolumeToVolume, bool);
  vtkBooleanMacro(VolumeToVolume, bool);
  vtkSetMacro(VolumeToGeometry, bool);
  vtkGetMacro(VolumeToGeometry, bool);
  vtkBooleanMacro(VolumeToGeometry, bool);
  vtkSetMacro(GeometryToVolume, bool);
  vtkGetMacro(GeometryToVolume, bool);
  vtkBooleanMacro(GeometryToVolume, bool);
  vtkSetMacro(GeometryToGeometry, bool);
  vtkGetMacro(GeometryToGeometry, bool);
  vtkBooleanMacro(GeometryToGeometry, bool);
  void SetGeometryOcclusion(bool on);
  ///@}

  ///@{
  /**
   * Anti-aliasing of the opaque geometry's silhouettes, against volume and background alike. None,
   * the default: one sample a pixel. MultiSample: up to eight, of which each pixel keeps two
   * surfaces, the nearest and what is behind it, each with its own volume in front and light of its
   * own; all colours of geometry then come from the private buffer, and the renderer's own drawing
   * writes depth alone. FXAA: vtkOpenGLFXAAFilter, set by the renderer's vtkFXAAOptions, over all
   * that the viewport holds after the last volume; not in a frame buffer of several samples. Line
   * widths and the light that geometry blocks stay as they are.
   */
  vtkSetClampMacro(GeometryAntiAliasing, int, GEOMETRY_ALIASED, GEOMETRY_MULTISAMPLE_AND_FXAA);
  vtkGetMacro(GeometryAntiAliasing, int);
  void SetGeometryAntiAliasingToNone() { this->SetGeometryAntiAliasing(GEOMETRY_ALIASED); }
  void SetGeometryAntiAliasingToMultiSample()
  {
    this->SetGeometryAntiAliasing(GEOMETRY_MULTISAMPLE);
  }
  void SetGeometryAntiAliasingToFXAA() { this->SetGeometryAntiAliasing(GEOMETRY_FXAA); }
  void SetGeometryAntiAliasingToMultiSampleAndFXAA()
  {
    this->SetGeometryAntiAliasing(GEOMETRY_MULTISAMPLE_AND_FXAA);
  }
  ///@}

  ///@{
  /**
   * Which engine renders: the CPU engine, or the OpenGL engine (OpenGL 3.2, on the graphics card),
   * which makes the same picture within 1/255 in the mean. Auto, the default, takes the OpenGL
   * engine, unless OpenGL itself is drawn in software. Where the OpenGL engine cannot draw, as of
   * volumes and pictures beyond the largest texture, the CPU engine does; asked for explicitly,
   * that is a warning, once for each cause.
   */
  vtkSetClampMacro(Engine, int, ENGINE_AUTO, ENGINE_OPENGL);
  vtkGetMacro(Engine, int);
  void SetEngineToAuto() { this->SetEngine(ENGINE_AUTO); }
  void SetEngineToCPU() { this->SetEngine(ENGINE_CPU); }
  void SetEngineToOpenGL() { this->SetEngine(ENGINE_OPENGL); }
  ///@}

  enum
  {
    BinaryMaskType = 0,
    LabelMapMaskType = 1
  };

  ///@{
  /**
   * A mask, as vtkGPUVolumeRayCastMapper has it: an image of as many points as the input (or, where
   * scalars of cells are drawn, of as many cells or points as the input has cells), of any scalar
   * type. Each value is that of the voxel about its sample. A mask that does not fit is an error,
   * and the volume is not drawn. Default: none.
   */
  void SetMaskInput(vtkImageData* mask);
  vtkImageData* GetMaskInput();
  ///@}

  ///@{
  /**
   * Binary: what lies in voxels of values not greater than 0 neither draws nor darkens. Faces of
   * voxels are exact where slices lie up to two voxels apart. Label map, the default as in
   * vtkGPUVolumeRayCastMapper: voxels of label 0, and of labels without functions, are drawn with
   * the volume's own functions, others with those of vtkVolumeProperty::SetLabelColor and
   * SetLabelScalarOpacity, opacity over the volume's unit distance. A segment counts with the label
   * at its end.
   */
  vtkSetClampMacro(MaskType, int, BinaryMaskType, LabelMapMaskType);
  vtkGetMacro(MaskType, int);
  void SetMaskTypeToBinary() { this->SetMaskType(BinaryMaskType); }
  void SetMaskTypeToLabelMap() { this->SetMaskType(LabelMapMaskType); }
  ///@}

  ///@{
  /**
   * Share of a label's own colour and opacity, the volume's own have the rest: 0 ... 1, default 1.
   * Of label maps only.
   */
  vtkSetClampMacro(MaskBlendFactor, float, 0.0f, 1.0f);
  vtkGetMacro(MaskBlendFactor, float);
  ///@}

  ///@{
  /**
   * Colour of a ray between two slices: what the eye gets of the transfer function from the one
   * scalar to the other, nearer parts before farther ones (the default), taken where the middle's
   * colour would be wrong by more than 1/255; or always the colour of the middle scalar. Extinction
   * is integrated exactly with either.
   */
  vtkSetClampMacro(ColorIntegration, int, COLOR_PREINTEGRATED, COLOR_MIDDLE);
  vtkGetMacro(ColorIntegration, int);
  void SetColorIntegrationToPreIntegrated() { this->SetColorIntegration(COLOR_PREINTEGRATED); }
  void SetColorIntegrationToMiddle() { this->SetColorIntegration(COLOR_MIDDLE); }
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
   * The engine that drew the last frame, ENGINE_CPU or ENGINE_OPENGL (ENGINE_AUTO before the first
   * one), and why, to be read by people.
   */
  int GetEngineInUse();
  const char* GetEngineReason();
  ///@}

  /**
   * Whether a GL_RENDERER string names a rasteriser that runs in software (llvmpipe, softpipe, SWR,
   * SwiftShader, Microsoft Basic Render, Apple's software renderer...).
   */
  static bool IsSoftwareRenderer(const char* renderer);

  ///@{
  /**
   * Floats that the OpenGL engine's light buffers hold: of 32 bits (single, the default) or of 16
   * (half), which takes half the memory and bandwidth and adds an error that grows with the number
   * of slices. The CPU engine always takes single ones.
   */
  vtkSetClampMacro(LightPrecision, int, SINGLE_FLOAT, HALF_FLOAT);
  vtkGetMacro(LightPrecision, int);
  void SetLightPrecisionToSingle() { this->SetLightPrecision(SINGLE_FLOAT); }
  void SetLightPrecisionToHalf() { this->SetLightPrecision(HALF_FLOAT); }
  ///@}

  ///@{
  /**
   * Leave out work that cannot change the picture by more than 1/255: empty bricks, saturated rays,
   * what lies behind opaque geometry, light that nothing visible receives. Default on; the switch
   * is there to prove that it changes nothing.
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
   * What one kind (SKIP_...) left out of the last frame: samples; updates of light for the two of
   * light; stages for SKIP_UNCHANGED (bricks, classification, picture; 0 to 3). 0 for anything
   * else.
   */
  vtkIdType GetNumberOfSkipped(int kind);

  ///@{
  /**
   * Pixels of the viewport a pixel computed, in both directions, 1 to 4: the picture is enlarged
   * along the edges of the geometry, which itself is drawn in full. Interactive frames may take
   * more (AutoAdjustQuality). As vtkGPUVolumeRayCastMapper's ImageSampleDistance. Default 1.
   */
  vtkSetClampMacro(ImageReduction, int, 1, 4);
  vtkGetMacro(ImageReduction, int);
  ///@}

  ///@{
  /**
   * Draw what fits into the time that VTK allots (vtkProp::GetAllocatedRenderTime, from
   * vtkRenderWindow::SetDesiredUpdateRate) in interactive frames: fewer directions, wider slices, a
   * picture of half the size or less, enlarged along the edges of the geometry, which itself is
   * drawn in full. How fast this machine is is learned from frame to frame. Default on.
   */
  vtkSetMacro(AutoAdjustQuality, bool);
  vtkGetMacro(AutoAdjustQuality, bool);
  vtkBooleanMacro(AutoAdjustQuality, bool);
  ///@}

  ///@{
  /**
   * A frame is interactive when it is allotted less than 1 / InteractiveUpdateRate seconds. Default
   * 1 per second, as in VTK's mappers.
   */
  vtkSetClampMacro(InteractiveUpdateRate, double, 1.0e-10, 1.0e10);
  vtkGetMacro(InteractiveUpdateRate, double);
  ///@}

  ///@{
  /**
   * What the last frame was drawn with: directions of light; world units between slices, 0 where
   * there was no volume in view; pixels of the viewport a pixel computed, in both directions.
   */
  int GetUsedNumberOfDirections();
  double GetUsedSampleDistance();
  int GetUsedImageReduction();
  ///@}

  ///@{
  /**
   * Hardware selection (vtkHardwareSelector, vtkPropPicker) finds the volume where its accumulated
   * opacity along the ray reaches this, at the depth where it does: geometry in front of that is
   * found before the volume, geometry behind it is not. Ids are those of the points (the nearest)
   * or cells of the image that is drawn. 0.001 to 0.99; default 1/255, the least that can be seen;
   * larger values reach through haze.
   */
  vtkSetClampMacro(SelectionOpacity, double, 0.001, 0.99);
  vtkGetMacro(SelectionOpacity, double);
  ///@}

  /**
   * Copy the last frame of this mapper into `image`: point scalars "RGBA", four floats a pixel,
   * premultiplied colour and alpha, of the volume over the shaded opaque geometry, without
   * background, without other volumes and before any rounding to 8 bits. Pixel (0, 0, 0) is the
   * lower left of the viewport. Returns false, with an empty image, where nothing has been drawn.
   * The window must still exist: the colours of the geometry are read back here.
   */
  bool GetFloatImage(vtkImageData* image);

  /**
   * Copy the visibility of the opaque geometry in the last frame into `image`: point scalars
   * "Visibility", one float a pixel, under coloured attenuation three, after strength; 1 where
   * there is no geometry.
   */
  bool GetVisibilityImage(vtkImageData* image);

  /**
   * Copy what is known of the opaque geometry of the last frame into `image`, as float point
   * arrays: "RGBA", its lit colour, before any occlusion, and 1 where there is geometry, 0
   * elsewhere; "Normal", in view coordinates, drawn at this call (0 where there is no geometry, or
   * where it is unlit, so that its shader has no normal); "Depth", the distance from the eye along
   * the view axis in world units, infinite where there is no geometry. Returns false, with an empty
   * image, where there is none.
   */
  bool GetGeometryImage(vtkImageData* image);

  ///@{
  /**
   * Counters of the last frame: volume samples fetched and classified; samples inside the volume's
   * footprint that were not needed; slices; updates of light buffers carried out and left out;
   * NaN and infinite voxels, which are transparent.
   */
  vtkIdType GetNumberOfSamples();
  vtkIdType GetNumberOfSkippedSamples();
  vtkIdType GetNumberOfSlices();
  vtkIdType GetNumberOfLightUpdates();
  vtkIdType GetNumberOfSkippedLightUpdates();
  vtkIdType GetNumberOfNonFiniteSamples();
  ///@}

  /**
   * Bytes of light buffers that the last frame used: 0 where there is no occlusion.
   */
  vtkIdType GetLightBufferBytes();

  ///@{
  /**
   * Wall-clock seconds of the last frame, stage by stage: looking at inputs and transfer functions;
   * drawing opaque geometry into the private buffer; reading its depth back; min-max bricks;
   * their classification; the visible set; the slices; the whole engine; drawing the result into
   * the frame buffer; everything. OpenGL works behind the scenes: drawing that was only queued is
   * paid for in the next read-back, ours or the window's.
   */
  double GetSecondsCollect();
  double GetSecondsGeometry();
  double GetSecondsReadBack();
  double GetSecondsBricks();
  double GetSecondsClassification();
  double GetSecondsVisibleSet();
  double GetSecondsSlices();
  double GetSecondsEngine();
  double GetSecondsComposite();
  double GetSecondsTotal();
  ///@}

  ///@{
  /**
   * Whether nothing had changed since the frame before, so that its picture was drawn again; and
   * the same of the buffer of opaque geometry alone.
   */
  bool GetReusedLastFrame();
  bool GetReusedGeometry();
  ///@}

  ///@{
  /**
   * Whether the frame kept the min-max bricks of the samples, which the data alone change; and
   * their classification, which the opacity function changes as well.
   */
  bool GetReusedBricks();
  bool GetReusedClassification();
  ///@}

  /**
   * Layers of translucent geometry beyond the four that are drawn, at the pixel that has most.
   */
  int GetNumberOfDroppedLayers();

  /**
   * Instruction set that the CPU engine runs with: "avx512", "avx2" or "generic".
   */
  const char* GetInstructionSet();

  /**
   * Called by vtkVolume. Draws into the frame buffer that is bound, within the viewport that is
   * set; ids instead of colours while a selection is made.
   */
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkChiCombinedOcclusionVolumeMapper();
  ~vtkChiCombinedOcclusionVolumeMapper() override;

  double ConeAngle = 45.0;
  int MaskType = LabelMapMaskType;
  float MaskBlendFactor = 1.0f;
  double LightDirection[3] = { 0.0, 0.0, 1.0 };
  double SecondLightDirection[3] = { 0.0, 0.0, 1.0 };
  double SecondLightConeAngle = 45.0;
  double SecondLightShare = 0.0;
  double AttenuationColor[3] = { 1.0, 1.0, 1.0 };
  int NumberOfDirections = 16;
  double SampleDistance = 0.0;
  char* Transfer2DYAxisArray = nullptr;
  double OcclusionStrength = 1.0;
  double OcclusionBias = -1.0;
  double GeometryThickness = 0.0;
  double GeometryOpacity = 1.0;
  bool VicinityOcclusion = true;
  double VicinityDistance = 0.005;
  double VicinityDepthBias = 0.0;
  int NumberOfVicinitySamples = 32;
  int CombineMode = COMBINE_PRODUCT;
  int OcclusionResolution = HALF;
  int OcclusionMethod = ORDINATES;
  int Engine = ENGINE_AUTO;
  int LightPrecision = SINGLE_FLOAT;
  bool VolumeToVolume = true;
  bool VolumeToGeometry = true;
  bool GeometryToVolume = true;
  bool GeometryToGeometry = true;
  int GeometryAntiAliasing = GEOMETRY_ALIASED;
  int ColorIntegration = COLOR_PREINTEGRATED;
  bool Dither = false;
  bool Skipping = true;
  int SkippingMask = SKIP_EVERY_KIND;
  int ImageReduction = 1;
  bool AutoAdjustQuality = true;
  double InteractiveUpdateRate = 1.0;
  double SelectionOpacity = 1.0 / 255.0;

private:
  vtkChiCombinedOcclusionVolumeMapper(const vtkChiCombinedOcclusionVolumeMapper&) = delete;
  void operator=(const vtkChiCombinedOcclusionVolumeMapper&) = delete;

  // The five steps of a frame, in their order.
  bool Collect(vtkRenderer* renderer, vtkVolume* volume);
  void Surface(vtkRenderer* renderer);
  bool RenderEngine();
  void Composite(vtkRenderer* renderer, vtkVolume* volume);
  void RenderSelection(vtkRenderer* renderer, vtkVolume* volume);
  void Report();

  void CollectMasks(vtkVolume* volume);
  void CollectUnsupported(vtkVolume* volume);
  void CollectParameters();
  void CollectQuality(double seconds);
  bool PrepareEngine();
  void SayOnce(const char* what, bool isError = false);

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
