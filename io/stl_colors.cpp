#include "io/stl_colors.h"

#include <algorithm>
#include <string_view>

#include "io/srgb.h"

namespace raysheaf::io {
namespace {

constexpr unsigned kLargestPart = 31, kMarkBit = 15;

float stl_channel(unsigned code, unsigned largest) {
  return static_cast<float>(linear_of_srgb(static_cast<double>(code) / largest));
}

float stl_part_of(std::uint16_t attribute, unsigned part) {
  return stl_channel(attribute >> 5 * part & kLargestPart, kLargestPart);
}

}  // namespace

StlPalette::StlPalette(std::span<const std::uint8_t> head) {
  constexpr std::string_view kWord = "COLOR=";
  const auto found = std::search(head.begin(), head.end(), kWord.begin(), kWord.end());
  const auto at = static_cast<std::size_t>(found - head.begin()) + kWord.size();
  if (at + 4 > head.size()) return;
  body_ = {stl_channel(head[at], 255), stl_channel(head[at + 1], 255),
           stl_channel(head[at + 2], 255)};
}

Vec3 StlPalette::color_of(std::uint16_t attribute) const {
  const bool is_marked = (attribute >> kMarkBit & 1) != 0;
  const float low = stl_part_of(attribute, 0), middle = stl_part_of(attribute, 1),
              high = stl_part_of(attribute, 2);
  if (body_) return is_marked ? *body_ : Vec3{low, middle, high};
  return is_marked ? Vec3{high, middle, low} : kStlGrey;
}

Vec3 StlPalette::common_color(std::uint16_t attribute) const {
  return body_ && attribute == 0 ? *body_ : color_of(attribute);
}

}  // namespace raysheaf::io
