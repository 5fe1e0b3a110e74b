#include "backends/backend_device.h"
#include "backends/cuda.h"
#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"

namespace raysheaf {

std::unique_ptr<DeviceBackend> open_cuda() {
  return std::make_unique<BackendOn<CudaDevice>>();
}

}  // namespace raysheaf
