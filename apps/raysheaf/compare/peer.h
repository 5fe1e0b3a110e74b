// The peer of `bench compare`: Embree, at its best. A build without it has the functions too, and
// no peer behind them (compare/no_peer.cpp).
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

/// How the peer is asked: an index into `peer_calls`.
struct PeerCall {
  std::string name;
  std::uint32_t index = 0;
};

/// "Embree 3.13.5", or empty where this build has no peer.
[[nodiscard]] std::string peer_name();

/// What may be the fastest in a mode. Which one is has to be measured.
[[nodiscard]] std::vector<PeerBuild> peer_builds(CompareMode mode);
[[nodiscard]] std::vector<PeerCall> peer_calls(bool any_hit);

/// A device with its threads. Throws `Error` (kUnsupported) where this build has no peer.
class PeerDevice {
 public:
  explicit PeerDevice(std::uint32_t threads);
  ~PeerDevice();
  PeerDevice(const PeerDevice&) = delete;
  PeerDevice& operator=(const PeerDevice&) = delete;
  /// What its scenes hold now.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  friend class PeerScene;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

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
