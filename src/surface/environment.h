// An environment made ready to be chosen from.
#pragma once

#include <vector>

#include "raysheaf/scene_description.h"
#include "surface/environment_body.h"

namespace raysheaf {

class Executor;

/// Made once a scene, O(texels), and 4 bytes a texel: the radiance stays where the description has
/// it, which must outlive this. A texel is chosen in proportion to its solid angle and the mean
/// luminance that bilinear interpolation gives it, so that nothing bright is never chosen.
class EnvironmentMap {
 public:
  EnvironmentMap(const Executor& executor, const Environment& environment);

  [[nodiscard]] const EnvironmentView& view() const { return view_; }

 private:
  EnvironmentView view_;
  std::vector<float> row_ends_, texel_ends_;
};

}  // namespace raysheaf
