#include "render/surface/texture.h"

namespace raysheaf {

TextureSet::TextureSet(const SceneDescription& scene) {
  textures_.reserve(scene.textures.size());
  for (const Texture& texture : scene.textures) {
    const Image& image = scene.images[texture.image];
    textures_.push_back({image.rgba.data(), image.width, image.height, texture.wrap_u,
                         texture.wrap_v, texture.filter});
  }
  for (std::size_t i = 0; i < as_is_.size(); ++i) {
    const double x = static_cast<double>(i) / 255;
    as_is_[i] = static_cast<float>(x);
    // IEC 61966-2-1.
    from_srgb_[i] =
        static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
  }
}

}  // namespace raysheaf
