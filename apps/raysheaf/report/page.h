// The report as one self-contained HTML page.
#pragma once

#include <string>

#include "report/bundles.h"
#include "report/layers.h"
#include "report/machine.h"

namespace raysheaf::app {

/// All content of a page.
struct ReportPage {
  const ReportCommand& command;
  const SceneDescription& scene;
  const Report& report;
  Machine machine;
  std::vector<BundleLevel> bundles;
  HeatScale heat;
  std::vector<Layer> layers;
};

/// Computes everything that is derived from measurements.
[[nodiscard]] ReportPage make_page(const ReportCommand& command, const SceneDescription& scene,
                                   const Report& report);

/// HTML 5 that contains everything: style, script, images, and the JSON below.
[[nodiscard]] std::string to_html(const ReportPage& page);

/// The JSON that docs/report.md describes, without "<", so that it can be part of a script element.
[[nodiscard]] std::string to_json(const ReportPage& page);

/// The text, with U+FFFD for bytes that are not UTF-8, which file names may contain.
[[nodiscard]] std::string valid_utf8(const std::string& text);

/// Base64, RFC 4648.
[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace raysheaf::app
