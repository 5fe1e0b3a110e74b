// Pieces of SVG.
#pragma once

#include <string>
#include <string_view>

namespace raysheaf::app {

/// &, <, > and quotes as entities; control characters as '?'.
[[nodiscard]] std::string escaped(std::string_view text);

/// Three significant digits, without an exponent.
[[nodiscard]] std::string three_digits(double value);

struct TextStyle {
  double size = 12;
  const char* fill = "#2b2f33";
  const char* anchor = "start";  ///< or "middle", "end"
  bool bold = false;
};

class SvgSheet {
 public:
  SvgSheet(double width, double height);
  void text(double x, double y, std::string_view words, const TextStyle& style);
  /// Text that is rotated and read from below.
  void upright_text(double x, double y, std::string_view words, const TextStyle& style);
  void rectangle(double x, double y, double width, double height, std::string_view attributes);
  void line(double x1, double y1, double x2, double y2, std::string_view attributes);
  void raw(std::string_view element);
  /// Returns the whole file.
  [[nodiscard]] std::string finished() const;

 private:
  std::string body_;
};

}  // namespace raysheaf::app
