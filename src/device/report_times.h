// Assigns the times of a device's stages to the fields of a report.
#pragma once

#include <string_view>
#include <vector>

#include "exec/stage_clock.h"
#include "queries/query_report.h"

namespace raysheaf {

/// Assigns by the prefix of the stage's name. Copies are only part of the total, which is not set
/// here.
inline void add_times(const std::vector<StageTime>& times, QueryReport* report) {
  for (const StageTime& time : times) {
    const std::string_view stage = time.stage;
    if (stage.starts_with("order:")) report->order_ms += time.ms;
    if (stage.starts_with("hierarchy:")) report->hierarchy_ms += time.ms;
    if (stage.starts_with("trace:")) report->trace_ms += time.ms;
  }
}

}  // namespace raysheaf
