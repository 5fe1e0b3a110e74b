// The values of a model that scripts can read.
#include <cstdio>
#include <functional>
#include <utility>

#include "model.h"
#include "raysheaf/error.h"

namespace raysheaf::viewer {
namespace {

std::string text_of(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

double sum(const FrameStatistics& statistics, double (*of)(const BatchStatistics&)) {
  double all = 0;
  for (const BatchStatistics& batch : statistics.batches) all += of(batch);
  return all;
}

double rays(const BatchStatistics& batch) {
  return static_cast<double>(batch.rays);
}
double tests(const BatchStatistics& batch) {
  return static_cast<double>(batch.total_tests());
}
double hits(const BatchStatistics& batch) {
  return static_cast<double>(batch.hits);
}

using Getter = std::function<std::string(const Model&)>;

/// A number of a side's statistics; 0 without a picture.
Getter counted(std::size_t side, double (*of)(const BatchStatistics&)) {
  return [side, of](const Model& m) {
    return text_of(m.picture() != nullptr ? sum(m.picture()->sides[side].statistics, of) : 0);
  };
}

Getter of_picture(double (*get)(const Picture&)) {
  return [get](const Model& m) { return text_of(m.picture() != nullptr ? get(*m.picture()) : 0); };
}

Getter of_pick(std::string (*get)(const Pick&)) {
  return [get](const Model& m) { return m.picked() ? get(*m.picked()) : std::string("nothing"); };
}

Getter of_bundle(double (*get)(const RayBundle&)) {
  return [get](const Model& m) {
    const bool there = m.bundle() && m.bundle()->bundle;
    return text_of(there ? get(*m.bundle()->bundle) : 0);
  };
}

const std::vector<std::pair<std::string, Getter>>& getters() {
  static const std::vector<std::pair<std::string, Getter>> all = {
      {"scene",
       [](const Model& m) { return m.facts() ? m.facts()->name : std::string("nothing"); }},
      {"triangles",
       [](const Model& m) {
         return text_of(m.facts() ? static_cast<double>(m.facts()->triangles) : 0);
       }},
      {"note", [](const Model& m) { return m.last_note().text; }},
      {"samples-done", of_picture([](const Picture& p) { return double(p.samples); })},
      {"picture-width", of_picture([](const Picture& p) { return double(p.size.width); })},
      {"picture-height", of_picture([](const Picture& p) { return double(p.size.height); })},
      {"picture-ms", of_picture([](const Picture& p) { return p.trace_ms; })},
      {"pictures", [](const Model& m) { return text_of(double(m.picture_count())); }},
      {"rays", counted(0, rays)},
      {"tests", counted(0, tests)},
      {"hits", counted(0, hits)},
      {"right-rays", counted(1, rays)},
      {"right-tests", counted(1, tests)},
      {"right-hits", counted(1, hits)},
      {"pick-mesh", of_pick([](const Pick& p) { return p.mesh; })},
      {"pick-triangle", of_pick([](const Pick& p) { return text_of(p.ids.prim_id); })},
      {"pick-material", of_pick([](const Pick& p) { return p.material; })},
      {"pick-t", of_pick([](const Pick& p) { return text_of(p.t); })},
      {"bundle-size", of_bundle([](const RayBundle& b) { return double(b.rays.size()); })},
      {"bundle-bounds", of_bundle([](const RayBundle& b) { return double(b.volumes.size()); })},
      {"yaw", [](const Model& m) { return text_of(m.rig.yaw() * 180 / kPi); }},
      {"pitch", [](const Model& m) { return text_of(m.rig.pitch() * 180 / kPi); }},
      {"time", [](const Model& m) { return text_of(m.time_s()); }},
      {"clip", [](const Model& m) { return text_of(double(m.clip())); }},
      {"playing", [](const Model& m) { return std::string(m.playing() ? "on" : "off"); }},
      {"camera", [](const Model& m) { return text_of(double(m.camera_index())); }},
      {"orthographic",
       [](const Model& m) { return std::string(m.rig.camera().orthographic ? "on" : "off"); }},
      {"picture-exposure", of_picture([](const Picture& p) { return double(p.exposure); })},
      {"dialog",
       [](const Model& m) {
         return m.dialog() != nullptr ? m.dialog()->folder() : std::string("closed");
       }},
      {"dialog-entry",
       [](const Model& m) {
         const bool is_open = m.dialog() != nullptr && !m.dialog()->entries().empty();
         return is_open ? m.dialog()->entries()[m.dialog()->selected()].name
                        : std::string("nothing");
       }},
  };
  return all;
}

}  // namespace

std::string count_text(std::uint64_t count, const char* one, const char* many) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ' ');
  return digits + " " + (count == 1 ? one : many);
}

std::string Model::value(const std::string& name) const {
  if (const SettingField* field = find_setting(name)) return field->get(settings);
  std::string names;
  for (const auto& [known, get] : getters()) {
    if (known == name) return get(*this);
    names += (names.empty() ? "" : ", ") + known;
  }
  throw Error(ErrorCode::kNotFound, "'" + name + "' is neither a setting nor one of " + names);
}

}  // namespace raysheaf::viewer
