// The textures of a scene, ready to be looked up.
#pragma once

#include <array>
#include <vector>

#include "surface/texture_body.h"

namespace raysheaf {

/// Made once a scene, O(textures): pixels stay where the description has them, which must outlive
/// this.
class TextureSet {
 public:
  explicit TextureSet(const SceneDescription& scene);

  /// A colour stored as sRGB, made linear. White where the slot is empty. `uv` is the mesh's.
  [[nodiscard]] Vec4 color(const TextureSlot& slot, Vec2 uv) const {
    return look_up(table(), placed_texture(slot), from_srgb_.data(), uv);
  }
  /// Numbers stored as they are, from 0 to 1. Ones where the slot is empty.
  [[nodiscard]] Vec4 numbers(const TextureSlot& slot, Vec2 uv) const {
    return look_up(table(), placed_texture(slot), as_is_.data(), uv);
  }
  [[nodiscard]] TextureTable table() const {
    return {View<const TextureView>(textures_), from_srgb_.data(), as_is_.data()};
  }

 private:
  using Table = std::array<float, 256>;

  std::vector<TextureView> textures_;
  Table from_srgb_, as_is_;
};

}  // namespace raysheaf
