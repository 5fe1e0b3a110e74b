// The cases that *_bodies.cu compile for host and device.
#pragma once

#include <vector>

#include "cuda/words.h"

namespace raysheaf::test {

/// Both functions write words 0 to count - 1, item i from `Draws(i)`. `on_device` is a kernel for
/// one-dimensional grids of at least `count` threads.
struct CompiledCase {
  const char* name;
  void (*on_host)(std::uint32_t count, Words* out);
  void (*on_device)(std::uint32_t count, Words* out);
};

[[nodiscard]] std::vector<CompiledCase> compiled_stage_cases();
[[nodiscard]] std::vector<CompiledCase> compiled_bound_cases();
[[nodiscard]] std::vector<CompiledCase> compiled_packet_cases();
[[nodiscard]] std::vector<CompiledCase> compiled_tree_cases();

}  // namespace raysheaf::test
