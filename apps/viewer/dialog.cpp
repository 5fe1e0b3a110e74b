// The dialog that opens a file.
#include <imgui.h>

#include "interface.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

std::string size_text(const FileBrowser::Entry& entry) {
  if (entry.is_folder) return "";
  return short_number(static_cast<double>(entry.bytes)) + (entry.bytes < 10000 ? " B" : "B");
}

/// Returns the entry that was chosen with a double click.
std::optional<std::size_t> draw_entries(Model& model, const FileBrowser& dialog, float scale) {
  std::optional<std::size_t> chosen;
  const float sizes_at = ImGui::GetContentRegionAvail().x - 70 * scale;
  for (std::size_t i = 0; i < dialog.entries().size(); ++i) {
    const FileBrowser::Entry& entry = dialog.entries()[i];
    const bool is_selected = i == dialog.selected();
    ImGui::PushID(static_cast<int>(i));
    const std::string label = entry.name + (entry.is_folder ? "/" : "");
    if (ImGui::Selectable(label.c_str(), is_selected, ImGuiSelectableFlags_AllowDoubleClick)) {
      model.select_file(i);
      if (ImGui::IsMouseDoubleClicked(0)) chosen = i;
    }
    if (is_selected && !ImGui::IsItemVisible()) ImGui::SetScrollHereY();
    ImGui::SameLine(sizes_at);
    ImGui::TextColored(kDim, "%s", size_text(entry).c_str());
    ImGui::PopID();
  }
  if (dialog.entries().size() < 2)
    ImGui::TextColored(kDim, "There is no scene file in this folder.");
  return chosen;
}

}  // namespace

void draw_dialog(Model& model, float scale) {
  const FileBrowser* dialog = model.dialog();
  if (dialog == nullptr) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const ImVec2 size{std::min(620 * scale, display.x - 20 * scale),
                    std::min(440 * scale, display.y - 80 * scale)};
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, 0, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowBgAlpha(1);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoResize;
  std::optional<std::size_t> chosen;
  bool is_closed = false;
  if (ImGui::Begin("open", nullptr, kFlags)) {
    ImGui::TextColored(kAccent, "Open");
    ImGui::TextWrapped("%s", dialog->folder().c_str());
    const float below = 2 * ImGui::GetFrameHeightWithSpacing();
    if (ImGui::BeginChild("entries", {0, -below}, true)) {
      chosen = draw_entries(model, *dialog, scale);
    }
    ImGui::EndChild();
    if (dialog->sentence().empty()) {
      ImGui::TextColored(kDim, "up, down: select   Enter: open   Backspace: parent folder");
    } else {
      ImGui::TextColored(kFailure, "%s", dialog->sentence().c_str());
    }
    if (ImGui::Button("Open")) chosen = dialog->selected();
    ImGui::SameLine();
    is_closed = ImGui::Button("Cancel");
  }
  ImGui::End();
  if (chosen) {
    model.choose_file(*chosen);
  } else if (is_closed) {
    model.open_dialog(false);
  }
}

}  // namespace raysheaf::viewer
