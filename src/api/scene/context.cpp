#include "raysheaf/context.h"
#include "backends/cuda.h"

#include <hwy/highway.h>

#include <string>

#include "api/scene/context_impl.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

void check(const ContextOptions& options) {
  if (options.threads > kMostThreads)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 0 to 1024, not " + std::to_string(options.threads), "threads");
  if (options.device != Device::kCpu && options.device != Device::kCuda)
    throw Error(ErrorCode::kInvalidArgument, "is not a valid device", "device");
}

template <class Work>
auto within_memory(const Work& work) {
  return raysheaf::within_memory("there is not enough memory", "context", work);
}

/// The device that the options request; null for the CPU.
std::unique_ptr<DeviceBackend> machine_of(const ContextOptions& options) {
  check(options);
  if (options.device == Device::kCpu) return nullptr;
  return within_memory([] { return open_cuda(); });
}

}  // namespace

const char* to_string(Device device) {
  switch (device) {
    case Device::kCpu:
      return "cpu";
    case Device::kCuda:
      return "cuda";
  }
  return "unknown";
}

std::string simd_target() {
  const std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(all & -all);  // Highway gives better targets lower bits
}

Context::Context(const ContextOptions& options) : Context(options, machine_of(options), nullptr) {}

/// With options that have been validated.
Context::Context(const ContextOptions& options, std::unique_ptr<DeviceBackend> machine,
                 std::shared_ptr<Communicator> processes)
    : impl_(within_memory([&] {
        return std::make_shared<const Impl>(options, std::move(machine), std::move(processes));
      })) {}

Context distributed(const ContextOptions& options, std::shared_ptr<Communicator> ranks) {
  return ContextAccess::with_backend(options, machine_of(options), std::move(ranks));
}

Device Context::device() const noexcept {
  return impl_->device;
}
std::uint32_t Context::threads() const noexcept {
  return impl_->executor.threads();
}

void Context::for_each_block(
    std::size_t count, std::size_t grain,
    const std::function<void(std::size_t begin, std::size_t end)>& body) const {
  impl_->executor.for_each_block(count, grain > 0 ? grain : 1, body);
}

}  // namespace raysheaf
