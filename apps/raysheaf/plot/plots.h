// Plots as self-contained SVG files: text, rectangles and lines, on a light background.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raysheaf::app {

/// A table of positive numbers, coloured on its own logarithmic scale, with the numbers in the
/// cells. The smallest one is framed.
struct HeatMap {
  struct Row {
    std::string name, detail;  ///< consecutive rows with the same name show it once
    /// one per column; a value that is not above zero leaves its cell empty
    std::vector<double> values;
  };
  std::string title, note;
  std::vector<std::string> columns;
  std::vector<Row> rows;
};

/// Points on two logarithmic axes.
struct Scatter {
  struct Point {
    double x = 0, y = 0;  ///< above zero
    std::size_t color = 0, shape = 0;
    std::string label;  ///< written next to the point unless it is empty
  };
  std::string title;
  std::vector<Point> points;
};

/// Draws two plots per row.
[[nodiscard]] std::string heat_maps_svg(const std::string& title, const std::string& note,
                                        const std::vector<HeatMap>& maps);

/// The names of the axes, of the colours (7 at most) and of the shapes (7 at most).
struct ScatterKey {
  std::string x, y;
  std::vector<std::string> colors, shapes;
};

/// Draws two plots per row. A dashed line joins the points that no other point beats in both
/// figures.
[[nodiscard]] std::string scatters_svg(const std::string& title, const std::string& note,
                                       const ScatterKey& key, const std::vector<Scatter>& plots);

}  // namespace raysheaf::app
