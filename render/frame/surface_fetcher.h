// Surfaces of fragments, sixteen at a time: `SurfaceReader` (render/surface/surface_reader.h), bit
// for bit.
#pragma once

#include <vector>

#include "base/view.h"
#include "render/rays/fragment.h"
#include "render/surface/material_body.h"
#include "render/surface/surface_columns.h"
#include "render/surface/surface_reader.h"

namespace raysheaf {

/// A material in the form from which surfaces are computed.
struct MaterialLook {
  PlacedMaterial placed;
  Surface plain;  ///< its part of a surface that has the same colours everywhere
  bool is_plain = true;
  bool is_odd = false;  ///< needs `SurfaceReader` if there are texture coordinates
};

/// For all of the scene's materials, followed by the default material.
[[nodiscard]] std::vector<MaterialLook> material_looks(const SceneDescription& scene);

/// Where a fragment's ray hits its triangle, and the direction in which it arrives.
enum class Arrival : std::uint8_t {
  kSeen,    ///< as in `clamped_barycentrics`; along the ray's normalized direction
  kTraced,  ///< as in the ray-triangle test; along `Fragment::incoming`
};

/// Numbers for triangles that rays have met in a scene whose own numbers do not reach so far: first
/// one for each pixel, then as they come.
class MetTriangles {
 public:
  /// `pixels` must outlive this object.
  explicit MetTriangles(const std::vector<TriangleAt>& pixels) : pixels_(pixels) {}

  [[nodiscard]] std::uint32_t add(TriangleAt at) {
    later_.push_back(at);
    return static_cast<std::uint32_t>(pixels_.size() + later_.size() - 1);
  }
  [[nodiscard]] TriangleAt at(std::uint32_t number) const {
    return number < pixels_.size() ? pixels_[number] : later_[number - pixels_.size()];
  }
  /// Numbers of pixels stay.
  void clear() { later_.clear(); }

 private:
  const std::vector<TriangleAt>& pixels_;
  std::vector<TriangleAt> later_;
};

/// The source of surfaces; `looks`: of the scene's materials.
struct SurfaceSource {
  const FlatScene& scene;
  const TextureSet& textures;
  View<const MaterialLook> looks;
  const MetTriangles* met = nullptr;  ///< what numbers denote; null: the scene's numbers

  [[nodiscard]] TriangleAt at(std::uint32_t triangle) const {
    return met != nullptr ? met->at(triangle) : scene.at(triangle);
  }
};

/// Number of fragments whose surfaces are fetched together: while one waits for memory, others
/// continue.
inline constexpr std::size_t kFetchedTogether = 4 * kSurfaceLanes;

/// Not for two threads at once.
class SurfaceFetcher {
 public:
  /// Everything that the source refers to must outlive this object.
  explicit SurfaceFetcher(const SurfaceSource& source)
      : source_(source),
        scene_(source.scene),
        textures_(source.textures),
        looks_(source.looks),
        reader_(*scene_.description, textures_) {}

  /// Sets `surface` of the fragments that have a triangle, and with `kSeen` `incoming` of all; at
  /// most kFetchedTogether fragments.
  void fetch(View<const Ray> rays, Arrival arrival, View<Fragment> fragments);

 private:
  /// Fragments in columns, and sets of lanes as bits.
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

  const SurfaceSource source_;
  const FlatScene& scene_;
  const TextureSet& textures_;
  const View<const MaterialLook> looks_;
  SurfaceReader reader_;
  Block blocks_[kFetchedTogether / kSurfaceLanes];
  // The mesh of the previous lane.
  std::uint32_t mesh_number_ = kInvalidId;
  const FlatMesh* placed_ = nullptr;
  const TriangleRun* run_ = nullptr;
  InstanceCorners corners_;  ///< in place of the run, where instances stand
  const Mesh* mesh_ = nullptr;
  NormalMap map_;
};

}  // namespace raysheaf
