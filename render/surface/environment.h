// An environment prepared for importance sampling.
#pragma once

#include <vector>

#include "raysheaf/scene_description.h"
#include "render/surface/environment_body.h"

namespace raysheaf {

class Executor;

/// Made once for each scene, O(texels), 4 bytes per texel: the radiance stays in the description,
/// which must outlive this. A texel is chosen in proportion to its solid angle and to the mean
/// luminance of its bilinear interpolation, so that no bright texel has probability 0.
class EnvironmentMap {
 public:
  EnvironmentMap(const Executor& executor, const Environment& environment);

  [[nodiscard]] const EnvironmentView& view() const { return view_; }

 private:
  EnvironmentView view_;
  std::vector<float> row_ends_, texel_ends_;
};

}  // namespace raysheaf
