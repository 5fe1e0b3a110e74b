// Text and drawings over the image.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bundle_lines.h"
#include "interface.h"
#include "projection.h"
#include "theme.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr double kNoteSeconds = 8;
constexpr ImU32 kInk = IM_COL32(235, 235, 238, 255), kPaper = IM_COL32(14, 14, 18, 215);

ImVec2 display() {
  return ImGui::GetIO().DisplaySize;
}

/// The part that the windows at both sides leave free.
struct Free {
  float left, right;

  Free(const ViewSettings& settings, float scale)
      : left((settings.panel ? kPanelWidth + 20 : 10) * scale),
        right(display().x - (settings.plots ? kPlotsWidth + 20 : 10) * scale) {}
  [[nodiscard]] float middle() const { return (left + right) / 2; }
  [[nodiscard]] float width() const { return std::max(right - left, 10.0f); }
};

/// Text on a plate; `anchor` is the part of the plate that is at `at`.
void plate(ImVec2 at, ImVec2 anchor, const std::string& text, float scale, ImU32 ink = kInk) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = 7 * scale;
  const ImVec2 min{at.x - anchor.x * (size.x + 2 * pad), at.y - anchor.y * (size.y + 2 * pad)};
  list.AddRectFilled(min, {min.x + size.x + 2 * pad, min.y + size.y + 2 * pad}, kPaper, 5 * scale);
  list.AddText({min.x + pad, min.y + pad}, ink, text.c_str());
}

/// The height that the time window takes at the bottom: nothing, one row, or a second row for the
/// clips.
float time_height(const Model& model) {
  if (!model.facts() || !model.facts()->moves()) return 0;
  const float rows = model.facts()->clips.size() > 1 ? 2 : 1;
  return rows * ImGui::GetFrameHeightWithSpacing() + 2 * ImGui::GetStyle().WindowPadding.y;
}

void draw_legend(const Picture& picture, const Free& room, float bottom, float scale) {
  if (picture.request.settings.layer != Layer::kTests) return;
  const TestScale& values = picture.scale;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float pad = 10 * scale, line = ImGui::GetTextLineHeight(), height = 12 * scale;
  const float width = std::min(360 * scale, std::max(room.width() - 4 * pad, 120 * scale));
  const ImVec2 min{room.middle() - width / 2, bottom - 92 * scale};
  list.AddRectFilled({min.x - 2 * pad, min.y - pad - line},
                     {min.x + width + 2 * pad, min.y + height + line + pad}, kPaper, 6 * scale);
  list.AddText({min.x, min.y - line - 3 * scale}, kInk, "tests per pixel");
  constexpr int kSteps = 180;
  for (int i = 0; i < kSteps; ++i) {
    const auto color = false_color((static_cast<float>(i) + 0.5f) / kSteps);
    const float x = min.x + width * static_cast<float>(i) / kSteps;
    list.AddRectFilled({x, min.y}, {x + width / kSteps + 0.5f, min.y + height},
                       IM_COL32(color[0], color[1], color[2], 255));
  }
  const auto tick = [&](double value) {
    const float x = min.x + width * values.at(value);
    const std::string text = short_number(value);
    const float wide = ImGui::CalcTextSize(text.c_str()).x;
    list.AddLine({x, min.y + height}, {x, min.y + height + 4 * scale}, kInk);
    list.AddText({x - wide / 2, min.y + height + 4 * scale}, kInk, text.c_str());
  };
  if (values.logarithmic) {
    // The largest value gets its own label, unless it would overlap the one before it.
    double v = values.low;
    while (v < values.high) {
      if (v == values.low || values.at(v) < 0.88f) tick(v);
      v *= 10;
    }
    tick(values.high);
  } else {
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) tick(part * values.high);
  }
}

std::string side_label(const PictureSide& side) {
  double tests = 0, rays = 0;
  for (const BatchStatistics& batch : side.statistics.batches) {
    tests += static_cast<double>(batch.total_tests());
    rays += static_cast<double>(batch.rays);
  }
  char text[120];
  std::snprintf(text, sizeof text, "%s\n%s tests, %s per ray\n%s ms",
                side.statistics.method.c_str(), short_number(tests).c_str(),
                short_number(rays > 0 ? tests / rays : 0).c_str(),
                short_number(side.statistics.total_ms).c_str());
  return text;
}

