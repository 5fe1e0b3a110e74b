// The implementation of `Context`.
#pragma once

#include <memory>

#include "device/backend.h"
#include "exec/executor.h"
#include "raysheaf/context.h"
#include "raysheaf/distributed.h"

namespace raysheaf {

/// The most that options may request.
inline constexpr std::uint32_t kMostThreads = 1024;

struct Context::Impl {
  Impl(const ContextOptions& options, std::unique_ptr<DeviceBackend> machine,
       std::shared_ptr<Communicator> processes)
      : device(options.device),
        executor(options.threads),
        backend(std::move(machine)),
        ranks(std::move(processes)) {}

  Device device;
  Executor executor;
  std::unique_ptr<DeviceBackend> backend;  ///< null: the CPU
  std::shared_ptr<Communicator> ranks;     ///< null: this process only
};

struct ContextAccess {
  static const Executor& executor(const Context& context) { return context.impl_->executor; }
  /// Null for the CPU.
  static const DeviceBackend* backend(const Context& context) {
    return context.impl_->backend.get();
  }
  /// Null for a single process.
  static Communicator* ranks(const Context& context) { return context.impl_->ranks.get(); }
  /// On a given device, or the CPU; for the processes of `ranks`, if any.
  static Context with_backend(const ContextOptions& options, std::unique_ptr<DeviceBackend> backend,
                              std::shared_ptr<Communicator> ranks = nullptr) {
    return Context(options, std::move(backend), std::move(ranks));
  }
};

}  // namespace raysheaf
