#include "device/measure_device.h"
#include "device/queries_device.h"
#include "emulated/emulated_device.h"
#include "emulated/emulated_links.h"
#include "emulated/open_emulated.h"
#include "methods/packets/packet_tracer.h"
#include "methods/ray_hierarchy/pair_tracer.h"
#include "out_of_core/block_tracer.h"
#include "render/device/frame_stages.h"

namespace raysheaf {
namespace {

class EmulatedBackend : public DeviceBackend {
 public:
  EmulatedBackend(const Executor& executor, HostAllocator& memory, DeviceAllocator* allocator)
      : executor_(executor), memory_(memory), allocator_(allocator) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::unique_ptr<DeviceQueries> make_queries() const override {
    return std::make_unique<DeviceQueriesOn<EmulatedDevice>>(executor_, memory_, allocator_);
  }
  [[nodiscard]] std::unique_ptr<PairTracer> make_pair_tracer() const override {
    return make_emulated_pair_tracer(kPairListCapacity, executor_, memory_, allocator_);
  }
  [[nodiscard]] std::unique_ptr<PacketTracer> make_packet_tracer() const override {
    return make_emulated_packet_tracer(kPairCapacity, executor_, memory_, allocator_);
  }
  [[nodiscard]] std::unique_ptr<BlockTracer> make_block_tracer(
      const Executor& executor, const BlockLimits& limits) const override {
    return make_emulated_block_tracer(executor, limits, memory_, allocator_);
  }
  [[nodiscard]] std::unique_ptr<DeviceStages> make_stages() const override {
    return make_emulated_stages(executor_, memory_, allocator_);
  }
  [[nodiscard]] bool is_device_memory(const void* pointer, const char* /*name*/) const override {
    return memory_.owns(pointer);
  }
  void write(void* to, const void* from, std::size_t bytes,
             const DeviceQuery& query) const override {
    EmulatedDevice device(executor_, memory_, allocator_);
    wait_for_streams(device, query);
    device.copy("copy: hits", to, from, bytes);
  }
  [[nodiscard]] bool reads_host_memory() const override { return true; }
  [[nodiscard]] double copy_bytes_per_ms() const override {
    EmulatedDevice device(executor_, memory_, allocator_);
    return measure_copy(device, std::size_t{1} << 22);
  }
  [[nodiscard]] double operations_per_ms() const override {
    EmulatedDevice device(executor_, memory_, allocator_);
    return measure_arithmetic(device, std::size_t{1} << 12);
  }

 private:
  const Executor& executor_;
  HostAllocator& memory_;
  DeviceAllocator* allocator_;
  std::string name_ = "the CPU, emulating a device";
};

}  // namespace

std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor, HostAllocator& memory,
                                             DeviceAllocator* allocator) {
  return std::make_unique<EmulatedBackend>(executor, memory, allocator);
}

}  // namespace raysheaf
