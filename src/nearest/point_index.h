// Data that queries of points need in addition to the object tree, kept from query to query.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "nearest/inside.h"
#include "scene/placed_runs.h"

namespace raysheaf {

/// Not for use by two threads at once. `version` names the triangles as they are: where it is
/// another one, the data is computed again.
class PointIndex {
 public:
  [[nodiscard]] NearestScene scene(const Executor& executor, const TriangleSource& source,
                                   const ObjectTree& tree, std::uint64_t version) {
    if (thin_version_ != version) {
      thin_version_ = 0;  // until it is whole: memory may run out
      build_thin_tree(executor, source, tree, &thin_);
      thin_version_ = version;
    }
    return {&tree, &thin_};
  }
  [[nodiscard]] Closedness closedness(const Executor& executor, const TriangleSource& source,
                                      std::uint64_t version) {
    if (closedness_version_ != version) {
      closedness_ = closedness_of(executor, source);
      closedness_version_ = version;
    }
    return closedness_;
  }
  /// Each instance has the closedness of its mesh, because equal corners are
  /// placed equally.
  [[nodiscard]] View<const Closedness> closedness(const Executor& executor,
                                                  View<const PlacedInstance> instances,
                                                  std::uint64_t version) {
    if (instances_version_ != version) {
      instances_version_ = 0;
      of_instances_.clear();
      std::map<std::uint32_t, OfMesh> meshes;
      for (const PlacedInstance& instance : instances) {
        OfMesh& mesh = meshes[instance.geom_id];
        if (mesh.shape != instance.shape) mesh = of_mesh(executor, instance);
        of_instances_.push_back(mesh.closedness);
      }
      meshes_ = std::move(meshes);
      instances_version_ = version;
    }
    return View<const Closedness>(of_instances_);
  }
  [[nodiscard]] std::size_t memory_bytes() const {
    return thin_.memory_bytes() + of_instances_.capacity() * sizeof(Closedness);
  }

 private:
  struct OfMesh {
    std::uint64_t shape = 0;
    Closedness closedness;
  };
  [[nodiscard]] OfMesh of_mesh(const Executor& executor, const PlacedInstance& mesh) const {
    const auto known = meshes_.find(mesh.geom_id);
    if (known != meshes_.end() && known->second.shape == mesh.shape) return known->second;
    const TriangleRun run{mesh.positions.data, mesh.triangles, 0, mesh.triangle_count};
    return {mesh.shape,
            closedness_of(executor, {View<const TriangleRun>(&run, 1), mesh.triangle_count})};
  }

  ObjectTree thin_;
  Closedness closedness_;
  std::map<std::uint32_t, OfMesh> meshes_;  ///< by geom_id
  std::vector<Closedness> of_instances_;
  std::uint64_t thin_version_ = 0, closedness_version_ = 0, instances_version_ = 0;  ///< 0: of none
};

}  // namespace raysheaf
