#include "render/device/frame_backend.h"

namespace raysheaf {

const FrameBackend& frame_backend(const DeviceBackend& queries) {
  const auto* both = dynamic_cast<const FrameBackend*>(&queries);
  return both != nullptr ? *both : frame_backend_of_cuda();
}

}  // namespace raysheaf
