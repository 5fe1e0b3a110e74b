// Replaces CUDA in a build without nvcc; not compiled in others.
#include "backends/cuda.h"

#include "raysheaf/error.h"

namespace raysheaf {

std::unique_ptr<DeviceBackend> open_cuda() {
  throw Error(ErrorCode::kUnsupported,
              "this build has no CUDA: it was configured without nvcc, or with RAYSHEAF_CUDA=OFF",
              "CUDA device");
}

}  // namespace raysheaf