void draw_split(const Picture& picture, float divider, float bottom, float scale) {
  if (picture.sides[1].image.rgba.empty()) return;
  const float x = std::floor(divider * display().x);
  ImGui::GetBackgroundDrawList()->AddLine({x, 0}, {x, display().y}, kInk, 1.5f * scale);
  const float y = bottom - 130 * scale;
  plate({x - 12 * scale, y}, {1, 1}, side_label(picture.sides[0]), scale);
  plate({x + 12 * scale, y}, {0, 1}, side_label(picture.sides[1]), scale);
}

ImU32 color_of(const WorldLine& line) {
  const auto fade = static_cast<int>(220 / (1 + line.level));
  switch (line.kind) {
    case WorldLine::Kind::kRay:
      return IM_COL32(255, 214, 110, 150);
    case WorldLine::Kind::kAskedRay:
      return IM_COL32(255, 255, 255, 255);
    case WorldLine::Kind::kHull:
      return IM_COL32(90, 200, 255, fade);
    case WorldLine::Kind::kCone:
      break;
  }
  return IM_COL32(255, 120, 190, fade);
}

void draw_bundle(const Model& model, float scale) {
  if (!model.bundle() || !model.bundle()->bundle || !model.facts()) return;
  const RayBundle& bundle = *model.bundle()->bundle;
  const Box& bounds = model.facts()->bounds;
  const Camera& camera = model.rig.camera();
  const float aspect = display().x / display().y;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (const WorldLine& line : bundle_lines(bundle, 2 * length(bounds.max - bounds.min))) {
    const auto spots = project(camera, aspect, line.from, line.to);
    if (!spots) continue;
    const auto place = [](Spot spot) {
      // Points far outside are skipped, because a float of the window system would overflow.
      const float x = std::clamp(spot.x, -50.0f, 50.0f), y = std::clamp(spot.y, -50.0f, 50.0f);
      return ImVec2(x * display().x, y * display().y);
    };
    const bool asked = line.kind == WorldLine::Kind::kAskedRay;
    list.AddLine(place(spots->from), place(spots->to), color_of(line),
                 (asked ? 2.4f : 1.3f) * scale);
  }
  std::string text = bundle.what;
  if (!bundle.volumes.empty()) {
    text += "\nbounds about";
    for (const BundleVolume& volume : bundle.volumes)
      text += (&volume == bundle.volumes.data() ? " " : ", ") + std::to_string(volume.ray_count);
    text += bundle.volumes.size() == 1 && bundle.volumes[0].ray_count == 1 ? " ray" : " rays";
  }
  plate({Free(model.settings, scale).middle(), bar_height(model) + 14 * scale}, {0.5f, 0}, text,
        scale);
}

void draw_pick(const Model& model, float scale) {
  if (!model.picked()) return;
  const Pick& pick = *model.picked();
  const auto spots =
      project(model.rig.camera(), display().x / display().y, pick.position, pick.position);
  if (!spots) return;
  const ImVec2 at{spots->from.x * display().x, spots->from.y * display().y};
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddCircle(at, 6 * scale, IM_COL32(0, 0, 0, 200), 0, 3.5f * scale);
  list.AddCircle(at, 6 * scale, ImGui::GetColorU32(kAccent), 0, 1.8f * scale);
  char text[400];
  std::snprintf(text, sizeof text,
                "%.80s, triangle %u\ninstance %.80s\nmaterial %.80s\nt = %.6g\n(%.5g, %.5g, %.5g)",
                pick.mesh.c_str(), pick.ids.prim_id, pick.instance.c_str(), pick.material.c_str(),
                pick.t, pick.position.x, pick.position.y, pick.position.z);
  const bool right = at.x > 0.6f * display().x, low = at.y > 0.6f * display().y;
  plate({at.x + (right ? -14 : 14) * scale, at.y}, {right ? 1.0f : 0.0f, low ? 1.0f : 0.0f}, text,
        scale);
}

