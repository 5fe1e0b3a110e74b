// The triangles of a frame, wherever they are: in memory, or in blocks that stream past.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "exec/progress_meter.h"
#include "intersect/facing_body.h"
#include "rays/camera_body.h"
#include "rays/fragment.h"
#include "rays/raygen.h"
#include "raysheaf/render.h"

namespace raysheaf {

class Rasterizer;

/// How the first hits are found.
struct Seeing {
  const CameraFrame& frame;
  Rasterizer* rasterizer = nullptr;              ///< null: by rays
  std::function<BatchStatistics&()> statistics;  ///< of rays; called where there are any
  View<float> pixel_tests;                       ///< may be empty
};

/// Who counts rays that find first hits, where they are not found before.
struct FirstHitTally {
  std::function<BatchStatistics&()> statistics;  ///< called where there are rays
  bool tells_plan = true;
};

/// What the paths of a picture meet. Triangles have numbers, which mean something to their geometry
/// alone, and until the next call of `look` or `trace`. One call at a time.
class PathGeometry {
 public:
  PathGeometry() = default;
  PathGeometry(const PathGeometry&) = delete;
  PathGeometry& operator=(const PathGeometry&) = delete;
  virtual ~PathGeometry() = default;

  /// Of all triangles.
  [[nodiscard]] virtual const Box& bounds() const = 0;
  [[nodiscard]] virtual std::uint64_t triangle_count() const = 0;
  /// Shadow rays that are traced at once.
  [[nodiscard]] virtual std::size_t most_shadow_rays() const = 0;

  /// One fragment a pixel of a group of the last `look`, with the surface that is seen there. The
  /// only group is given away once, and before the next `trace`; others as often as they are asked
  /// for: to make them again costs less than to keep them all.
  [[nodiscard]] virtual Fragments first_hits(std::size_t group, const FirstHitTally& tally) = 0;
  /// What each ray of a batch meets. Adds to `statistics`; where `ray_tests` is not empty, adds
  /// each ray's tests to it.
  [[nodiscard]] virtual std::vector<RayHit> trace(const RayBatch& batch,
                                                  BatchStatistics* statistics,
                                                  View<float> ray_tests, ProgressMeter* meter) = 0;
  /// The same of rays that ask for occlusion (`asks_occlusion`): occluded[i] = 1 where ray i meets
  /// anything, else 0. `early_out`: the first hit will do.
  virtual void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                             View<float> ray_tests, ProgressMeter* meter,
                             View<std::uint8_t> occluded) = 0;
  /// The surfaces where rays[i] meets fragments[i].triangle, for those that have one. What arrives
  /// runs along `incoming`.
  virtual void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) = 0;
  /// The names of a fragment's triangle, or none.
  [[nodiscard]] virtual PixelIds ids(std::uint32_t triangle) const = 0;
};

/// What threads share before their rays are traced, and why it is as it is.
struct SharedWork {
  double ms = 0;
  std::vector<std::string> plan;
};

class FrameGeometry : public virtual PathGeometry {
 public:
  /// Finds what the pixels of a picture see, or leaves that to `first_hits`; returns in how many
  /// groups they are best followed. Of whole `kSkyPart`s (render/shade/shade.h) of the picture.
  [[nodiscard]] virtual std::size_t look(const Seeing& seeing, ProgressMeter* meter) = 0;
  /// The depth of what the middle of the picture shows, seen from the eye; where that is nothing,
  /// of the scene's farthest corner.
  [[nodiscard]] virtual float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) = 0;

  /// Whether threads may follow groups of the last `look` side by side, each by an `of_one_thread`
  /// of its own.
  [[nodiscard]] virtual bool is_shared() const { return false; }
  /// Of a shared one: brings up to date what its threads' rays go through, before any is traced.
  [[nodiscard]] virtual SharedWork share() { return {}; }
  [[nodiscard]] virtual std::unique_ptr<PathGeometry> of_one_thread() { return nullptr; }
  /// So many rays have met what was shared.
  virtual void add_rays(std::uint64_t /*count*/) {}
};

}  // namespace raysheaf
