// The appearance of the interface.
#pragma once

#include <imgui.h>

namespace raysheaf::viewer {

inline const ImVec4 kAccent{0.95f, 0.68f, 0.28f, 1};
inline const ImVec4 kDim{0.62f, 0.64f, 0.68f, 1};
inline const ImVec4 kFailure{1.0f, 0.45f, 0.40f, 1};

/// Sets colours, sizes and a font for a display of that scale; call it again whenever the scale
/// changes, between frames. Uses a scalable font of the system, if one is installed.
void apply_theme(float scale);

}  // namespace raysheaf::viewer
