// Colours of the triangles of binary STL: in the two bytes behind each of them, in one of two
// dialects, 5 bits a part.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// Of triangles that have no colour.
inline constexpr Vec3 kStlGrey{0.8f, 0.8f, 0.8f};

/// What a file's 80 bytes of head say about its colours.
class StlPalette {
 public:
  explicit StlPalette(std::span<const std::uint8_t> head);

  /// Linear. Magics, whose head holds "COLOR=" and the colour of the body: red is lowest, and bit
  /// 15 asks for the body's. VisCAM and SolidView: blue is lowest, and bit 15 says that there is a
  /// colour; `kStlGrey` stands in where there is none.
  [[nodiscard]] Vec3 color_of(std::uint16_t attribute) const;
  /// The colour of a file whose triangles all have this attribute. 0 means in Magics that no
  /// triangle was given a colour: the body's counts.
  [[nodiscard]] Vec3 common_color(std::uint16_t attribute) const;

 private:
  std::optional<Vec3> body_;  ///< Magics
};

/// Gives the triangles of a mesh their colours: to their vertices, which no other has. One for all
/// becomes the material's.
template <class AnyMesh>
class StlPainter {
 public:
  StlPainter(std::span<const std::uint8_t> head, AnyMesh& mesh) : palette_(head), mesh_(mesh) {}

  /// The next triangle, whose vertices are in the mesh already.
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
