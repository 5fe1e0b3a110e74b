// The report as one HTML page that needs nothing else.
#pragma once

#include <string>

#include "report/bundles.h"
#include "report/layers.h"
#include "report/machine.h"

namespace raysheaf::app {

/// All that a page tells.
struct ReportPage {
  const ReportCommand& command;
  const SceneDescription& scene;
  const Report& report;
  Machine machine;
  std::vector<BundleLevel> bundles;
  HeatScale heat;
  std::vector<Layer> layers;
};

/// Gathers what is not measured but derived.
[[nodiscard]] ReportPage make_page(const ReportCommand& command, const SceneDescription& scene,
                                   const Report& report);

/// HTML 5 with everything inside: style, script, pictures, and the JSON below.
[[nodiscard]] std::string to_html(const ReportPage& page);

/// The JSON that docs/report.md describes, without "<": it may stand in a script element.
[[nodiscard]] std::string to_json(const ReportPage& page);

/// The text, with U+FFFD for bytes that are not UTF-8, as names of files may have.
[[nodiscard]] std::string valid_utf8(const std::string& text);

/// RFC 4648.
[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace raysheaf::app
