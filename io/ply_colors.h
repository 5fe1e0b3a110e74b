// Colours of PLY vertices and faces: integers are sRGB codes, floats are linear.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "io/ply_header.h"
#include "io/srgb.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

/// The largest code of a colour component with this type. Programs that write wider types than 16
/// bits, or signed bytes, mean bytes.
inline std::size_t largest_code(PlyType type) {
  if (type == PlyType::kUint16) return 65535;
  return type == PlyType::kInt16 ? 32767 : 255;
}

class PlyColors {
 public:
  /// `type` is the one of the property "red".
  explicit PlyColors(PlyType type = PlyType::kFloat32) {
    if (type >= PlyType::kFloat32) return;
    const std::size_t largest = largest_code(type);
    for (std::size_t code = 0; code <= largest; ++code) {
      const double part = static_cast<double>(code) / static_cast<double>(largest);
      linear_of_code_.push_back(static_cast<float>(linear_of_srgb(part)));
    }
  }

  /// The linear colour for integers; floats stay as written until all are known.
  [[nodiscard]] Vec3 color(double red, double green, double blue) {
    return {part(red), part(green), part(blue)};
  }
  /// Whether floats exceed 1 as bytes do, so that `scaled` changes them.
  [[nodiscard]] bool is_in_bytes() const { return largest_ > kMostUnitColor; }
  [[nodiscard]] bool needs_scale() const { return largest_ > 1; }
  /// The linear colour for a result of `color`.
  [[nodiscard]] Vec3 scaled(Vec3 color) const {
    return {scaled_part(color.x), scaled_part(color.y), scaled_part(color.z)};
  }

 private:
  float part(double x) {
    if (!(x > 0)) return 0;
    if (linear_of_code_.empty()) {
      const auto kept = static_cast<float>(std::min(x, 255.0));
      largest_ = std::max(largest_, kept);
      return kept;
    }
    const auto largest = static_cast<double>(linear_of_code_.size() - 1);
    return linear_of_code_[static_cast<std::size_t>(std::min(x, largest))];
  }
  [[nodiscard]] float scaled_part(float x) const {
    return is_in_bytes() ? static_cast<float>(linear_of_srgb(x / 255)) : std::min(x, 1.0f);
  }

  std::vector<float> linear_of_code_;  ///< empty for float colours
  float largest_ = 0;                  ///< the largest float
};

}  // namespace raysheaf::io
