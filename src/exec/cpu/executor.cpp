#include "exec/executor.h"

#include <oneapi/tbb/info.h>

#include <algorithm>

namespace raysheaf {

Executor::Executor(std::uint32_t threads)
    : threads_(threads != 0 ? threads
                            : static_cast<std::uint32_t>(
                                  std::max(1, oneapi::tbb::info::default_concurrency()))),
      workers_(oneapi::tbb::global_control::max_allowed_parallelism,
               std::max<std::size_t>(threads_, oneapi::tbb::info::default_concurrency())),
      arena_(static_cast<int>(threads_)) {}

}  // namespace raysheaf
