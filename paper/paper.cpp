#include "raysheaf/paper.h"

#include "paper/make_tracers.h"

namespace raysheaf {

void use_paper_methods() {
#ifdef RAYSHEAF_PAPER_CUDA
  static constexpr BatchTracers kTracers{make_cpu_batch_tracer, make_cuda_batch_tracer};
#else
  static constexpr BatchTracers kTracers{make_cpu_batch_tracer, nullptr};
#endif
  set_batch_tracers(&kTracers);
}

}  // namespace raysheaf
