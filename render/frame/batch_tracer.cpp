#include "render/frame/batch_tracer.h"

#include <atomic>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::atomic<const BatchTracers*> tracers_of_process = nullptr;

}  // namespace

void set_batch_tracers(const BatchTracers* tracers) {
  tracers_of_process = tracers;
}

const BatchTracers& batch_tracers() {
  const BatchTracers* const tracers = tracers_of_process;
  if (tracers == nullptr)
    throw Error(ErrorCode::kUnsupported,
                "rah, crsh and gl10 are in a library of their own: link raysheaf::paper, and call "
                "use_paper_methods() before",
                "method");
  return *tracers;
}

}  // namespace raysheaf
