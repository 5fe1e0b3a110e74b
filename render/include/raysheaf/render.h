// The renderer: computes an image and its statistics from a scene description.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/cameras.h"
#include "raysheaf/context.h"
#include "raysheaf/method.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/statistics.h"
#include "raysheaf/stream.h"
#include "raysheaf/types.h"

namespace raysheaf {

enum class Primary : std::uint8_t {
  kRaster,  ///< OpenGL 4.5 through EGL; by rays if a lens needs them
  kTrace,   ///< by rays, with the same method as all other rays
};

struct RenderResult;

/// A ground that catches the scene's shadow: a plane square to `up`, seen from above, of which only
/// the shadow is visible. It hides nothing, and neither mirrors nor glass show it.
struct Ground {
  UpAxis up = UpAxis::kY;
  std::optional<float> height;  ///< along `up`; none: that of the scene's lowest point
};

/// With the method of all rays; none of its settings changes the image.
struct RenderOptions : MethodChoice {
  /// 1 to 16384 each, or both 0: `default_size` of the camera (raysheaf/cameras.h).
  std::uint32_t width = 512, height = 512;
  std::string camera;  ///< a name or an index; empty: the first
  Primary primary = Primary::kRaster;
  std::uint32_t bounces = 2;  ///< reflections and refractions in sequence, 0 to 32
  std::uint32_t threads = 0;  ///< 0: all cores
  bool shadows = true, reflections = true, refractions = true;
  /// Shadow rays stop at the first hit that they find; the paper counts without this. Shadow rays
  /// of `dual` always do.
  bool early_out = false;
  /// Rays per pixel through the reconstruction filter (docs/light.md), 1 to 65536. With one, every
  /// sampled quantity takes its central value: pixel centres, light centres, a pinhole; two or more
  /// show the lights' sizes and lenses. 0: 16 with an environment or a lens, 4 with
  /// `studio_lights`, else 1.
  std::uint32_t samples = 0;
  std::optional<float> aperture, focus;  ///< in place of the camera's own
  std::optional<Ground> ground;          ///< where the scene casts a shadow; none: nowhere
  /// OpenGL draws the paper's four targets, into `RenderResult::gbuffer`, in place of triangles'
  /// numbers. Requires `kRaster` and no lens. The picture is the same.
  bool gbuffer = false;
  bool count_pixel_tests = false;  ///< fill `RenderResult::tests`
  /// How many bundles of each level are measured a batch, evenly spread over it, into
  /// `BatchStatistics::bundles`; not of `brute`, which has none, nor of `dual`. Each takes
  /// O(triangles).
  std::uint32_t bundle_samples = 0;
  std::optional<float> exposure;  ///< factor on radiance before tone mapping; none: automatic
  /// Radiance of a uniform sky; none: a small value from the lights.
  std::optional<Vec3> ambient;
  /// With `studio_lights`, mirrors, metals and glass show soft boxes where these come from
  /// (docs/light.md); false: the uniform sky.
  bool soft_boxes = true;
  /// Called repeatedly, from one thread at a time; false requests to stop (`Error` kCancelled).
  /// After "scene", a frame of several samples has one stage, "samples"; a frame whose rays are
  /// traced part by part has the stage "parts" after primary visibility.
  std::function<bool(const Progress&)> progress;
  /// Called after each sample except the last, with the image so far, which equals a rendering with
  /// that many samples except for the shadow on `ground`, which comes last; false ends the frame.
  /// Runs on the caller's thread, between samples.
  std::function<bool(const RenderResult&)> on_sample;
};

/// The object that a pixel sees: an instance, its mesh, and a triangle of that mesh; all kInvalidId
/// if the ray hits nothing.
struct PixelIds {
  std::uint32_t inst_id = kInvalidId, geom_id = kInvalidId, prim_id = kInvalidId;
};

/// The paper's four targets of binary32, as OpenGL's rasteriser made them of the first sample: four
/// floats a pixel, rows from the top. Where edges pass, OpenGL's pixel may be another triangle's
/// than the picture's, which is exact (docs/raster.md).
struct Gbuffer {
  std::vector<Vec4> position;  ///< world; `w` is -1 where nothing is seen, else the renderer's own
  std::vector<Vec4> normal;    ///< unit shading normal, world; `w` is the renderer's own
  std::vector<Vec4> diffuse;   ///< reflectance, interpolated between corners; `w`: 1, 0 for nothing
  std::vector<Vec4> specular;  ///< the same of the reflectance along the normal
};

/// Rows from the top, `width * height` entries each. Values that can be averaged over samples are
/// means; the others are those of the first sample, through the pixel's centre.
struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0;   ///< number of samples in the image
  std::vector<Vec3> beauty;    ///< linear radiance; mean
  std::vector<Vec3> position;  ///< world space; 0 if nothing is seen; of the first sample
  /// Shading normal, world space; mean, 0 for samples that see nothing.
  std::vector<Vec3> normal;
  std::vector<Vec3> albedo;    ///< diffuse plus specular reflectance at the primary hit; mean
  std::vector<Vec3> specular;  ///< the specular part of `albedo`
  std::vector<PixelIds> ids;   ///< of the first sample
  std::vector<float> shadow;   ///< the part of the light that reaches the visible points facing it
  std::vector<float> tests;    ///< tests a pixel, over all its rays; empty unless asked for
  /// The part of the pixel that the shadow on the ground takes from the background, which `beauty`
  /// shows darker by it; mean. Empty unless asked for.
  std::vector<float> ground;
  Gbuffer gbuffer;     ///< empty unless asked for
  float exposure = 1;  ///< the factor that `tone_mapped` uses
  Vec3 ambient;        ///< the sky's radiance, given or automatic
  FrameStatistics statistics;
};

/// Renders one frame. The result does not depend on the number of threads or on the method. Throws
/// `Error`: kInvalidArgument for options, kInvalidData for the scene, kNotFound for the camera,
/// kNoGraphics if primary visibility needs OpenGL and OpenGL is not available.
[[nodiscard]] RenderResult render(const SceneDescription& scene, const RenderOptions& options = {});

/// The image for display: exposure, the Khronos PBR Neutral tone curve (2024), sRGB.
[[nodiscard]] Image tone_mapped(const RenderResult& result);

/// A colour scale in sRGB whose lightness increases evenly from dark violet through green to light
/// yellow: equal steps of the value look equal, also in grey and with most kinds of colour
/// blindness. `t` in [0, 1], clamped; NaN counts as 0.
[[nodiscard]] std::array<std::uint8_t, 3> false_color(float t);

/// Tests per pixel in false colours with a legend below; needs `result.tests`.
[[nodiscard]] Image heatmap(const RenderResult& result);

/// Renders the same image as `render(scene, options)`; ignores `options.threads`. With
/// Device::kCuda the device renders everything after primary visibility (docs/cuda.md). Throws
/// `Error` as that function, and kUnsupported for features that the device does not support.
[[nodiscard]] RenderResult render(const Context& context, const SceneDescription& scene,
                                  const RenderOptions& options = {});

/// Returns the frame of `render` of the whole scene with `Primary::kTrace`, the same bits except
/// for `tests`. Supports only `Method::kDual` and `Primary::kTrace` (`Error` kUnsupported). Throws
/// `Error` as `render` and as the queries above.
[[nodiscard]] RenderResult render(const GeometrySource& source, const RenderOptions& options,
                                  const StreamOptions& stream = {});

}  // namespace raysheaf
