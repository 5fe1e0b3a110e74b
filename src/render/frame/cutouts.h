// Rays through what materials cut away (surface/cutout.h): leaves, fences, curtains of lace.
//
// No method looks at a texture: it finds the first hit. A ray whose hit lies where there is nothing
// goes on, as itself, from just behind that hit:
//
//   all rays ─► hits ─► those that are cut away ─► the same rays, t_min behind ─► hits ─► ...
//
// so that all methods give the same bits here, too. Of several triangles in one place, equally far,
// the first hit speaks for all.
//
// What is blended is there for some rays and not for others, by chance, as often as alpha says (E.
// Enderton, E. Sintorn, P. Shirley, D. Luebke, "Stochastic Transparency", I3D 2010): samples mix
// them. The chance is a hash of ray and triangle, so that all methods throw the same dice.
#pragma once

#include <functional>
#include <vector>

#include "exec/executor.h"
#include "render/frame/trace.h"
#include "surface/material_body.h"
#include "surface/texture.h"

namespace raysheaf {

/// As many rays of the batch as `places` has numbers, in that order.
[[nodiscard]] RayBatch part_of(const RayBatch& batch, View<const std::uint32_t> places);

class Cutouts {
 public:
  /// What is traced: first hits, whatever the batch's kind.
  using Trace = std::function<std::vector<RayHit>(const RayBatch& batch, View<float> ray_tests)>;

  /// All must outlive it. `blends`: there are several samples a pixel. O(materials).
  Cutouts(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
          bool blends);

  /// Whether the scene has any.
  [[nodiscard]] bool any() const { return any_; }

  /// The places of rays that meet their triangles where these are cut away, ascending; of those
  /// that meet none, none.
  [[nodiscard]] std::vector<std::uint32_t> cut_away(View<const Ray> rays,
                                                    View<const std::uint32_t> triangles) const;

  /// Brings the first hits of a batch to what is there. `ray_tests`: empty, or a sum a ray.
  void pass(const RayBatch& batch, const Trace& trace, View<RayHit> hits,
            View<float> ray_tests) const;

 private:
  const Executor& executor_;
  const FlatScene& scene_;
  const TextureSet& textures_;
  const bool blends_;
  std::vector<PlacedMaterial> materials_;
  bool any_ = false;
};

}  // namespace raysheaf
