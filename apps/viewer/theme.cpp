#include "theme.h"

#include <filesystem>

namespace raysheaf::viewer {
namespace {

constexpr float kFontSize = 15;

constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
};

void load_font(float scale) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  for (const char* path : kFonts) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) continue;
    if (fonts.AddFontFromFileTTF(path, kFontSize * scale) != nullptr) return;
  }
  ImFontConfig config;
  config.SizePixels = 13 * scale;
  fonts.AddFontDefault(&config);
}

void set_colors(ImVec4* colors) {
  const auto grey = [](float v, float alpha) { return ImVec4(v, v + 0.005f, v + 0.02f, alpha); };
  const auto accent = [](float alpha) { return ImVec4(kAccent.x, kAccent.y, kAccent.z, alpha); };
  colors[ImGuiCol_Text] = ImVec4(0.92f, 0.92f, 0.93f, 1);
  colors[ImGuiCol_TextDisabled] = kDim;
  colors[ImGuiCol_WindowBg] = grey(0.085f, 0.97f);
  colors[ImGuiCol_PopupBg] = grey(0.10f, 1);
  colors[ImGuiCol_MenuBarBg] = grey(0.10f, 1);
  colors[ImGuiCol_Border] = grey(0.25f, 0.6f);
  colors[ImGuiCol_FrameBg] = grey(0.17f, 1);
  colors[ImGuiCol_FrameBgHovered] = grey(0.24f, 1);
  colors[ImGuiCol_FrameBgActive] = grey(0.28f, 1);
  colors[ImGuiCol_TitleBg] = grey(0.10f, 1);
  colors[ImGuiCol_TitleBgActive] = grey(0.13f, 1);
  colors[ImGuiCol_CheckMark] = kAccent;
  colors[ImGuiCol_SliderGrab] = accent(0.85f);
  colors[ImGuiCol_SliderGrabActive] = kAccent;
  colors[ImGuiCol_Button] = grey(0.20f, 1);
  colors[ImGuiCol_ButtonHovered] = accent(0.45f);
  colors[ImGuiCol_ButtonActive] = accent(0.65f);
  colors[ImGuiCol_Header] = grey(0.19f, 1);
  colors[ImGuiCol_HeaderHovered] = accent(0.35f);
  colors[ImGuiCol_HeaderActive] = accent(0.55f);
  colors[ImGuiCol_Separator] = grey(0.25f, 0.7f);
  colors[ImGuiCol_PlotLines] = kAccent;
  colors[ImGuiCol_TableHeaderBg] = grey(0.14f, 1);
  colors[ImGuiCol_TableBorderLight] = grey(0.22f, 1);
}

}  // namespace

void apply_theme(float scale) {
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  set_colors(style.Colors);
  style.WindowRounding = 6;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.PopupRounding = 4;
  style.WindowPadding = {12, 10};
  style.FramePadding = {7, 3};
  style.ItemSpacing = {8, 5};
  style.WindowBorderSize = 1;
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
  load_font(scale);
}

}  // namespace raysheaf::viewer
