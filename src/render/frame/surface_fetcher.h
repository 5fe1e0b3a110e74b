// Surfaces of fragments, sixteen at a time: `SurfaceReader` (surface/surface_reader.h), bit for
// bit.
#pragma once

#include <vector>

#include "base/view.h"
#include "rays/fragment.h"
#include "surface/material_body.h"
#include "surface/surface_columns.h"
#include "surface/surface_reader.h"

namespace raysheaf {

/// A material as surfaces are made from it.
struct MaterialLook {
  PlacedMaterial placed;
  Surface plain;  ///< its part of a surface that has the same colours everywhere
  bool is_plain = true;
  bool is_odd = false;  ///< for `SurfaceReader`, where there are coordinates
};

/// Of all of the scene's, and last of the default material.
[[nodiscard]] std::vector<MaterialLook> material_looks(const SceneDescription& scene);

/// Where a fragment's ray meets its triangle, and how it arrives.
enum class Arrival : std::uint8_t {
  kSeen,    ///< as `clamped_barycentrics` has it; along the ray's direction, made a unit
  kTraced,  ///< as the ray-triangle test has it; along `Fragment::incoming`
};

/// Where surfaces come from; `looks`: of the scene's materials.
struct SurfaceSource {
  const FlatScene& scene;
  const TextureSet& textures;
  View<const MaterialLook> looks;
};

/// Fragments whose surfaces are fetched together: while one waits for memory, others go on.
inline constexpr std::size_t kFetchedTogether = 4 * kSurfaceLanes;

/// Not for use by two threads at once.
class SurfaceFetcher {
 public:
  /// What the source names must outlive it.
  explicit SurfaceFetcher(const SurfaceSource& source)
      : scene_(source.scene),
        textures_(source.textures),
        looks_(source.looks),
        reader_(*scene_.description, textures_) {}

  /// Of fragments that have a triangle, `surface`, and with `kSeen` of all `incoming`; at most
  /// kFetchedTogether of them.
  void fetch(View<const Ray> rays, Arrival arrival, View<Fragment> fragments);

 private:
  /// Fragments in columns, and what is known of each lane, a bit each.
  struct Block {
    SurfaceColumns columns{};
    View<const Ray> rays;
    View<Fragment> fragments;
    LaneBits used = 0, mirrored = 0, textured = 0, front = 0;
    LaneBits odd = 0;  ///< for the reader
    InstanceLanes instances[kSurfaceLanes];
    std::size_t instance_count = 0;
    const MaterialLook* look[kSurfaceLanes] = {};
    TextureColors colors[kSurfaceLanes];
  };

  void prefetch(View<const Fragment> fragments) const;
  void gather(Arrival arrival, Block* block);
  void gather_triangle(std::uint32_t triangle, std::size_t lane, Block* block);
  void hold_mesh(std::uint32_t mesh);
  void settle_incoming(Block* block);
  void settle_weights(Arrival arrival, Block* block);
  void place(Block* block);
  void color(Block* block);
  void give(Block* block);

  const FlatScene& scene_;
  const TextureSet& textures_;
  const View<const MaterialLook> looks_;
  SurfaceReader reader_;
  Block blocks_[kFetchedTogether / kSurfaceLanes];
  // The mesh of the lane before.
  std::uint32_t mesh_number_ = kInvalidId;
  const FlatMesh* placed_ = nullptr;
  const Mesh* mesh_ = nullptr;
  NormalMap map_;
};

}  // namespace raysheaf
