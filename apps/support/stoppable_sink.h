// A sink for blocks that stops when the program is interrupted.
#pragma once

#include "apps/support/console.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// Passes blocks on; after an interrupt it throws `Error` (kCancelled) instead.
class StoppableSink final : public BlockSink {
 public:
  explicit StoppableSink(BlockSink* sink) : sink_(*sink) {}
  void add(const TriangleBlock& block, const BlockShading& shading) override {
    stop_if_interrupted();
    sink_.add(block, shading);
  }

 private:
  BlockSink& sink_;
};

}  // namespace raysheaf::app
