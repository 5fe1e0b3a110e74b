// The machine that made a report: facts that its times depend on.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

struct Machine {
  std::string processor;  ///< the name of the model, or of the architecture if it is not known
  std::uint32_t cores = 0, threads = 0;
  std::uint64_t memory_bytes = 0;
  std::string simd, system, compiler, opengl, version, date;
};

[[nodiscard]] Machine describe_machine(const Report& report);

/// The same as text, with a name and a value on each line.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const Machine& machine);

}  // namespace raysheaf::app
