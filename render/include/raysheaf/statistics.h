// The statistics of a frame. Tests are counted as in the paper (Reis, Costa, Pereira 2017, tables
// 1-4).
//
// For N rays and M triangles, branching b, and levels numbered from the leaves (level 1 = nodes of
// b rays): tests at the top are those of its nodes with the candidate triangles, tests at level l
// are b times the hits of level l + 1, final ray-triangle tests b times the hits of level 1. The
// last node of a level counts as if it were full. Mesh-sphere tests are separate and in no total.
// `dual` has no levels: tests of bundles with boxes, and of rays with boxes or triangles, count 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace raysheaf {

enum class RayKind : std::uint8_t {
  kPrimary,
  kShadow,
  kReflection,
  kRefraction,
  kAmbientOcclusion,  ///< only in the laboratory
  kCount,             ///< how many there are; no kind
};
inline constexpr auto kRayKindCount = static_cast<std::size_t>(RayKind::kCount);

struct RayKindEntry {
  RayKind kind;
  const char* name;       ///< as statistics have it
  bool any_hit = false;   ///< whether something is hit is asked, not what
  bool in_order = false;  ///< neighbours are made coherent: a device needs no sort
};

/// All kinds, in the order of `RayKind`: what names and tracers are read from.
inline constexpr RayKindEntry kRayKinds[] = {
    {RayKind::kPrimary, "primary", false, true},
    {RayKind::kShadow, "shadow", true, true},
    {RayKind::kReflection, "reflection"},
    {RayKind::kRefraction, "refraction"},
    {RayKind::kAmbientOcclusion, "ambient occlusion", true},
};
static_assert(std::size(kRayKinds) == kRayKindCount, "a kind of rays has no entry");
static_assert(
    [] {
      for (std::size_t i = 0; i < kRayKindCount; ++i)
        if (kRayKinds[i].kind != static_cast<RayKind>(i)) return false;
      return true;
    }(),
    "the entries are not in the order of the kinds");

[[nodiscard]] constexpr const RayKindEntry& entry_of(RayKind kind) {
  return kRayKinds[static_cast<std::size_t>(kind)];
}
[[nodiscard]] constexpr const char* to_string(RayKind kind) {
  return entry_of(kind).name;
}

struct LevelStatistics {
  std::uint32_t level = 0;
  std::uint64_t tests = 0, hits = 0;
  [[nodiscard]] std::uint64_t misses() const { return tests - hits; }
};

struct StageTimes {
  double raygen = 0, order = 0, hierarchy = 0, traverse = 0, intersect = 0;  ///< milliseconds

  [[nodiscard]] double total() const { return raygen + order + hierarchy + traverse + intersect; }
  /// Adds a fraction `part` of another batch's times.
  void add(const StageTimes& other, double part = 1) {
    raygen += part * other.raygen;
    order += part * other.order;
    hierarchy += part * other.hierarchy;
    traverse += part * other.traverse;
    intersect += part * other.intersect;
  }
};

/// One bundle of rays as a method traces it, measured.
struct BundleSample {
  std::uint32_t level = 1;     ///< of the ray hierarchy, from the leaves
  std::uint32_t rays = 0;      ///< in the bundle
  float origin_spread = 0;     ///< the diagonal of the box of its origins, over the scene's
  float direction_spread = 0;  ///< degrees: the farthest that a ray turns away from their mean
  std::uint64_t accepted = 0;  ///< triangles that the bundle's bounding volume intersects
  std::uint64_t needed = 0;    ///< triangles whose bounding sphere a ray of the bundle intersects

  /// The number of triangles that the bounding volume accepts for each one that the tightest volume
  /// tested with spheres would: at least 1 if the volume is tested with spheres. 0 if `needed` is
  /// 0.
  [[nodiscard]] double looseness() const {
    return needed > 0 ? static_cast<double>(accepted) / static_cast<double>(needed) : 0;
  }
};

/// All rays of one kind at one bounce, over all samples. Bounces count from 1: the shadow rays of
/// the primary hits and the reflections that leave them are both at bounce 1. Traced primary rays
/// are at bounce 0.
struct BatchStatistics {
  RayKind kind = RayKind::kShadow;
  std::uint32_t bounce = 0;
  std::uint64_t rays = 0;
  std::uint64_t triangles = 0;
  std::uint64_t chunks = 0;  ///< runs of equal keys that were sorted; 0 if nothing was sorted
  std::uint64_t mesh_sphere_tests = 0;
  std::vector<LevelStatistics> levels;  ///< from the top down
  std::uint64_t bound_tests = 0;        ///< by `dual`: bundles of rays with boxes
  std::uint64_t ray_bound_tests = 0;    ///< by `dual`: rays with boxes
  std::uint64_t final_tests = 0;        ///< rays with triangles
  std::uint64_t hits = 0;               ///< rays that hit something
  StageTimes times_ms;
  std::vector<BundleSample> bundles;  ///< if `RenderOptions::bundle_samples` requests them
  /// The choices of `dual` and their reasons, one sentence each, for the first sample with such
  /// rays.
  std::vector<std::string> plan;

  [[nodiscard]] std::uint64_t total_tests() const;
  [[nodiscard]] std::uint64_t brute_force_tests() const { return rays * triangles; }
  /// total / brute force, a fraction; 0 if there was nothing to test.
  [[nodiscard]] double relative() const;
};

/// All rays of one sample of the image.
struct SampleStatistics {
  std::uint64_t rays = 0, total_tests = 0, hits = 0;
  double ms = 0;  ///< wall time, including primary visibility and shading
};

struct FrameStatistics {
  std::string scene;
  std::uint64_t triangles = 0, meshes = 0;  ///< meshes: instances, each culled on its own
  std::uint32_t width = 0, height = 0;
  std::string method, key, bound, device, primary;
  std::uint32_t threads = 0;
  std::vector<BatchStatistics> batches;              ///< summed over the samples
  std::vector<SampleStatistics> samples;             ///< each by itself, in order
  double raster_ms = 0, shade_ms = 0, total_ms = 0;  ///< `total_ms` excludes loading
};

/// The JSON that docs/statistics.md describes, indented; `load_ms` is the caller's own measurement.
[[nodiscard]] std::string to_json(const FrameStatistics& statistics, double load_ms = 0);

}  // namespace raysheaf
