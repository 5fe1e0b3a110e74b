// The settings, on the left.
#include <imgui.h>

#include <cmath>

#include "interface.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

/// A setting with words, as a list to choose from. Numbers have sliders.
void choice(Model& model, const char* name, const char* label) {
  const SettingField& field = *find_setting(name);
  const std::string value = field.get(model.settings);
  if (ImGui::BeginCombo(label, value.c_str())) {
    for (const std::string& word : field.words) {
      if (ImGui::Selectable(word.c_str(), word == value)) field.set(model.settings, word);
    }
    ImGui::EndCombo();
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", field.what.c_str());
}

void whole(const char* label, std::uint32_t& value, int low, int high) {
  int shown = static_cast<int>(value);
  if (ImGui::SliderInt(label, &shown, low, high, "%d", ImGuiSliderFlags_AlwaysClamp))
    value = static_cast<std::uint32_t>(shown);
}

void method_side(Model& model, const std::string& prefix, MethodChoice& side) {
  ImGui::PushID(prefix.c_str());
  choice(model, (prefix + "method").c_str(), "method");
  const bool hierarchy = side.method == Method::kRah || side.method == Method::kCrsh;
  if (hierarchy || side.method == Method::kGl10) {
    choice(model, (prefix + "key").c_str(), "key");
    choice(model, (prefix + "key-bits").c_str(), "key bits");
  }
  if (hierarchy) {
    choice(model, (prefix + "bound").c_str(), "bound");
    whole("levels", side.levels, 1, 8);
    whole("branching", side.branching, 2, 64);
    choice(model, (prefix + "mesh-culling").c_str(), "mesh culling");
  }
  ImGui::PopID();
}

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextColored(kAccent, "%s", text);
  ImGui::Separator();
}

void scene_part(Model& model) {
  const SceneFacts& facts = *model.facts();
  ImGui::TextColored(kAccent, "%s", facts.name.empty() ? "scene" : facts.name.c_str());
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
    if (ImGui::BeginCombo("camera", title(model.camera_index()).c_str())) {
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

void picture_part(Model& model) {
  ViewSettings& s = model.settings;
  heading("Picture");
  choice(model, "overlay", "overlay");
  ImGui::SliderFloat("exposure", &s.exposure, -6, 6, "%+.2f stops");
  whole("samples", s.samples, 1, 256);
  ImGui::Checkbox("bundle under the cursor", &s.bundle);
  if (s.bundle) choice(model, "bundle-rays", "whose");
}

void rays_part(Model& model) {
  ViewSettings& s = model.settings;
  heading("Rays and lights");
  whole("bounces", s.bounces, 0, 8);
  ImGui::Checkbox("shadows", &s.shadows);
  ImGui::SameLine();
  ImGui::Checkbox("early out", &s.early_out);
  ImGui::Checkbox("reflections", &s.reflections);
  ImGui::SameLine();
  ImGui::Checkbox("refractions", &s.refractions);
  ImGui::SliderFloat("lights", &s.light, 0, 8, "x %.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::Checkbox("light at the camera", &s.headlight);
}

void machine_part(Model& model) {
  ViewSettings& s = model.settings;
  heading("Machine");
  choice(model, "device", "device");
  whole("threads", s.threads, 0, 64);
  whole("answer in ms", s.answer_ms, 10, 400);
  ImGui::SliderFloat("speed", &s.speed, 0.05f, 10, "%.2f", ImGuiSliderFlags_Logarithmic);
  choice(model, "up", "up");
}

}  // namespace

void draw_settings(Model& model, float scale) {
  const float height = ImGui::GetIO().DisplaySize.y;
  ImGui::SetNextWindowPos({10 * scale, 10 * scale});
  ImGui::SetNextWindowSizeConstraints({kPanelWidth * scale, 0},
                                      {kPanelWidth * scale, height - 60 * scale});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  if (ImGui::Begin("settings", nullptr, kFlags)) {
    ImGui::PushItemWidth(150 * scale);
    if (model.facts()) scene_part(model);
    heading("Method");
    method_side(model, "", model.settings.left);
    ImGui::Checkbox("side by side with", &model.settings.split);
    if (model.settings.split) {
      method_side(model, "right-", model.settings.right);
      ImGui::SliderFloat("divider", &model.settings.divider, 0, 1, "%.2f");
    }
    picture_part(model);
    rays_part(model);
    machine_part(model);
    ImGui::Spacing();
    if (ImGui::Button("save image")) model.save();
    ImGui::SameLine();
    if (ImGui::Button("keys")) model.settings.help = !model.settings.help;
    ImGui::PopItemWidth();
  }
  ImGui::End();
}

}  // namespace raysheaf::viewer
