// Where blocks go until the program is interrupted.
#pragma once

#include "console.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// Passes blocks on; throws `Error` (kCancelled) instead once the program is interrupted.
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
