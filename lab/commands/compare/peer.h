// The peer of `bench compare`: Embree 4 and Embree 3, each with its best settings. Both are loaded
// at run time, if they are installed (compare/embree_library.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lab/commands/compare/words.h"
#include "raysheaf/types.h"

namespace raysheaf::app {

/// A mesh in world space. The four bytes after the last position are readable.
struct MeshView {
  std::span<const Vec3> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// How the peer builds: an index into `peer_builds`.
struct PeerBuild {
  std::string name;
  std::uint32_t index = 0;
};

/// How the peer is queried: an index that only its own device understands.
struct PeerCall {
  std::string name;
  std::uint32_t index = 0;
};

/// The builds that may be the fastest in a mode. A measurement decides which one is.
[[nodiscard]] std::vector<PeerBuild> peer_builds(CompareMode mode);

struct EmbreeLibrary;

/// A device of one of the versions, with its threads.
class PeerDevice {
 public:
  /// Throws `Error` if the library has no device, or is neither Embree 3 nor 4.
  PeerDevice(const EmbreeLibrary& library, std::uint32_t threads);
  ~PeerDevice();
  PeerDevice(const PeerDevice&) = delete;
  PeerDevice& operator=(const PeerDevice&) = delete;

  /// "4.4.0"
  [[nodiscard]] const std::string& version() const;
  /// The ways that may be the fastest.
  [[nodiscard]] std::vector<PeerCall> calls(bool any_hit) const;
  /// Bytes that its scenes use now.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  friend class PeerScene;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A device for every Embree that `find_embree` finds; at least one. Throws as `find_embree` does.
[[nodiscard]] std::vector<std::unique_ptr<PeerDevice>> open_peers(std::uint32_t threads);

/// One scene: a geometry per mesh, in the order of the meshes, with the buffers of the caller,
/// which must live until others replace them. Every function throws `Error` if the peer reports
/// one.
class PeerScene {
 public:
  PeerScene(PeerDevice& device, const PeerBuild& build);
  ~PeerScene();
  PeerScene(const PeerScene&) = delete;
  PeerScene& operator=(const PeerScene&) = delete;

  /// Sets new vertices and indices, then builds.
  void set_meshes(std::span<const MeshView> meshes);
  /// Sets new vertices for the same indices, then builds.
  void move_meshes(std::span<const MeshView> meshes);
  /// Instead of meshes: instances of one, whose tree is built with the peer's best quality.
  void set_instances(const MeshView& mesh, std::span<const Affine> transforms);
  /// Sets new transforms of the same instances, then builds.
  void move_instances(std::span<const Affine> transforms);
  /// `hits[i].geom_id` is the mesh's index, and `inst_id` the instance's, if there are any.
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits, const PeerCall& call);
  /// `occluded[i]` is 1 or 0.
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded, const PeerCall& call);

 private:
  class Impl;
  std::unique_ptr<Impl> mesh_;  ///< of the instances; is released after them
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf::app
