// What is behind `Context`.
#pragma once

#include <memory>

#include "engine/device_engine.h"
#include "exec/executor.h"
#include "raysheaf/context.h"
#include "raysheaf/distributed.h"

namespace raysheaf {

/// That options may ask for.
inline constexpr std::uint32_t kMostThreads = 1024;

struct Context::Impl {
  Impl(const ContextOptions& options, std::unique_ptr<DeviceBackend> machine,
       std::shared_ptr<Communicator> processes = nullptr)
      : device(options.device),
        executor(options.threads),
        backend(std::move(machine)),
        ranks(std::move(processes)) {}

  Device device;
  Executor executor;
  std::unique_ptr<DeviceBackend> backend;  ///< none: the CPU
  std::shared_ptr<Communicator> ranks;     ///< none: this process alone
};

struct ContextAccess {
  static const Executor& executor(const Context& context) { return context.impl_->executor; }
  /// Null for the CPU.
  static const DeviceBackend* backend(const Context& context) {
    return context.impl_->backend.get();
  }
  /// Null for this process alone.
  static Communicator* ranks(const Context& context) { return context.impl_->ranks.get(); }
  /// What `Context` does, for the processes of `ranks` if there are any.
  static void open(const ContextOptions& options, std::shared_ptr<Communicator> ranks,
                   Context* context);
  /// On a machine that is handed in.
  static Context with_backend(const ContextOptions& options, std::unique_ptr<DeviceBackend> backend,
                              std::shared_ptr<Communicator> ranks = nullptr) {
    Context context;
    context.impl_ =
        std::make_shared<const Context::Impl>(options, std::move(backend), std::move(ranks));
    return context;
  }
};

}  // namespace raysheaf
