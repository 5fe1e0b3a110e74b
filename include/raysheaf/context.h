// Where scenes live and queries run: a device and a number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace raysheaf {

class Communicator;
class DeviceBackend;

enum class Device : std::uint8_t {
  kCpu,   ///< SIMD at the width of the machine, on all threads
  kCuda,  ///< kernels on the first CUDA device
};

[[nodiscard]] const char* to_string(Device device);

/// The instructions that the CPU's kernels use on this machine, in Highway's word: "AVX2".
[[nodiscard]] std::string simd_target();

struct ContextOptions {
  Device device = Device::kCpu;
  std::uint32_t threads = 0;  ///< 0: all cores that the process may use; 1024 at most
};

/// A handle, cheap to copy: copies share their threads. Any number of scenes may stand on one, and
/// any number of threads may use it.
class Context {
 public:
  /// Throws `Error`: kInvalidArgument for the options, kUnsupported for a device that this build
  /// or this machine does not have, in CUDA's own words, or for more threads than the system
  /// starts.
  explicit Context(const ContextOptions& options = {});

  [[nodiscard]] Device device() const noexcept;
  [[nodiscard]] std::uint32_t threads() const noexcept;

  /// Calls `body(begin, end)` for disjoint ranges that make up [0, count), about `grain` items
  /// or more each, in any order, on this context's threads: for making rays and reading hits. An
  /// exception from a body ends the loop and is thrown here.
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
