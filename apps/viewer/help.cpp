// The list of keys.
#include <imgui.h>

#include "interface.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

void draw_key(const KeyHelp& key, float scale) {
  if (key.keys.empty()) {
    ImGui::TextColored(kAccent, "%s", key.what.c_str());
    return;
  }
  ImGui::TextUnformatted(key.keys.c_str());
  ImGui::SameLine(200 * scale);
  ImGui::TextColored(kDim, "%s", key.what.c_str());
}

}  // namespace

void draw_help(float scale) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, 0, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {display.x, display.y});
  ImGui::SetNextWindowBgAlpha(1);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  if (ImGui::Begin("keys", nullptr, kFlags)) {
    const std::vector<KeyHelp>& keys = key_help();
    // Two columns; a group stays together.
    std::size_t half = keys.size() / 2;
    while (half > 0 && !keys[half].keys.empty()) --half;
    ImGui::BeginGroup();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (i == half) {
        ImGui::EndGroup();
        ImGui::SameLine(0, 28 * scale);
        ImGui::BeginGroup();
      } else if (i > 0 && keys[i].keys.empty()) {
        ImGui::Spacing();
      }
      draw_key(keys[i], scale);
    }
    ImGui::EndGroup();
  }
  ImGui::End();
}

}  // namespace raysheaf::viewer
