#include "backends/backend_device.h"
#include "backends/cuda.h"
#include "exec/cuda/cuda_gl.h"
#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "render/frame/batch_tracer.h"

namespace raysheaf {
namespace {

class CudaBackend final : public BackendOn<CudaDevice> {
 public:
  [[nodiscard]] std::unique_ptr<DeviceBatchTracer> make_batch_tracer(
      Traversal traversal) const override {
    return batch_tracers().on_cuda(traversal);
  }
};

}  // namespace

std::unique_ptr<DeviceBackend> open_cuda() {
  return std::make_unique<CudaBackend>();
}

}  // namespace raysheaf
