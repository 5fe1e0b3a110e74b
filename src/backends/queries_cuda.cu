#include "backends/cuda.h"
#include "device/measure_device.h"
#include "device/queries_device.h"
#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "methods/packets/packet_tracer.h"
#include "methods/ray_hierarchy/pair_tracer.h"
#include "out_of_core/block_tracer.h"
#include "render/device/frame_stages.h"

namespace raysheaf {
namespace {

class CudaBackend : public DeviceBackend {
 public:
  CudaBackend() : name_(device_.name()) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::unique_ptr<DeviceQueries> make_queries() const override {
    return std::make_unique<DeviceQueriesOn<CudaDevice>>();
  }
  [[nodiscard]] std::unique_ptr<PairTracer> make_pair_tracer() const override {
    return make_cuda_pair_tracer(kPairListCapacity);
  }
  [[nodiscard]] std::unique_ptr<PacketTracer> make_packet_tracer() const override {
    return make_cuda_packet_tracer(kPairCapacity);
  }
  [[nodiscard]] std::unique_ptr<BlockTracer> make_block_tracer(
      const Executor& executor, const BlockLimits& limits) const override {
    return make_cuda_block_tracer(executor, limits);
  }
  [[nodiscard]] std::unique_ptr<DeviceStages> make_stages() const override {
    return make_cuda_stages();
  }
  [[nodiscard]] bool is_device_memory(const void* pointer, const char* name) const override {
    return device_.is_device_memory(pointer, name);
  }
  void write(void* to, const void* from, std::size_t bytes,
             const DeviceQuery& query) const override {
    CudaDevice device;
    wait_for_streams(device, query);
    device.copy("copy: hits", to, from, bytes);
  }
  [[nodiscard]] bool reads_host_memory() const override { return device_.reads_host_memory(); }
  [[nodiscard]] double copy_bytes_per_ms() const override {
    CudaDevice device;
    return measure_copy(device, std::size_t{1} << 29);
  }
  [[nodiscard]] double operations_per_ms() const override {
    CudaDevice device;
    return measure_arithmetic(device, std::size_t{1} << 22);
  }

 private:
  CudaDevice device_;
  std::string name_;
};

}  // namespace

std::unique_ptr<DeviceBackend> open_cuda() {
  return std::make_unique<CudaBackend>();
}

}  // namespace raysheaf
