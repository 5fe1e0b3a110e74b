// The bar of menus at the top, and the window without a scene.
#include <imgui.h>

#include <array>
#include <cstdio>

#include "interface.h"
#include "raysheaf/builtin_scenes.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

/// An item of a menu that acts when it is chosen.
template <class Act>
void item(const char* label, const char* key, bool is_on, bool is_possible, const Act& act) {
  if (ImGui::MenuItem(label, key, is_on, is_possible)) act();
}

void switch_item(const char* label, const char* key, bool& value) {
  if (ImGui::MenuItem(label, key, value)) value = !value;
}

/// The words of a setting, as a menu.
void words_menu(Model& model, const char* setting, const char* label) {
  if (!ImGui::BeginMenu(label)) return;
  const SettingField& field = *find_setting(setting);
  const std::string now = field.get(model.settings);
  for (const std::string& word : field.words)
    item(word.c_str(), nullptr, word == now, true, [&] { field.set(model.settings, word); });
  ImGui::EndMenu();
}

void file_menu(Model& model) {
  if (!ImGui::BeginMenu("File")) return;
  const bool is_open = model.facts().has_value();
  item("Open ...", "Ctrl + O", false, true, [&] { model.open_dialog(true); });
  item("Read again", "F5", false, is_open, [&] { model.reload(); });
  switch_item("Read again when it changes", nullptr, model.settings.reload);
  ImGui::Separator();
  item("Save image", "F12", false, is_open, [&] { model.save(); });
  ImGui::Separator();
  item("Quit", "Ctrl + Q", false, true, [&] { model.close(); });
  ImGui::EndMenu();
}

void view_menu(Model& model) {
  if (!ImGui::BeginMenu("View")) return;
  const bool is_open = model.facts().has_value();
  struct Side {
    const char *label, *key;
    ViewSide side;
  };
  constexpr std::array<Side, 7> kSides = {{{"Front", "1", ViewSide::kFront},
                                           {"Back", "Ctrl + 1", ViewSide::kBack},
                                           {"Right", "3", ViewSide::kRight},
                                           {"Left", "Ctrl + 3", ViewSide::kLeft},
                                           {"Top", "7", ViewSide::kTop},
                                           {"Bottom", "Ctrl + 7", ViewSide::kBottom},
                                           {"Isometric", "9", ViewSide::kIso}}};
  for (const Side& side : kSides)
    item(side.label, side.key, false, is_open, [&] { model.look_from(side.side); });
  ImGui::Separator();
  item("Orthographic", "5", model.rig.camera().orthographic, is_open,
       [&] { model.toggle_orthographic(); });
  item("Whole scene", "F", false, is_open, [&] { model.rig.frame(model.facts()->bounds); });
  item("First view", "R", false, is_open, [&] { model.set_camera(model.camera_index()); });
  item("Next camera", "C", false, is_open && model.facts()->cameras.size() > 1,
       [&] { model.set_camera(model.camera_index() + 1); });
  words_menu(model, "up", "Axis that points up");
  ImGui::EndMenu();
}

void show_menu(Model& model) {
  if (!ImGui::BeginMenu("Show")) return;
  ViewSettings& s = model.settings;
  switch_item("Edges of triangles", "Z", s.wireframe);
  switch_item("Grid", "G", s.grid);
  switch_item("Axes", "X", s.axes);
  words_menu(model, "background", "Background");
  switch_item("Light at the camera", "L", s.headlight);
  words_menu(model, "moving", "While moving");
  ImGui::EndMenu();
}

void laboratory_menu(Model& model) {
  if (!ImGui::BeginMenu("Laboratory")) return;
  ViewSettings& s = model.settings;
  switch_item("Settings", "Tab", s.panel);
  switch_item("Plots of times and tests", "P", s.plots);
  ImGui::Separator();
  words_menu(model, "method", "Method");
  words_menu(model, "overlay", "Overlay");
  switch_item("Two methods side by side", "V", s.split);
  switch_item("Bundle of rays under the cursor", "B", s.bundle);
  ImGui::EndMenu();
}

/// The state of the window, from the longest text to the shortest.
std::array<std::string, 3> status_of(const Model& model) {
  if (!model.facts()) return {model.loading() ? "loading ..." : "", "", ""};
  const std::string& name = model.facts()->name;
  std::string work;
  if (model.loading()) work += "   loading ...";
  if (model.saving()) work += "   saving ...";
  const Picture* picture = model.picture();
  if (picture == nullptr || model.shows_preview())
    return {name + "   preview" + work, "preview" + work, ""};
  std::string methods = picture->sides[0].statistics.method;
  if (picture->request.settings.split) methods += " | " + picture->sides[1].statistics.method;
  char text[200];
  std::snprintf(text, sizeof text, "%ux%u   %u of %u samples", picture->size.width,
                picture->size.height, picture->samples,
                picture->request.refine ? picture->request.settings.samples : 1);
  return {name + "   " + methods + "   " + text + work, text + work, work};
}

void draw_status(const Model& model) {
  const float left = ImGui::GetCursorPosX();
  const float right = ImGui::GetWindowWidth() - ImGui::GetStyle().WindowPadding.x;
  for (const std::string& text : status_of(model)) {
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    if (left + width > right) continue;
    ImGui::SetCursorPosX(right - width);
    ImGui::TextColored(kDim, "%s", text.c_str());
    return;
  }
}

}  // namespace

float bar_height(const Model& model) {
  return model.settings.bar ? ImGui::GetFrameHeight() : 0;
}

void draw_bar(Model& model) {
  if (!ImGui::BeginMainMenuBar()) return;
  file_menu(model);
  view_menu(model);
  show_menu(model);
  laboratory_menu(model);
  switch_item("Keys", nullptr, model.settings.help);
  draw_status(model);
  ImGui::EndMainMenuBar();
}

void draw_start(Model& model, float scale) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, 0, {0.5f, 0.5f});
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
      ImGuiWindowFlags_NoBackground;
  if (ImGui::Begin("start", nullptr, kFlags)) {
    ImGui::SetWindowFontScale(2);
    ImGui::TextUnformatted(model.loading() ? "Loading ..." : "Drop a file here");
    ImGui::SetWindowFontScale(1);
    ImGui::TextColored(kDim, "glTF, OBJ, PLY, STL, or a sequence of files");
    ImGui::Dummy({1, 6 * scale});
    if (ImGui::Button("Open a file (Ctrl + O)")) model.open_dialog(true);
    ImGui::Dummy({1, 6 * scale});
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(kDim, "Built-in scenes");
    for (const std::string& name : builtin_scene_names()) {
      ImGui::SameLine();
      if (ImGui::Button(name.c_str())) model.load("builtin:" + name);
    }
  }
  ImGui::End();
}

}  // namespace raysheaf::viewer
