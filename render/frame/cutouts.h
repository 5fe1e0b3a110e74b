// Rays that pass through the holes of materials (scene/cutout.h), such as leaves, fences and
// lace.
//
// Methods do not read textures: they find the closest hit. A ray whose hit lies in a hole continues
// unchanged, from just behind that hit:
//
//   all rays ─► hits ─► those in holes ─► the same rays, t_min behind ─► hits ─► ...
//
// Therefore all methods give the same bits here, too. If several triangles are equally far at one
// point, the first hit decides for all of them.
//
// A blended surface exists for some rays and not for others, at random with probability alpha (E.
// Enderton, E. Sintorn, P. Shirley, D. Luebke, "Stochastic Transparency", I3D 2010): the average
// over samples blends them. The random number is a hash of ray and triangle, so that it is the same
// for all methods.
#pragma once

#include <functional>
#include <vector>

#include "exec/executor.h"
#include "render/frame/surface_fetcher.h"
#include "render/frame/trace.h"
#include "render/surface/material_body.h"

namespace raysheaf {

/// The rays of the batch that `places` names, in that order.
[[nodiscard]] RayBatch part_of(const RayBatch& batch, View<const std::uint32_t> places);

class Cutouts {
 public:
  /// Traces the closest hits of any kind of batch.
  using Trace = std::function<std::vector<RayHit>(const RayBatch& batch, View<float> ray_tests)>;

  /// All must outlive this object. `blends`: there are several samples per pixel. O(materials).
  Cutouts(const Executor& executor, const SurfaceSource& source, bool blends);

  /// Whether the scene has any material with holes.
  [[nodiscard]] bool any() const { return any_; }

  /// The places of rays that hit their triangles in holes, ascending; rays without a triangle are
  /// not included.
  [[nodiscard]] std::vector<std::uint32_t> cut_away(View<const Ray> rays,
                                                    View<const std::uint32_t> triangles) const;

  /// Replaces the closest hits of a batch that lie in holes by the next hits behind them.
  /// `ray_tests`: empty, or a sum for each ray.
  void pass(const RayBatch& batch, const Trace& trace, View<RayHit> hits,
            View<float> ray_tests) const;

 private:
  const Executor& executor_;
  const SurfaceSource source_;
  const bool blends_;
  std::vector<PlacedMaterial> materials_;
  bool any_ = false;
};

}  // namespace raysheaf
