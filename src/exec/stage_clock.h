// The times of a device's stages, by the stage names passed to its verbs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf {

struct StageTime {
  std::string stage;
  double ms = 0;
  std::uint64_t calls = 0;
};

/// Stages in the order in which they first occurred.
inline void add_stage_time(const char* stage, double ms, std::vector<StageTime>* times) {
  for (StageTime& time : *times) {
    if (time.stage != stage) continue;
    time.ms += ms;
    ++time.calls;
    return;
  }
  times->push_back({stage, ms, 1});
}

}  // namespace raysheaf
