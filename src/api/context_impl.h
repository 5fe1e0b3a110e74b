// What is behind `Context`.
#pragma once

#include "exec/executor.h"
#include "raysheaf/context.h"

namespace raysheaf {

struct Context::Impl {
  explicit Impl(const ContextOptions& options)
      : device(options.device), executor(options.threads) {}

  Device device;
  Executor executor;
};

struct ContextAccess {
  static const Executor& executor(const Context& context) { return context.impl_->executor; }
};

}  // namespace raysheaf
