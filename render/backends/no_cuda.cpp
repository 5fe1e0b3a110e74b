// Replaces CUDA in a build without nvcc; not compiled in others.
#include "raysheaf/error.h"
#include "render/device/frame_backend.h"

namespace raysheaf {

const FrameBackend& frame_backend_of_cuda() {
  throw Error(ErrorCode::kUnsupported, "this build has no CUDA", "CUDA device");
}

}  // namespace raysheaf
