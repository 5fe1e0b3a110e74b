#include "backends/cuda.h"
#include "exec/cuda/cuda_gl.h"
#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "render/device/stages_device.h"

namespace raysheaf {

std::unique_ptr<DeviceStages> make_cuda_stages() {
  return std::make_unique<DeviceStagesOn<CudaDevice>>();
}

}  // namespace raysheaf
