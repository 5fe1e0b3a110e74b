#include "engine/device_stages-inl.h"
#include "exec/cuda/cuda_gl.h"
#include "exec/cuda/cuda_links.h"
#include "exec/cuda/launch-inl.h"

namespace raysheaf {

std::unique_ptr<DeviceStages> make_cuda_stages() {
  return std::make_unique<DeviceStagesOn<CudaDevice>>();
}

}  // namespace raysheaf
