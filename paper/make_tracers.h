// Makes the tracers of `rah`, `crsh` and `gl10`.
#pragma once

#include "render/frame/batch_tracer.h"

namespace raysheaf {

[[nodiscard]] std::unique_ptr<BatchTracer> make_cpu_batch_tracer();
/// On the first CUDA device; not in a build without CUDA.
[[nodiscard]] std::unique_ptr<DeviceBatchTracer> make_cuda_batch_tracer(Traversal traversal);

}  // namespace raysheaf
