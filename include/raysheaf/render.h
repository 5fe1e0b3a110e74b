// The renderer: a scene description in, a picture and its statistics out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/method.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/statistics.h"
#include "raysheaf/types.h"

namespace raysheaf {

enum class Primary : std::uint8_t {
  kRaster,  ///< OpenGL 4.5 through EGL; by rays where a lens needs them
  kTrace,   ///< rays, by the same method as all others
};

struct RenderResult;

/// How far a frame is. `done` and `total` count the stage's own work items; after
/// "scene", a frame of several samples has one stage, "samples"; one whose picture is followed in
/// parts has "parts" once its first hits are found.
struct Progress {
  std::string_view stage;
  std::uint64_t done = 0, total = 0;
};

struct RenderOptions {
  /// 1 to 16384 each; or both 0: as `default_size` (raysheaf/cameras.h) has it of the camera.
  std::uint32_t width = 512, height = 512;
  std::string camera;  ///< a name or an index; empty: the first
  Method method = Method::kDual;
  Primary primary = Primary::kRaster;
  std::uint32_t bounces = 2;  ///< reflections and refractions in a row, 0 to 32
  // For `rah` and `crsh`, the first two for `gl10` too; `brute` and `dual` use none of them. Unset:
  // the method's own. None of them changes the picture, only the counts and the time.
  std::optional<RayKey> key;
  std::optional<std::uint32_t> key_bits;  ///< 32 or 64
  std::uint32_t levels = 2;               ///< of the ray hierarchy, 1 to 8
  std::uint32_t branching = 8;            ///< children a node, 2 to 64
  std::optional<BundleBound> bound;
  std::optional<bool> mesh_culling;
  std::uint32_t threads = 0;  ///< 0: all cores
  bool shadows = true, reflections = true, refractions = true;
  /// Shadow rays stop at their first hit; the paper counts without. Those of `dual` always do.
  bool early_out = false;
  /// Rays a pixel through the reconstruction filter (docs/light.md), 1 to 65536. One makes every
  /// choice in the middle: pixels' centres, lights' centres, a pinhole; two or more show lights'
  /// sizes and lenses. 0: 16 with an environment or a lens, 4 with `studio_lights`, else 1.
  std::uint32_t samples = 0;
  std::optional<float> aperture, focus;  ///< in place of the camera's own
  bool count_pixel_tests = false;        ///< fill `RenderResult::tests`
  /// How many bundles of each level are measured a batch, evenly spread over it, into
  /// `BatchStatistics::bundles`; not of `brute`, which has none, nor of `dual`. Each takes
  /// O(triangles).
  std::uint32_t bundle_samples = 0;
  std::optional<float> exposure;  ///< factor on radiance before tone mapping; none: automatic
  std::optional<Vec3> ambient;    ///< radiance of a uniform sky; none: a little, from the lights
  /// Called now and then, from one thread at a time; false asks to stop (`Error` kCancelled).
  std::function<bool(const Progress&)> progress;
  /// Called after each sample but the last with the picture so far, which is the one that as many
  /// samples give; false ends the frame there. On the caller's thread, between samples.
  std::function<bool(const RenderResult&)> on_sample;
};

/// What a pixel sees: an instance, its mesh, and a triangle of that mesh; all kInvalidId for
/// nothing.
struct PixelIds {
  std::uint32_t inst_id = kInvalidId, geom_id = kInvalidId, prim_id = kInvalidId;
};

/// Rows from the top, `width * height` entries each. Where samples differ, what can be mixed is
/// their mean, and what cannot is that of the first, through the pixel's centre.
struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0;   ///< that the picture is made of
  std::vector<Vec3> beauty;    ///< linear radiance; mean
  std::vector<Vec3> position;  ///< world; 0 where nothing is seen; of the first sample
  std::vector<Vec3> normal;    ///< shading normal, world; mean, 0 for samples that see nothing
  std::vector<Vec3> albedo;    ///< diffuse plus specular reflectance at the first hit; mean
  std::vector<Vec3> specular;  ///< the specular part of `albedo`
  std::vector<PixelIds> ids;   ///< of the first sample
  std::vector<float> shadow;   ///< the part of the lights facing the first hits that reaches them
  std::vector<float> tests;    ///< tests a pixel, over all its rays; empty unless asked for
  float exposure = 1;          ///< the factor that `tone_mapped` uses
  Vec3 ambient;                ///< the sky's radiance, given or found
  FrameStatistics statistics;
};

/// Renders one frame. The result does not depend on the number of threads, nor on the method.
/// Throws `Error`: kInvalidArgument for options, kInvalidData for the scene, kNotFound for the
/// camera, kNoGraphics where primary visibility needs OpenGL and none can be had.
[[nodiscard]] RenderResult render(const SceneDescription& scene, const RenderOptions& options = {});

/// The picture for people: exposure, the Khronos PBR Neutral tone curve (2024), sRGB.
[[nodiscard]] Image tone_mapped(const RenderResult& result);

/// sRGB of a colour scale whose lightness grows evenly from dark violet through green to light
/// yellow, so that equal steps of the value look equal, in grey too and to most colour-blind eyes.
/// `t` in [0, 1], clamped; a NaN is 0.
[[nodiscard]] std::array<std::uint8_t, 3> false_color(float t);

/// Tests a pixel in false colours with a legend under them; `result.tests` must be there.
[[nodiscard]] Image heatmap(const RenderResult& result);

}  // namespace raysheaf
