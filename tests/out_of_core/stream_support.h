// Helpers for tests of streaming: the scene in memory, an exchange of hits between parts, an
// emulated device.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/query.h"
#include "raysheaf/stream.h"
#include "tests/support/device_memory.h"
#include "tests/support/guarded_memory.h"

namespace raysheaf::test {

/// The scene for the query library; instances keep their numbers.
inline Scene resident(const SceneDescription& from) {
  Scene scene;
  for (const Mesh& mesh : from.meshes) {
    MeshOptions options;
    options.place = false;
    scene.add(mesh.positions, mesh.triangles, options);
  }
  for (const Instance& instance : from.instances) scene.instance(instance.mesh, instance.to_world);
  scene.commit();
  return scene;
}

/// Combines the closest and any hits of several parts, one after the other.
class Gathered : public HitExchange {
 public:
  void closest(std::span<StreamHit> hits) override {
    hits_.resize(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (precedes(hits_[i].hit, hits[i].hit)) hits[i] = hits_[i];
      hits_[i] = hits[i];
    }
  }
  void unite(std::span<std::uint8_t> occluded) override {
    occluded_.resize(occluded.size());
    for (std::size_t i = 0; i < occluded.size(); ++i) occluded_[i] = occluded[i] |= occluded_[i];
  }

 private:
  std::vector<StreamHit> hits_;
  std::vector<std::uint8_t> occluded_;
};

/// An emulated device with the given amount of memory.
struct EmulatedMachine {
  explicit EmulatedMachine(std::uint64_t memory_bytes = std::uint64_t{1} << 40)
      : heap(memory_bytes),
        context(ContextAccess::with_backend({.device = Device::kCuda, .threads = 2},
                                            open_emulated(executor, heap, &memory))) {}

  Executor executor{2};
  test::GuardedMemory heap;
  FailingAllocator memory{heap};
  Context context;
};

/// The answers of a query on a source.
struct Said {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> occluded;

  Said(const GeometrySource& source, const std::vector<Ray>& rays, const StreamOptions& options)
      : hits(rays.size()), occluded(rays.size(), 7) {
    closest_hit(source, rays, hits, options);
    any_hit(source, rays, occluded, options);
  }
  [[nodiscard]] bool operator==(const Said& other) const {
    return hits.size() == other.hits.size() &&
           (hits.empty() ||
            std::memcmp(hits.data(), other.hits.data(), hits.size() * sizeof(Hit)) == 0) &&
           occluded == other.occluded;
  }
};

}  // namespace raysheaf::test
