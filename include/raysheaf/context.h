// A context: the device and the threads that scenes and queries use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace raysheaf {

class Communicator;
class DeviceBackend;

enum class Device : std::uint8_t {
  kCpu,   ///< SIMD at the width of the machine, on all threads
  kCuda,  ///< kernels on the first CUDA device
};

[[nodiscard]] const char* to_string(Device device);

/// The instruction set of the CPU's kernels on this machine, as Highway names it: "AVX2".
[[nodiscard]] std::string simd_target();

/// Progress of a call. `done` and `total` count the stage's own work items.
struct Progress {
  std::string_view stage;
  std::uint64_t done = 0, total = 0;
};

struct ContextOptions {
  Device device = Device::kCpu;
  std::uint32_t threads = 0;  ///< 0: all cores that the process may use; at most 1024
};

/// A handle that is cheap to copy: copies share their threads. Any number of scenes and threads may
/// use one context.
class Context {
 public:
  /// Throws `Error`: kInvalidArgument for the options, kUnsupported for a device that this build
  /// or this machine does not have, with CUDA's message, or for more threads than the system can
  /// start.
  explicit Context(const ContextOptions& options = {});

  [[nodiscard]] Device device() const noexcept;
  [[nodiscard]] std::uint32_t threads() const noexcept;

  /// Calls `body(begin, end)` for disjoint ranges that cover [0, count), about `grain` items or
  /// more each, in any order, on this context's threads; use it to make rays and read hits. An
  /// exception from a body ends the loop and is rethrown here.
  void for_each_block(std::size_t count, std::size_t grain,
                      const std::function<void(std::size_t begin, std::size_t end)>& body) const;

 private:
  friend struct ContextAccess;
  struct Impl;
  Context(const ContextOptions& options, std::unique_ptr<DeviceBackend> machine,
          std::shared_ptr<Communicator> processes);
  std::shared_ptr<const Impl> impl_;
};

}  // namespace raysheaf
