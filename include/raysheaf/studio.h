// The look of pictures whose scene does not say it: lights for models, and a background.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "raysheaf/render.h"

namespace raysheaf {

/// Three lights that show a model's shape to `camera`, wherever the camera stands: a key light from
/// above and the left, a weaker fill light from the right, a rim light from behind. They come from
/// far away. A camera inside the scene's box gets `showing_light` instead: walls would keep light
/// from outside away.
[[nodiscard]] std::vector<Light> studio_lights(const SceneDescription& scene, const Camera& camera);

/// Whether the scene is lit by what `studio_lights` gives, and nothing else: by the lights' names.
[[nodiscard]] bool has_studio_lights(const SceneDescription& scene);

/// sRGB and alpha, not premultiplied.
using Rgba = std::array<std::uint8_t, 4>;

/// Puts a background behind the scene in place of the sky that the camera sees. Mirrors and glass
/// still show the sky.
class Backdrop {
 public:
  explicit Backdrop(Rgba color);

  /// Looks at each sample of a picture that is rendered with these options: replaces
  /// `RenderOptions::on_sample`. Must outlive the rendering.
  void watch(RenderOptions* options);

  /// `tone_mapped` of the picture that was watched, before the background: where some samples of a
  /// pixel see nothing, it shows through in proportion. An environment leaves a trace in such
  /// pixels; a uniform sky leaves none.
  [[nodiscard]] Image picture(const RenderResult& result) const;

 private:
  /// Adds 1 where the newest sample of `so_far` has seen something.
  static void count(const RenderResult& so_far, std::vector<Vec3>* normal_sums,
                    std::vector<float>* covered);

  Rgba color_;
  std::vector<Vec3> normal_sums_;  ///< of the samples before
  std::vector<float> covered_;     ///< samples that have seen something, a pixel each
};

}  // namespace raysheaf
