// Runs tests of queries on each backend that the machine has.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "backends/cuda.h"
#include "device/device_queries.h"
#include "emulated/open_emulated.h"
#include "raysheaf/error.h"
#include "tests/support/device_memory.h"
#include "tests/support/guarded_memory.h"

namespace raysheaf::test {

struct Emulation {
  Executor executor{2};
  GuardedMemory soup;
  FailingAllocator memory{soup};
  std::unique_ptr<DeviceBackend> backend = open_emulated(executor, soup, &memory);
};

/// The parameter: whether the device is a CUDA device, or else emulated.
class OnDevice : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (!GetParam()) {
      backend_ = std::move(emulation_.backend);
      return;
    }
    try {
      backend_ = open_cuda();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kUnsupported) throw;
      GTEST_SKIP() << error.what();
    }
  }

  Emulation emulation_;
  Executor executor_{2};
  std::unique_ptr<DeviceBackend> backend_;
};

}  // namespace raysheaf::test
