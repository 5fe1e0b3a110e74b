// The peer of `bench compare`: Embree 4 and Embree 3, each at its best. Both are loaded while the
// program runs, where they are installed (compare/embree_library.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compare/words.h"
#include "raysheaf/types.h"

namespace raysheaf::app {

/// A mesh in world space. Four bytes behind the last position can be read.
struct MeshView {
  std::span<const Vec3> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// How the peer builds: an index into `peer_builds`.
struct PeerBuild {
  std::string name;
  std::uint32_t index = 0;
};

/// How the peer is asked: an index that its own device understands.
struct PeerCall {
  std::string name;
  std::uint32_t index = 0;
};

/// What may be the fastest in a mode. Which one is has to be measured.
[[nodiscard]] std::vector<PeerBuild> peer_builds(CompareMode mode);

struct EmbreeLibrary;

/// A device of one of the versions, with its threads.
class PeerDevice {
 public:
  /// Throws `Error` where the library has no device, or is neither Embree 3 nor 4.
  PeerDevice(const EmbreeLibrary& library, std::uint32_t threads);
  ~PeerDevice();
  PeerDevice(const PeerDevice&) = delete;
  PeerDevice& operator=(const PeerDevice&) = delete;

  /// "4.4.0"
  [[nodiscard]] const std::string& version() const;
  /// The ways that may be the fastest.
  [[nodiscard]] std::vector<PeerCall> calls(bool any_hit) const;
  /// What its scenes hold now.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  friend class PeerScene;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A device for every Embree that `find_embree` finds; at least one. Throws as that does.
[[nodiscard]] std::vector<std::unique_ptr<PeerDevice>> open_peers(std::uint32_t threads);

/// One scene: a geometry a mesh, in their order, with the caller's buffers, which must live until
/// others take their place. Every function throws `Error` where the peer reports one.
class PeerScene {
 public:
  PeerScene(PeerDevice& device, const PeerBuild& build);
  ~PeerScene();
  PeerScene(const PeerScene&) = delete;
  PeerScene& operator=(const PeerScene&) = delete;

  /// New vertices and indices, then the build.
  void set_meshes(std::span<const MeshView> meshes);
  /// New vertices for the same indices, then the build.
  void move_meshes(std::span<const MeshView> meshes);
  /// `hits[i].geom_id` is the mesh's index; `inst_id` is not set.
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits, const PeerCall& call);
  /// `occluded[i]` is 1 or 0.
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded, const PeerCall& call);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf::app
