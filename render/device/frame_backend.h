// What a device creates for frames, next to what it creates for queries (device/backend.h).
#pragma once

#include <memory>

#include "device/backend.h"
#include "raysheaf/method.h"

namespace raysheaf {

class DeviceBatchTracer;
class DeviceStages;

class FrameBackend {
 public:
  virtual ~FrameBackend() = default;
  /// For methods that order rays (render/device/device_batch_tracer.h).
  [[nodiscard]] virtual std::unique_ptr<DeviceBatchTracer> make_batch_tracer(
      Traversal traversal) const = 0;
  /// render/device/frame_stages.h.
  [[nodiscard]] virtual std::unique_ptr<DeviceStages> make_stages() const = 0;
};

/// That of the machine of `queries`: the same object, if that has both, or else CUDA's.
[[nodiscard]] const FrameBackend& frame_backend(const DeviceBackend& queries);

/// What it creates throws as `open_cuda` does (backends/cuda.h).
[[nodiscard]] const FrameBackend& frame_backend_of_cuda();

}  // namespace raysheaf
