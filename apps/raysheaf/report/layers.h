// A frame's layers as pictures that people can look at.
#pragma once

#include <string>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

/// A picture and what it shows.
struct Layer {
  std::string id;     ///< a word: "normal", "tests-rah"
  std::string title;  ///< "Shading normals"
  std::string text;   ///< what its colours mean, for newcomers
  bool heat = false;  ///< its colours are those of the heat map's legend
  double mean = 0;    ///< of a heat map: tests a pixel
  Image image;
};

/// The one scale of all heat maps of a report, so that they compare: logarithmic, between powers of
/// ten.
struct HeatScale {
  int low_exponent = 0, high_exponent = 1;
  /// Where a number of tests lies between the ends, 0 to 1.
  [[nodiscard]] float at(double tests) const;
};

[[nodiscard]] HeatScale heat_scale(const Report& report);

/// The picture, a heat map of each method that ran (of `brute` all pixels are alike but for their
/// rays), and the layers of the first hits.
[[nodiscard]] std::vector<Layer> make_layers(const Report& report, const HeatScale& scale,
                                             const Box& scene_bounds);

}  // namespace raysheaf::app
