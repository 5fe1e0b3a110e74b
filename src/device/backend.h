// A machine on which queries can be computed, and what it creates for them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace raysheaf {

class DeviceQueries;
class Executor;
struct DeviceQuery;
class BlockTracer;
struct BlockLimits;

/// The measured rates of a device.
struct DeviceSpeed {
  double bytes_per_ms;       ///< read plus written, when copying within the device's memory
  double operations_per_ms;  ///< multiplications and additions in binary32
};

/// A machine on which queries can be computed. The renderer has its own part of it
/// (render/device/frame_backend.h).
class DeviceBackend {
 public:
  virtual ~DeviceBackend() = default;
  /// "NVIDIA ..., compute capability 9.0".
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual std::unique_ptr<DeviceQueries> make_queries() const = 0;
  /// For streaming (out_of_core/block_tracer.h). `executor` must outlive it.
  [[nodiscard]] virtual std::unique_ptr<BlockTracer> make_block_tracer(
      const Executor& executor, const BlockLimits& limits) const = 0;
  /// As the verb of exec/device.h.
  [[nodiscard]] virtual bool is_device_memory(const void* pointer, const char* name) const = 0;
  /// Copies from the host's memory to the device's, after the streams that `query` names.
  /// Thread-safe.
  virtual void write(void* to, const void* from, std::size_t bytes,
                     const DeviceQuery& query) const = 0;
  /// As the verb of exec/device.h.
  [[nodiscard]] virtual bool reads_host_memory() const = 0;
  [[nodiscard]] virtual DeviceSpeed speed() const = 0;
};

}  // namespace raysheaf