/// The directions of the axes, in the lower left corner.
void draw_axes(const Model& model, float scale) {
  const Affine& view = model.rig.camera().to_world;
  const Vec3 right = normalized(column(view, 0)), up = normalized(column(view, 1));
  const Vec3 back = normalized(column(view, 2));
  const float reach = 30 * scale;
  const ImVec2 center{52 * scale, display().y - 52 * scale};
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddCircleFilled(center, 1.45f * reach, IM_COL32(14, 14, 18, 200), 48);
  struct Axis {
    const char* name;
    Vec3 direction;
    ImU32 color;
  };
  std::array<Axis, 3> axes = {{{"x", {1, 0, 0}, IM_COL32(235, 90, 90, 255)},
                               {"y", {0, 1, 0}, IM_COL32(120, 200, 90, 255)},
                               {"z", {0, 0, 1}, IM_COL32(100, 150, 250, 255)}}};
  // The ones that point away from the viewer first.
  std::sort(axes.begin(), axes.end(), [&](const Axis& a, const Axis& b) {
    return dot(a.direction, back) < dot(b.direction, back);
  });
  for (const Axis& axis : axes) {
    const float x = dot(axis.direction, right), y = dot(axis.direction, up);
    const ImVec2 end{center.x + reach * x, center.y - reach * y};
    list.AddLine(center, end, axis.color, 2.2f * scale);
    const ImVec2 size = ImGui::CalcTextSize(axis.name);
    const ImVec2 at{center.x + 1.25f * reach * x, center.y - 1.25f * reach * y};
    list.AddText({at.x - size.x / 2, at.y - size.y / 2}, axis.color, axis.name);
  }
}

/// Play, pause and scrub, if something moves.
void draw_time(Model& model, float scale) {
  if (!model.facts() || !model.facts()->moves()) return;
  const Free room(model.settings, scale);
  ImGui::SetNextWindowPos({room.middle(), display().y - 44 * scale}, 0, {0.5f, 1});
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing;
  const SceneFacts& facts = *model.facts();
  if (ImGui::Begin("time", nullptr, kFlags)) {
    if (ImGui::Button(model.playing() ? "pause" : "play", {56 * scale, 0}))
      model.play(!model.playing());
    ImGui::SameLine();
    auto at = static_cast<float>(model.time_s());
    ImGui::SetNextItemWidth(std::min(300 * scale, std::max(room.width() - 150 * scale, 60.0f)));
    if (ImGui::SliderFloat("##time", &at, static_cast<float>(facts.start_s),
                           static_cast<float>(model.end_s()), "%.2f s"))
      model.seek(at);
    if (facts.clips.size() > 1 && ImGui::BeginCombo("clip", facts.clips[model.clip()].c_str())) {
      for (std::uint32_t i = 0; i < facts.clips.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(facts.clips[i].c_str(), i == model.clip())) model.set_clip(i);
        ImGui::PopID();
      }
      ImGui::EndCombo();
    }
  }
  ImGui::End();
}

}  // namespace

std::string short_number(double value) {
  char text[32];
  const char* unit = "";
  for (const char* next : {" k", " M", " G", " T"}) {
    if (std::fabs(value) < 9999.5) break;
    value /= 1000;
    unit = next;
  }
  std::snprintf(text, sizeof text, std::fabs(value) < 100 ? "%.3g%s" : "%.0f%s", value, unit);
  return text;
}

void draw_overlays(Model& model, float scale) {
  const Picture* picture = model.picture();
  if (picture != nullptr) {
    const float bottom = display().y - time_height(model);
    draw_legend(*picture, Free(model.settings, scale), bottom, scale);
    draw_split(*picture, model.settings.divider, bottom, scale);
    draw_bundle(model, scale);
    draw_pick(model, scale);
  }
  if (model.settings.axes && model.facts()) draw_axes(model, scale);
  const Note& note = model.last_note();
  if (!note.text.empty() && model.now_s() - note.time_s < kNoteSeconds) {
    plate({display().x - 10 * scale, display().y - 10 * scale}, {1, 1}, note.text, scale,
          note.failure ? ImGui::GetColorU32(kFailure) : kInk);
  }
  draw_time(model, scale);
}

void draw_interface(Model& model, float scale) {
  draw_overlays(model, scale);
  if (model.settings.bar) draw_bar(model);
  if (!model.facts() && model.dialog() == nullptr) draw_start(model, scale);
  if (model.settings.panel) draw_settings(model, scale);
  if (model.settings.plots) draw_plots(model, scale);
  draw_dialog(model, scale);
  if (model.settings.help) draw_help(scale);
}

}  // namespace raysheaf::viewer
