// What ran a report: facts that its times depend on.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

struct Machine {
  std::string processor;  ///< the model's name, or the architecture's where there is none
  std::uint32_t cores = 0, threads = 0;
  std::uint64_t memory_bytes = 0;
  std::string simd, system, compiler, opengl, version, date;
};

[[nodiscard]] Machine describe_machine(const Report& report);

/// The same, a name and a value a line, for people.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> facts_of(const Machine& machine);

}  // namespace raysheaf::app
