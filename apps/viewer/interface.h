// The interface that is drawn over the image, and its settings. Only the files of this header,
// theme.h and shell.cpp include Dear ImGui.
#pragma once

#include "model.h"

namespace raysheaf::viewer {

inline constexpr float kPanelWidth = 330, kPlotsWidth = 400;

/// Draws everything for one frame, between ImGui::NewFrame and ImGui::Render. `scale` is that of
/// the display.
void draw_interface(Model& model, float scale);

// Its parts.
/// Menus, and the size and the samples of the image.
void draw_bar(Model& model);
[[nodiscard]] float bar_height(const Model& model);
/// The window without a scene.
void draw_start(Model& model, float scale);
void draw_dialog(Model& model, float scale);
void draw_help(float scale);
void draw_settings(Model& model, float scale);
void draw_plots(const Model& model, float scale);
/// Legend, labels of a split, the bundle, the picked surface, axes, notes, the time.
void draw_overlays(Model& model, float scale);

/// "12", "3.4 k", "56 M".
[[nodiscard]] std::string short_number(double value);

}  // namespace raysheaf::viewer
