// Totals of the counters and their JSON. docs/statistics.md describes every field.
#include "raysheaf/renderer.h"

#include <nlohmann/json.hpp>

namespace raysheaf {
namespace {

using Json = nlohmann::ordered_json;

Json level_json(const LevelStatistics& level) {
  return {{"level", level.level},
          {"tests", level.tests},
          {"hits", level.hits},
          {"misses", level.misses()}};
}

Json times_json(const StageTimes& times) {
  return {{"raygen", times.raygen},
          {"order", times.order},
          {"hierarchy", times.hierarchy},
          {"traverse", times.traverse},
          {"intersect", times.intersect}};
}

Json batch_json(const BatchStatistics& batch) {
  Json levels = Json::array();
  for (const LevelStatistics& level : batch.levels) levels.push_back(level_json(level));
  return {{"kind", to_string(batch.kind)},
          {"bounce", batch.bounce},
          {"rays", batch.rays},
          {"triangles", batch.triangles},
          {"chunks", batch.chunks},
          {"mesh_sphere_tests", batch.mesh_sphere_tests},
          {"levels", std::move(levels)},
          {"bound_tests", batch.bound_tests},
          {"ray_bound_tests", batch.ray_bound_tests},
          {"final_tests", batch.final_tests},
          {"total_tests", batch.total_tests()},
          {"brute_force_tests", batch.brute_force_tests()},
          {"relative", batch.relative()},
          {"hits", batch.hits},
          {"times_ms", times_json(batch.times_ms)},
          {"plan", batch.plan}};
}

Json sample_json(const SampleStatistics& sample) {
  return {{"rays", sample.rays},
          {"total_tests", sample.total_tests},
          {"hits", sample.hits},
          {"ms", sample.ms}};
}

}  // namespace

std::uint64_t BatchStatistics::total_tests() const {
  std::uint64_t total = bound_tests + ray_bound_tests + final_tests;
  for (const LevelStatistics& level : levels) total += level.tests;
  return total;
}

double BatchStatistics::relative() const {
  const double all = static_cast<double>(rays) * static_cast<double>(triangles);
  return all > 0 ? static_cast<double>(total_tests()) / all : 0;
}

std::string to_json(const FrameStatistics& statistics, double load_ms) {
  Json batches = Json::array();
  for (const BatchStatistics& batch : statistics.batches) batches.push_back(batch_json(batch));
  Json samples = Json::array();
  for (const SampleStatistics& sample : statistics.samples) samples.push_back(sample_json(sample));
  const Json frame = {{"scene", statistics.scene},
                      {"triangles", statistics.triangles},
                      {"meshes", statistics.meshes},
                      {"width", statistics.width},
                      {"height", statistics.height},
                      {"method", statistics.method},
                      {"key", statistics.key},
                      {"bound", statistics.bound},
                      {"device", statistics.device},
                      {"primary", statistics.primary},
                      {"threads", statistics.threads},
                      {"batches", std::move(batches)},
                      {"samples", std::move(samples)},
                      {"times_ms",
                       {{"load", load_ms},
                        {"raster", statistics.raster_ms},
                        {"shade", statistics.shade_ms},
                        {"total", statistics.total_ms}}}};
  // A scene's name comes from a file: bytes that are not UTF-8 become U+FFFD instead of causing an
  // exception.
  return frame.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_json(const UpdateStatistics& update) {
  const Json json = {
      {"moved_instances", update.moved_instances},
      {"deformed_meshes", update.deformed_meshes},
      {"replaced_meshes", update.replaced_meshes},
      {"rebound_meshes", update.rebound_meshes},
      {"placed_triangles", update.placed_triangles},
      {"tree", update.tree},
      {"times_ms",
       {{"bound", update.bound_ms}, {"place", update.place_ms}, {"tree", update.tree_ms}}}};
  return json.dump();
}

}  // namespace raysheaf
