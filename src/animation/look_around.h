// Everything that an animation shows, sampled at a few times.
#pragma once

#include <functional>

#include "raysheaf/animation.h"

namespace raysheaf {

using SeenAtATime = std::function<bool(const SceneDescription& scene)>;

/// Seeks a few evenly spaced times until `is_enough` is true of the scene; returns whether it was.
bool look_around_until(Animation& animation, const SeenAtATime& is_enough);

template <class Look>
void look_around(Animation& animation, const Look& look) {
  static_cast<void>(look_around_until(animation, [&](const SceneDescription& scene) {
    look(scene);
    return false;
  }));
}

}  // namespace raysheaf
