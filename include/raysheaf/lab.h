// The laboratory: the ray batches of one scene, answered under any settings, and counted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/method.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/statistics.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The batches that a laboratory holds. Every surface reflects like a mirror there.
enum class LabRays : std::uint8_t {
  kShadow,            ///< from the scene's lights to the primary hits
  kReflection1,       ///< mirror rays of the primary hits
  kReflection2,       ///< mirror rays of what those met
  kAmbientOcclusion,  ///< four a primary hit, cosine-distributed, a quarter of the scene's diagonal
                      ///< long
};

/// What the published program did and a right one does not (docs/reproduction.md). The defaults are
/// those that explain its tables best. Hits are never taken from them.
struct Quirks {
  enum class ConeTest : std::uint8_t {
    kExact,     ///< distance to the cone
    kSigned,    ///< equation 9: distance to the generator's line, ahead or behind
    kUnsigned,  ///< equation 9 as printed, |C - H|: a double cone
  };
  bool hash_as_coded = true;     ///< the published layout and ranges; false: `RayKey::kCrsh`
  bool azimuth_as_coded = true;  ///< atan2(x, x), with `hash_as_coded`
  ConeTest cone_test = ConeTest::kSigned;
  bool rows_from_below = true;               ///< OpenGL's raster order
  bool undersized_triangle_spheres = false;  ///< diametral spheres that miss a vertex
  bool unrotated_mesh_spheres = false;       ///< centres moved by the translation alone
  bool padded_counting = true;               ///< missing nodes and rays count
  std::uint32_t dropped_rays = 0;  ///< left out at the start: nodes then hold other rays. Not the
                                   ///< program's: it shows how far a few rays move the counts
};

/// What bounds some rays, in the world. Where there are a hull and a cone, both do.
struct BundleVolume {
  std::uint64_t ray_count = 0;
  /// The convex hull of two boxes, as far as it lies in a third.
  bool has_hull = false;
  Box origins, ends, within;
  /// Origins in a ball, directions in a cone, hits no farther from their origin than `reach`, which
  /// may be infinite.
  bool has_cone = false;
  Vec3 center, axis;
  float radius = 0, sin_angle = 0;  ///< of the cone's half angle; above 1: directions of all kinds
  float reach = 0;
};

/// Rays that a method takes together.
struct RayBundle {
  std::vector<Ray> rays;
  std::size_t ray = 0;                ///< which of them was asked for
  std::vector<BundleVolume> volumes;  ///< of these rays, then of ever more around them
  std::string what;                   ///< in words, as "8 of 64 rays"
};

class Laboratory {
 public:
  /// Finds the primary hits of the scene's first camera, by OpenGL or, where there is none, by
  /// rays. A camera and a light are added where there are none. The scene is copied. Throws `Error`
  /// as `render` does.
  Laboratory(const SceneDescription& scene, std::uint32_t width, std::uint32_t height,
             std::uint32_t threads = 0);
  ~Laboratory();
  Laboratory(Laboratory&&) noexcept;
  Laboratory& operator=(Laboratory&&) noexcept;

  [[nodiscard]] std::uint64_t ray_count(LabRays rays);
  /// A batch as it is made: rows of pixels from the top, one light or occlusion sample after the
  /// other, each ray as `docs/raygen.md` says.
  [[nodiscard]] std::vector<Ray> rays(LabRays rays);
  /// Counts and times. Throws `Error`: kInternal where a hit differs from brute force's, which is
  /// measured once a batch; `check` = false leaves that out. kInvalidArgument for settings out of
  /// their range.
  [[nodiscard]] BatchStatistics measure(LabRays rays, const MethodSettings& settings,
                                        bool check = true);
  /// The bundle that holds the first ray of pixel (x, y), and what bounds it; none where the pixel
  /// has no ray in the batch. `brute` bundles nothing, and `dual` bounds nothing where it streams
  /// rays: there is no volume then. Throws `Error` (kInvalidArgument) for a pixel that is outside,
  /// and for settings out of their range.
  [[nodiscard]] std::optional<RayBundle> bundle(LabRays rays, const MethodSettings& settings,
                                                std::uint32_t x, std::uint32_t y);
  /// Counts of the published program's algorithm. Final tests are counted, not executed; `hits`
  /// stays 0. `levels` from 1 to 32, `branching` from 2. Throws `Error` (kInvalidArgument) for
  /// others, and for other methods than `rah` and `crsh`.
  [[nodiscard]] BatchStatistics measure_as_published(LabRays rays, Method method,
                                                     const Quirks& quirks, std::uint32_t levels = 2,
                                                     std::uint32_t branching = 8);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
