// Explains the published counts in words; the figures come from the report.
#pragma once

#include <string>

#include "paper/paper.h"

namespace raysheaf::app {

/// Whether the published program's switches were tried for the paper's scenes at the paper's size.
[[nodiscard]] bool has_published(const PaperReport& report);

/// Points of the page's summary, and a section; `has_published` must hold.
[[nodiscard]] std::string findings_in_short(const PaperReport& report);
[[nodiscard]] std::string findings(const PaperReport& report);

/// A section about contradictions within the paper.
[[nodiscard]] std::string inconsistencies();

}  // namespace raysheaf::app
