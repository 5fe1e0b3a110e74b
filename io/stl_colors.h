// Triangle colours of binary STL: two bytes after each triangle, in one of two dialects with 5 bits
// per channel.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// The colour of triangles without a colour.
inline constexpr Vec3 kStlGrey{0.8f, 0.8f, 0.8f};

/// The colour information in a file's header of 80 bytes.
class StlPalette {
 public:
  explicit StlPalette(std::span<const std::uint8_t> head);

  /// The linear colour of a triangle. Magics, whose header contains "COLOR=" and the body's colour:
  /// red has the lowest bits, and bit 15 selects the body's colour. VisCAM and SolidView: blue has
  /// the lowest bits, and bit 15 says that the triangle has a colour; without it, the colour is
  /// `kStlGrey`.
  [[nodiscard]] Vec3 color_of(std::uint16_t attribute) const;
  /// The colour of a file whose triangles all have this attribute. In Magics, 0 for all means that
  /// no triangle has a colour: the body's colour counts.
  [[nodiscard]] Vec3 common_color(std::uint16_t attribute) const;

 private:
  std::optional<Vec3> body_;  ///< set in the dialect of Magics
};

/// Sets the colours of a mesh's triangles at their vertices, which are not shared. A colour that
/// all triangles share becomes the material's.
template <class AnyMesh>
class StlPainter {
 public:
  StlPainter(std::span<const std::uint8_t> head, AnyMesh& mesh) : palette_(head), mesh_(mesh) {}

  /// Adds the next triangle's colour. Its vertices must be in the mesh already.
  void add(std::uint16_t attribute) {
    if (mesh_.triangles.size() == 1) first_ = attribute;
    if (mesh_.colors.empty() && attribute == first_) return;
    if (mesh_.colors.empty())
      mesh_.colors.resize(mesh_.positions.size() - 3, palette_.color_of(first_));
    for (int k = 0; k < 3; ++k) mesh_.colors.push_back(palette_.color_of(attribute));
  }
  [[nodiscard]] Vec3 base_color() const {
    return mesh_.colors.empty() ? palette_.common_color(first_) : Vec3{1, 1, 1};
  }

 private:
  StlPalette palette_;
  AnyMesh& mesh_;
  std::uint16_t first_ = 0;
};

}  // namespace raysheaf::io
