// A build without Embree.
#include "compare/peer.h"
#include "raysheaf/error.h"

namespace raysheaf::app {

class PeerDevice::Impl {};
class PeerScene::Impl {};

std::string peer_name() {
  return {};
}

std::vector<PeerBuild> peer_builds(CompareMode) {
  return {};
}

std::vector<PeerCall> peer_calls(bool) {
  return {};
}

PeerDevice::PeerDevice(std::uint32_t) {
  throw Error(ErrorCode::kUnsupported, "this build has no peer to compare with: Embree was missing",
              "bench compare");
}

PeerDevice::~PeerDevice() = default;

std::uint64_t PeerDevice::memory_bytes() const {
  return 0;
}

PeerScene::PeerScene(PeerDevice&, const PeerBuild&) {}
PeerScene::~PeerScene() = default;
void PeerScene::set_meshes(std::span<const MeshView>) {}
void PeerScene::move_meshes(std::span<const MeshView>) {}
void PeerScene::closest_hit(std::span<const Ray>, std::span<Hit>, const PeerCall&) {}
void PeerScene::any_hit(std::span<const Ray>, std::span<std::uint8_t>, const PeerCall&) {}

}  // namespace raysheaf::app
