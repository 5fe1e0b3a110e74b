// The textures of a scene, prepared for look-ups.
#pragma once

#include <array>
#include <vector>

#include "render/surface/texture_body.h"

namespace raysheaf {

/// Made once for each scene, O(textures): pixels stay in the description, which must outlive this.
class TextureSet {
 public:
  explicit TextureSet(const SceneDescription& scene);

  /// Converts a colour stored as sRGB to linear. White if the slot is empty. `uv`: of the mesh.
  [[nodiscard]] Vec4 color(const TextureSlot& slot, Vec2 uv) const {
    return look_up(table(), placed_texture(slot), from_srgb_.data(), uv);
  }
  /// Returns numbers as stored, from 0 to 1. Ones if the slot is empty.
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
