// A target under libFuzzer: RAYSHEAF_FUZZ_TARGET is the name of its function.
#include <cstddef>

#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  raysheaf::fuzz::RAYSHEAF_FUZZ_TARGET({data, size});
  return 0;
}
