// The interface that is drawn over the image, and its settings. Only the files of this header,
// theme.h and shell.cpp include Dear ImGui.
#pragma once

#include "model.h"

namespace raysheaf::viewer {

inline constexpr float kPanelWidth = 290, kPlotsWidth = 380;

/// Draws everything for one frame, between ImGui::NewFrame and ImGui::Render. `scale` is that of
/// the display.
void draw_interface(Model& model, float scale);

// Its parts.
void draw_settings(Model& model, float scale);
void draw_plots(const Model& model, float scale);
/// Legend, labels of a split, the bundle, the picked surface, the status line and notes, the keys.
void draw_overlays(Model& model, float scale);

/// "12", "3.4 k", "56 M".
[[nodiscard]] std::string short_number(double value);

}  // namespace raysheaf::viewer
