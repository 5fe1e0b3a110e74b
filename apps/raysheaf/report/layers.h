// The layers of a frame as images for people.
#pragma once

#include <string>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

/// An image and its description.
struct Layer {
  std::string id;     ///< a word: "normal", "tests-rah"
  std::string title;  ///< "Shading normals"
  std::string text;   ///< the meaning of its colours, for newcomers
  bool heat = false;  ///< its colours are those of the heat map's legend
  double mean = 0;    ///< tests per pixel of a heat map
  Image image;
};

/// The common scale of all heat maps of a report, so that they can be compared: logarithmic,
/// between powers of ten.
struct HeatScale {
  int low_exponent = 0, high_exponent = 1;
  /// The position of a number of tests between the ends, from 0 to 1.
  [[nodiscard]] float at(double tests) const;
};

[[nodiscard]] HeatScale heat_scale(const Report& report);

/// The image, a heat map of each method that ran (for `brute` only the numbers of rays differ
/// between pixels), and the layers of primary visibility.
[[nodiscard]] std::vector<Layer> make_layers(const Report& report, const HeatScale& scale,
                                             const Box& scene_bounds);

}  // namespace raysheaf::app
