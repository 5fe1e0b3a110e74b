// The laboratory answers the ray batches of one scene with any settings, and measures them.
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

/// The batches of a laboratory, in which every surface reflects like a mirror.
enum class LabRays : std::uint8_t {
  kShadow,       ///< from the scene's lights to the primary hits
  kReflection1,  ///< mirror rays of the primary hits
  kReflection2,  ///< mirror rays of the hits of kReflection1
  /// Four for each primary hit, cosine-distributed, as long as a quarter of the scene's diagonal.
  kAmbientOcclusion,
};

/// Errors of the published program that change its counts (docs/results/reproduction.md). The
/// defaults are those that explain its tables best. They never change hits.
struct Quirks {
  enum class ConeTest : std::uint8_t {
    kExact,     ///< distance to the cone
    kSigned,    ///< equation 9: distance to the generator's line, in front or behind
    kUnsigned,  ///< equation 9 as printed, |C - H|: a double cone
  };
  bool hash_as_coded = true;     ///< the published layout and ranges; false: `RayKey::kCrsh`
  bool azimuth_as_coded = true;  ///< atan2(x, x), with `hash_as_coded`
  ConeTest cone_test = ConeTest::kSigned;
  bool rows_from_below = true;               ///< OpenGL's raster order
  bool undersized_triangle_spheres = false;  ///< diametral spheres that miss a vertex
  bool unrotated_mesh_spheres = false;       ///< centres moved only by the translation
  bool padded_counting = true;               ///< missing nodes and rays count
  /// Rays omitted at the start, so that nodes hold different rays. Not an error of the program: it
  /// shows how much a few rays change the counts.
  std::uint32_t dropped_rays = 0;
};

/// A bounding volume of some rays, in world space: the intersection of hull and cone if it has
/// both.
struct BundleVolume {
  std::uint64_t ray_count = 0;
  /// The convex hull of two boxes, intersected with a third.
  bool has_hull = false;
  Box origins, ends, within;
  /// Origins in a sphere, directions in a cone, hits at most `reach` from their origins; `reach`
  /// may be infinite.
  bool has_cone = false;
  Vec3 center, axis;
  float radius = 0, sin_angle = 0;  ///< sine of the cone's half angle; above 1: any direction
  float reach = 0;
};

/// Rays that a method processes together.
struct RayBundle {
  std::vector<Ray> rays;
  std::size_t ray = 0;  ///< the index of the requested ray in the bundle
  /// Of these rays, then of larger and larger sets that contain them.
  std::vector<BundleVolume> volumes;
  std::string what;  ///< a description, such as "8 of 64 rays"
};

class Laboratory {
 public:
  /// Finds the primary hits of the scene's first camera with OpenGL, or by rays if OpenGL is not
  /// available. Copies the scene, and adds a camera and a light if it has none. Throws `Error` as
  /// `render` does.
  Laboratory(const SceneDescription& scene, std::uint32_t width, std::uint32_t height,
             std::uint32_t threads = 0);
  ~Laboratory();
  Laboratory(Laboratory&&) noexcept;
  Laboratory& operator=(Laboratory&&) noexcept;

  [[nodiscard]] std::uint64_t ray_count(LabRays rays);
  /// A batch in the order in which it is generated: rows of pixels from the top, one light or
  /// occlusion sample after the other, each ray as in docs/raygen.md.
  [[nodiscard]] std::vector<Ray> rays(LabRays rays);
  /// Measures counts and times. With `check`, compares hits with brute force, which is measured
  /// once for each batch. Throws `Error`: kInternal if a hit differs, kInvalidArgument for settings
  /// out of range.
  [[nodiscard]] BatchStatistics measure(LabRays rays, const MethodSettings& settings,
                                        bool check = true);
  /// The bundle that contains the first ray of pixel (x, y), and its bounding volumes; none if the
  /// pixel has no ray in the batch. Returns no volumes for `brute`, which has no bundles, and for
  /// `dual` when it streams rays. Throws `Error` (kInvalidArgument) for a pixel outside the image
  /// and for settings out of range.
  [[nodiscard]] std::optional<RayBundle> bundle(LabRays rays, const MethodSettings& settings,
                                                std::uint32_t x, std::uint32_t y);
  /// Counts of the published program's algorithm. Final tests are counted, not executed; `hits`
  /// stays 0. `levels` from 1 to 32, `branching` from 2. Throws `Error` (kInvalidArgument) for
  /// other values, and for methods other than `rah` and `crsh`.
  [[nodiscard]] BatchStatistics measure_as_published(LabRays rays, Method method,
                                                     const Quirks& quirks, std::uint32_t levels = 2,
                                                     std::uint32_t branching = 8);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
