// What is drawn over the picture, and what can be set there. Dear ImGui is seen by the files of
// this header, theme.h and shell.cpp.
#pragma once

#include "model.h"

namespace raysheaf::viewer {

inline constexpr float kPanelWidth = 290, kPlotsWidth = 380;

/// Everything: one frame, between ImGui::NewFrame and ImGui::Render. `scale`: of the display.
void draw_interface(Model& model, float scale);

// Its parts.
void draw_settings(Model& model, float scale);
void draw_plots(const Model& model, float scale);
/// Legend, labels of a split, the bundle, what was picked, the status line and notes, the keys.
void draw_overlays(Model& model, float scale);

/// "12", "3.4 k", "56 M".
[[nodiscard]] std::string short_number(double value);

}  // namespace raysheaf::viewer
