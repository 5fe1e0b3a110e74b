// The triangles of a frame, in memory or in blocks that stream past.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "exec/progress_meter.h"
#include "intersect/facing_body.h"
#include "raysheaf/render.h"
#include "render/rays/camera_body.h"
#include "render/rays/fragment.h"
#include "render/rays/raygen.h"

namespace raysheaf {

class Rasterizer;

/// How primary hits are found.
struct Seeing {
  const CameraFrame& frame;
  Rasterizer* rasterizer = nullptr;              ///< null: by rays
  std::function<BatchStatistics&()> statistics;  ///< of rays; called if there are any
  View<float> pixel_tests;                       ///< may be empty
  Gbuffer* gbuffer = nullptr;  ///< the rasteriser draws the paper's targets, into these
};

/// Counters for rays that find primary hits, if these are not known before.
struct FirstHitTally {
  std::function<BatchStatistics&()> statistics;  ///< called if there are rays
  bool tells_plan = true;
};

/// The surfaces that the paths of an image hit. Triangle numbers are valid only for this geometry,
/// and until the next call of `look` or `trace`. One call at a time.
class PathGeometry {
 public:
  PathGeometry() = default;
  PathGeometry(const PathGeometry&) = delete;
  PathGeometry& operator=(const PathGeometry&) = delete;
  virtual ~PathGeometry() = default;

  /// The box of all triangles.
  [[nodiscard]] virtual const Box& bounds() const = 0;
  [[nodiscard]] virtual std::uint64_t triangle_count() const = 0;
  /// The most shadow rays that are traced at once.
  [[nodiscard]] virtual std::size_t most_shadow_rays() const = 0;

  /// One fragment for each pixel of a group of the last `look`, with the surface seen there. If
  /// there is only one group, call this once, and before the next `trace`. With several groups, it
  /// may be called repeatedly: recomputing them costs less than keeping all.
  [[nodiscard]] virtual Fragments first_hits(std::size_t group, const FirstHitTally& tally) = 0;
  /// The hit of each ray of a batch. Adds to `statistics` and, if `ray_tests` is not empty, each
  /// ray's tests to it.
  [[nodiscard]] virtual std::vector<RayHit> trace(const RayBatch& batch,
                                                  BatchStatistics* statistics,
                                                  View<float> ray_tests, ProgressMeter* meter) = 0;
  /// The same for occlusion rays (`asks_occlusion`): sets occluded[i] to 1 if ray i hits anything,
  /// else 0. `early_out`: any hit suffices.
  virtual void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                             View<float> ray_tests, ProgressMeter* meter,
                             View<std::uint8_t> occluded) = 0;
  /// Computes the surfaces where rays[i] hits fragments[i].triangle, for those that have one.
  /// `incoming` is the direction in which the ray arrives.
  virtual void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) = 0;
  /// The ids of a fragment's triangle, or invalid ones.
  [[nodiscard]] virtual PixelIds ids(std::uint32_t triangle) const = 0;
};

/// Work that threads share before their rays are traced, and its plan.
struct SharedWork {
  double ms = 0;
  std::vector<std::string> plan;
};

class FrameGeometry : public virtual PathGeometry {
 public:
  /// Finds what the pixels of an image see, or leaves that to `first_hits`; returns the best number
  /// of groups to follow. Groups consist of whole `kSkyPart`s (render/shade/shade.h) of the image.
  [[nodiscard]] virtual std::size_t look(const Seeing& seeing, ProgressMeter* meter) = 0;
  /// The depth of the surface in the middle of the image, seen from the eye; if there is none, that
  /// of the scene's farthest corner.
  [[nodiscard]] virtual float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) = 0;

  /// Whether threads may follow groups of the last `look` in parallel, each with its own
  /// `of_one_thread`.
  [[nodiscard]] virtual bool is_shared() const { return false; }
  /// For shared geometry: prepares the tree for its threads' rays, before any is traced.
  [[nodiscard]] virtual SharedWork share() { return {}; }
  [[nodiscard]] virtual std::unique_ptr<PathGeometry> of_one_thread() { return nullptr; }
  /// Reports how many rays were traced through the shared tree.
  virtual void add_rays(std::uint64_t /*count*/) {}
};

}  // namespace raysheaf
