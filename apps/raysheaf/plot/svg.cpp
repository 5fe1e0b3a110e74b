#include "plot/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace raysheaf::app {
namespace {

constexpr const char* kFonts =
    "Inter, 'Source Sans 3', 'Segoe UI', 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', "
    "sans-serif";

std::string text_element(std::string_view place, std::string_view words, const TextStyle& style) {
  return fmt::format("<text {} font-size=\"{:g}\" fill=\"{}\" text-anchor=\"{}\"{}>{}</text>\n",
                     place, style.size, style.fill, style.anchor,
                     style.bold ? " font-weight=\"700\"" : "", escaped(words));
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string all;
  for (const char c : text) {
    switch (c) {
      case '&':
        all += "&amp;";
        break;
      case '<':
        all += "&lt;";
        break;
      case '>':
        all += "&gt;";
        break;
      case '"':
        all += "&quot;";
        break;
      default:
        all += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    }
  }
  return all;
}

std::string three_digits(double value) {
  if (!(value > 0)) return "0";
  const int before_the_point = static_cast<int>(std::floor(std::log10(value))) + 1;
  return fmt::format("{:.{}f}", value, std::clamp(3 - before_the_point, 0, 12));
}

SvgSheet::SvgSheet(double width, double height) {
  body_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" "
      "viewBox=\"0 0 {0:g} {1:g}\" font-family=\"{2}\">\n",
      width, height, kFonts);
  rectangle(0, 0, width, height, "fill=\"#fdfdfb\"");
}

void SvgSheet::text(double x, double y, std::string_view words, const TextStyle& style) {
  body_ += text_element(fmt::format("x=\"{:.1f}\" y=\"{:.1f}\"", x, y), words, style);
}

void SvgSheet::upright_text(double x, double y, std::string_view words, const TextStyle& style) {
  body_ += text_element(fmt::format("transform=\"translate({:.1f} {:.1f}) rotate(-90)\"", x, y),
                        words, style);
}

void SvgSheet::rectangle(double x, double y, double width, double height,
                         std::string_view attributes) {
  body_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>\n",
                       x, y, width, height, attributes);
}

void SvgSheet::line(double x1, double y1, double x2, double y2, std::string_view attributes) {
  body_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1,
                       y1, x2, y2, attributes);
}

void SvgSheet::raw(std::string_view element) {
  body_ += element;
}

std::string SvgSheet::finished() const {
  return body_ + "</svg>\n";
}

}  // namespace raysheaf::app
