#include "raysheaf/context.h"

#include <hwy/highway.h>

#include <string>

#include "api/context_impl.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

void check(const ContextOptions& options) {
  if (options.threads > kMostThreads)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 0 to 1024, not " + std::to_string(options.threads), "threads");
  if (options.device != Device::kCpu && options.device != Device::kCuda)
    throw Error(ErrorCode::kInvalidArgument, "is no device that there is", "device");
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

Context::Context(const ContextOptions& options) {
  ContextAccess::open(options, nullptr, this);
}

void ContextAccess::open(const ContextOptions& options, std::shared_ptr<Communicator> ranks,
                         Context* context) {
  check(options);
  within_memory("there is not enough memory", "context", [&] {
    context->impl_ = std::make_shared<const Context::Impl>(
        options, options.device == Device::kCuda ? open_cuda() : nullptr, std::move(ranks));
  });
}

Context distributed(const ContextOptions& options, std::shared_ptr<Communicator> ranks) {
  Context context;
  ContextAccess::open(options, std::move(ranks), &context);
  return context;
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
