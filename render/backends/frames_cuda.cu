#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "render/backends/cuda_gl.h"
#include "render/device/frame_backend.h"
#include "render/device/stages_device.h"
#include "render/frame/batch_tracer.h"

namespace raysheaf {
namespace {

class CudaFrames final : public FrameBackend {
 public:
  [[nodiscard]] std::unique_ptr<DeviceBatchTracer> make_batch_tracer(
      Traversal traversal) const override {
    return batch_tracers().on_cuda(traversal);
  }
  [[nodiscard]] std::unique_ptr<DeviceStages> make_stages() const override {
    return std::make_unique<DeviceStagesOn<CudaDevice>>();
  }
};

}  // namespace

const FrameBackend& frame_backend_of_cuda() {
  static const CudaFrames frames;
  return frames;
}

}  // namespace raysheaf
