#include "emulated/open_emulated.h"

#include "backends/backend_device.h"
#include "emulated/emulated_gl.h"
#include "emulated/emulated_links.h"
#include "paper/packets/packet_tracer_device.h"
#include "paper/ray_hierarchy/pair_tracer_device.h"
#include "render/device/frame_backend.h"
#include "render/device/stages_device.h"

namespace raysheaf {
namespace {

using BackendOfCpu = BackendOn<EmulatedDevice, const Executor&, HostAllocator&, DeviceAllocator*>;

class EmulatedBackend final : public BackendOfCpu, public FrameBackend {
 public:
  using BackendOfCpu::BackendOfCpu;

  [[nodiscard]] std::unique_ptr<DeviceBatchTracer> make_batch_tracer(
      Traversal traversal) const override {
    if (traversal == Traversal::kPackets)
      return make<PacketTracerOn<EmulatedDevice>>(kPairCapacity, kPacketRays);
    return make<PairTracerOn<EmulatedDevice>>(kPairListCapacity);
  }
  [[nodiscard]] std::unique_ptr<DeviceStages> make_stages() const override {
    return make<DeviceStagesOn<EmulatedDevice>>();
  }
};

}  // namespace

std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor, HostAllocator& memory,
                                             DeviceAllocator* allocator) {
  return std::make_unique<EmulatedBackend>(executor, memory, allocator);
}

}  // namespace raysheaf
