// Plots of times and counts, on the right.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "interface.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

struct Stage {
  const char* name;
  ImU32 color;
  double (*of)(const HistoryEntry&);
};

constexpr std::array<Stage, 6> kStages = {{
    {"primary rays", IM_COL32(120, 130, 150, 255),
     [](const HistoryEntry& e) { return e.raster_ms; }},
    {"order", IM_COL32(94, 129, 244, 255),
     [](const HistoryEntry& e) { return e.stages.raygen + e.stages.order; }},
    {"hierarchy", IM_COL32(70, 178, 157, 255),
     [](const HistoryEntry& e) { return e.stages.hierarchy; }},
    {"traverse", IM_COL32(240, 173, 72, 255),
     [](const HistoryEntry& e) { return e.stages.traverse; }},
    {"intersect", IM_COL32(226, 98, 89, 255),
     [](const HistoryEntry& e) { return e.stages.intersect; }},
    {"shade", IM_COL32(178, 130, 214, 255), [](const HistoryEntry& e) { return e.shade_ms; }},
}};

/// The next round number that is not smaller.
double ceiling_of(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power) return step * power;
  return 10 * power;
}

struct Area {
  ImVec2 min, max;

  [[nodiscard]] float x(std::size_t i, std::size_t count) const {
    const float part = static_cast<float>(i) / static_cast<float>(std::max<std::size_t>(count, 1));
    return min.x + (max.x - min.x) * part;
  }
  [[nodiscard]] float y(double part) const {
    return max.y - (max.y - min.y) * static_cast<float>(std::clamp(part, 0.0, 1.0));
  }
};

Area frame(float height, double top, const char* unit) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::Dummy({width, height});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const Area area{at, {at.x + width, at.y + height}};
  list.AddRectFilled(area.min, area.max, IM_COL32(12, 12, 16, 255), 3);
  for (const double part : {0.5, 1.0}) {
    const float y = area.y(part);
    list.AddLine({area.min.x, y}, {area.max.x, y}, IM_COL32(255, 255, 255, 22));
    char text[64];
    std::snprintf(text, sizeof text, "%s %s", short_number(top * part).c_str(), unit);
    list.AddText({area.min.x + 4, y + 1}, IM_COL32(190, 192, 198, 255), text);
  }
  return area;
}

/// One bar per image, with its stages stacked; the newest bar is on the right.
void plot_times(const std::deque<HistoryEntry>& history, float scale) {
  double largest = 0;
  for (const HistoryEntry& e : history) {
    double sum = 0;
    for (const Stage& stage : kStages) sum += stage.of(e);
    largest = std::max(largest, sum);
  }
  const double top = ceiling_of(largest);
  const Area area = frame(90 * scale, top, "ms");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const std::size_t slots = 120, empty = slots - std::min(slots, history.size());
  for (std::size_t i = 0; i < history.size(); ++i) {
    double below = 0;
    for (const Stage& stage : kStages) {
      const double above = below + stage.of(history[i]);
      list.AddRectFilled({area.x(empty + i, slots), area.y(above / top)},
                         {area.x(empty + i + 1, slots) - 0.5f, area.y(below / top)}, stage.color);
      below = above;
    }
  }
}

void legend_of_times(const HistoryEntry& last) {
  if (!ImGui::BeginTable("stages", 2, ImGuiTableFlags_SizingStretchSame)) return;
  for (const Stage& stage : kStages) {
    ImGui::TableNextColumn();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float size = ImGui::GetTextLineHeight();
    ImGui::GetWindowDrawList()->AddRectFilled(
        {at.x, at.y + 0.25f * size}, {at.x + 0.5f * size, at.y + 0.75f * size}, stage.color, 2);
    ImGui::Dummy({0.6f * size, size});
    ImGui::SameLine();
    ImGui::Text("%s %s ms", stage.name, short_number(stage.of(last)).c_str());
  }
  ImGui::EndTable();
}

void plot_tests(const std::deque<HistoryEntry>& history, float scale) {
  const auto of = [](const HistoryEntry& e) { return e.rays > 0 ? e.tests / e.rays : 0; };
  double largest = 0;
  for (const HistoryEntry& e : history) largest = std::max(largest, of(e));
  const double top = ceiling_of(largest);
  const Area area = frame(50 * scale, top, "tests per ray");
  const std::size_t slots = 120, empty = slots - std::min(slots, history.size());
  std::vector<ImVec2> points;
  for (std::size_t i = 0; i < history.size(); ++i)
    points.push_back({area.x(empty + i, slots) + 1, area.y(of(history[i]) / top)});
  ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()),
                                          ImGui::GetColorU32(kAccent), 0, 1.6f * scale);
}

void row_of(const BatchStatistics& batch) {
  const auto number = [](double value) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(short_number(value).c_str());
  };
  ImGui::TableNextColumn();
  ImGui::Text("%s %u", to_string(batch.kind), batch.bounce);
  number(static_cast<double>(batch.rays));
  const auto rays = static_cast<double>(std::max<std::uint64_t>(batch.rays, 1));
  number(static_cast<double>(batch.total_tests()) / rays);
  ImGui::TableNextColumn();
  ImGui::Text("%.3g %%", 100 * batch.relative());
  number(batch.times_ms.total());
}

void table_of(const FrameStatistics& statistics) {
  ImGui::TextColored(kAccent, "%s", statistics.method.c_str());
  ImGui::SameLine();
  ImGui::TextColored(kDim, "key %s, bound %s", statistics.key.c_str(), statistics.bound.c_str());
  constexpr ImGuiTableFlags kFlags =
      ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg | ImGuiTableFlags_NoHostExtendX;
  if (!ImGui::BeginTable("batches", 5, kFlags)) return;
  for (const char* title : {"rays of", "rays", "tests per ray", "of brute", "ms"})
    ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  for (const BatchStatistics& batch : statistics.batches) {
    if (batch.rays > 0) row_of(batch);
  }
  ImGui::EndTable();
}

}  // namespace

void draw_plots(const Model& model, float scale) {
  const Picture* picture = model.picture();
  if (picture == nullptr || model.history().empty()) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float top = bar_height(model) + 10 * scale;
  ImGui::SetNextWindowPos({display.x - 10 * scale, top}, 0, {1, 0});
  ImGui::SetNextWindowSizeConstraints({kPlotsWidth * scale, 0},
                                      {kPlotsWidth * scale, display.y - top - 50 * scale});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  if (ImGui::Begin("plots", nullptr, kFlags)) {
    ImGui::TextColored(kAccent, "Time per image, by stage");
    plot_times(model.history(), scale);
    legend_of_times(model.history().back());
    ImGui::Spacing();
    plot_tests(model.history(), scale);
    ImGui::Spacing();
    for (std::size_t side = 0; side < (picture->request.settings.split ? 2u : 1u); ++side) {
      ImGui::PushID(static_cast<int>(side));
      table_of(picture->sides[side].statistics);
      ImGui::PopID();
    }
    if (picture->request.settings.split) ImGui::TextColored(kDim, "The plots show the left side.");
  }
  ImGui::End();
}

}  // namespace raysheaf::viewer
