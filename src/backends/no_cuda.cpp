// What stands for CUDA in a build without nvcc; left out where there is one.
#include "backends/cuda.h"

#include "raysheaf/error.h"

namespace raysheaf {

std::unique_ptr<DeviceBackend> open_cuda() {
  throw Error(ErrorCode::kUnsupported,
              "this build has no CUDA: it was configured without nvcc, or with RAYSHEAF_CUDA=OFF",
              "CUDA device");
}

}  // namespace raysheaf
