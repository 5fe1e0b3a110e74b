// What is behind `Context`.
#pragma once

#include <memory>

#include "engine/device_engine.h"
#include "exec/executor.h"
#include "raysheaf/context.h"

namespace raysheaf {

struct Context::Impl {
  Impl(const ContextOptions& options, std::unique_ptr<DeviceBackend> machine)
      : device(options.device), executor(options.threads), backend(std::move(machine)) {}

  Device device;
  Executor executor;
  std::unique_ptr<DeviceBackend> backend;  ///< none: the CPU
};

struct ContextAccess {
  static const Executor& executor(const Context& context) { return context.impl_->executor; }
  /// Null for the CPU.
  static const DeviceBackend* backend(const Context& context) {
    return context.impl_->backend.get();
  }
  /// On a machine that is handed in.
  static Context with_backend(const ContextOptions& options,
                              std::unique_ptr<DeviceBackend> backend) {
    Context context;
    context.impl_ = std::make_shared<const Context::Impl>(options, std::move(backend));
    return context;
  }
};

}  // namespace raysheaf
