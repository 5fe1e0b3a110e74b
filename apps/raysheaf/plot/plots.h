// Plots as SVG files that stand alone: text, rectangles and lines, on a light ground.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raysheaf::app {

/// A table of positive numbers, coloured on a logarithmic scale of its own, with the numbers in the
/// cells. The least is framed.
struct HeatMap {
  struct Row {
    std::string name, detail;    ///< a name is written once where rows in a row share it
    std::vector<double> values;  ///< one a column; what is not above zero leaves its cell empty
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
    std::string label;  ///< written beside it where it is not empty
  };
  std::string title;
  std::vector<Point> points;
};

/// Two plots a row.
[[nodiscard]] std::string heat_maps_svg(const std::string& title, const std::string& note,
                                        const std::vector<HeatMap>& maps);

/// The names of the axes, of the colours (7 at most) and of the shapes (7 at most).
struct ScatterKey {
  std::string x, y;
  std::vector<std::string> colors, shapes;
};

/// Two plots a row. A dashed line joins the points that no other beats in both figures.
[[nodiscard]] std::string scatters_svg(const std::string& title, const std::string& note,
                                       const ScatterKey& key, const std::vector<Scatter>& plots);

}  // namespace raysheaf::app
