// The settings, on the left.
#include <imgui.h>

#include <cstdio>

#include "interface.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

constexpr float kLabelWidth = 112, kNumberWidth = 62;

/// Begins a row of the panel: the label on the left; the caller adds what belongs to it.
void label(const char* text, float scale) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  ImGui::SameLine(kLabelWidth * scale);
}

/// A setting with words, as a list to choose from.
void choice(Model& model, const char* name, const char* text, float scale) {
  const SettingField& field = *find_setting(name);
  const std::string value = field.get(model.settings);
  label(text, scale);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo((std::string("##") + name).c_str(), value.c_str())) {
    for (const std::string& word : field.words) {
      if (ImGui::Selectable(word.c_str(), word == value)) field.set(model.settings, word);
    }
    ImGui::EndCombo();
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", field.what.c_str());
}

/// A slider with its number next to it: `slide` draws it under the identifier that it is given.
template <class Slide>
void slider(const char* text, const std::string& number, float scale, const Slide& slide) {
  label(text, scale);
  ImGui::SetNextItemWidth(-kNumberWidth * scale);
  ImGui::PushID(text);
  slide("##slider");
  ImGui::PopID();
  ImGui::SameLine();
  ImGui::TextUnformatted(number.c_str());
}

void whole(const char* text, std::uint32_t& value, int low, int high, float scale) {
  slider(text, std::to_string(value), scale, [&](const char* id) {
    int shown = static_cast<int>(value);
    if (ImGui::SliderInt(id, &shown, low, high, "", ImGuiSliderFlags_AlwaysClamp))
      value = static_cast<std::uint32_t>(shown);
  });
}

void real(const char* text, float& value, float low, float high, const char* format, float scale,
          ImGuiSliderFlags flags = 0) {
  char number[40];
  std::snprintf(number, sizeof number, format, static_cast<double>(value));
  slider(text, number, scale,
         [&](const char* id) { ImGui::SliderFloat(id, &value, low, high, "", flags); });
}

void method_side(Model& model, const std::string& prefix, MethodChoice& side, float scale) {
  ImGui::PushID(prefix.c_str());
  choice(model, (prefix + "method").c_str(), "method", scale);
  const bool hierarchy = side.method == Method::kRah || side.method == Method::kCrsh;
  if (hierarchy || side.method == Method::kGl10) {
    choice(model, (prefix + "key").c_str(), "key", scale);
    choice(model, (prefix + "key-bits").c_str(), "key bits", scale);
  }
  if (hierarchy) {
    choice(model, (prefix + "bound").c_str(), "bound", scale);
    whole("levels", side.levels, 1, 8, scale);
    whole("branching", side.branching, 2, 64, scale);
    choice(model, (prefix + "mesh-culling").c_str(), "mesh culling", scale);
  }
  ImGui::PopID();
}

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextColored(kAccent, "%s", text);
  ImGui::Separator();
}

void scene_part(Model& model, float scale) {
  const SceneFacts& facts = *model.facts();
  ImGui::PushStyleColor(ImGuiCol_Text, kAccent);
  ImGui::TextWrapped("%s", facts.name.empty() ? "scene" : facts.name.c_str());
  ImGui::PopStyleColor();
  ImGui::TextColored(kDim, "%s, %s,\n%s, %s",
                     count_text(facts.triangles, "triangle", "triangles").c_str(),
                     count_text(facts.meshes, "mesh", "meshes").c_str(),
                     count_text(facts.instances, "instance", "instances").c_str(),
                     count_text(facts.lights, "light", "lights").c_str());
  if (facts.cameras.size() > 1) {
    const auto title = [&facts](std::size_t i) {
      const std::string& name = facts.cameras[i].name;
      return name.empty() ? "camera " + std::to_string(i) : name;
    };
    label("camera", scale);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::BeginCombo("##camera", title(model.camera_index()).c_str())) {
      for (std::size_t i = 0; i < facts.cameras.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(title(i).c_str(), i == model.camera_index())) model.set_camera(i);
        ImGui::PopID();
      }
      ImGui::EndCombo();
    }
  }
  for (const std::string& warning : facts.warnings) ImGui::TextWrapped("%s", warning.c_str());
}

void picture_part(Model& model, float scale) {
  ViewSettings& s = model.settings;
  heading("Image");
  choice(model, "overlay", "overlay", scale);
  real("exposure", s.exposure, -6, 6, "%+.2f", scale);
  whole("samples", s.samples, 1, 256, scale);
  choice(model, "background", "background", scale);
  choice(model, "moving", "while moving", scale);
  ImGui::Checkbox("bundle under the cursor", &s.bundle);
  if (s.bundle) choice(model, "bundle-rays", "its rays", scale);
}

void rays_part(Model& model, float scale) {
  ViewSettings& s = model.settings;
  heading("Rays and lights");
  whole("bounces", s.bounces, 0, 8, scale);
  ImGui::Checkbox("shadows", &s.shadows);
  ImGui::SameLine(160 * scale);
  ImGui::Checkbox("early out", &s.early_out);
  ImGui::Checkbox("reflections", &s.reflections);
  ImGui::SameLine(160 * scale);
  ImGui::Checkbox("refractions", &s.refractions);
  real("lights", s.light, 0, 8, "x %.2f", scale, ImGuiSliderFlags_Logarithmic);
  ImGui::Checkbox("light at the camera", &s.headlight);
}

void machine_part(Model& model, float scale) {
  ViewSettings& s = model.settings;
  heading("Machine");
  choice(model, "device", "device", scale);
  whole("threads", s.threads, 0, 64, scale);
  whole("answer in ms", s.answer_ms, 10, 400, scale);
  real("flying speed", s.speed, 0.05f, 10, "%.2f", scale, ImGuiSliderFlags_Logarithmic);
  choice(model, "up", "axis up", scale);
  choice(model, "middle-drag", "middle drag", scale);
}

}  // namespace

void draw_settings(Model& model, float scale) {
  const float height = ImGui::GetIO().DisplaySize.y, top = bar_height(model) + 10 * scale;
  ImGui::SetNextWindowPos({10 * scale, top});
  ImGui::SetNextWindowSizeConstraints({kPanelWidth * scale, 0},
                                      {kPanelWidth * scale, height - top - 10 * scale});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  if (ImGui::Begin("settings", nullptr, kFlags)) {
    if (model.facts()) scene_part(model, scale);
    heading("Method");
    method_side(model, "", model.settings.left, scale);
    ImGui::Checkbox("side by side with", &model.settings.split);
    if (model.settings.split) {
      method_side(model, "right-", model.settings.right, scale);
      real("divider", model.settings.divider, 0, 1, "%.2f", scale);
    }
    picture_part(model, scale);
    rays_part(model, scale);
    machine_part(model, scale);
  }
  ImGui::End();
}

}  // namespace raysheaf::viewer
