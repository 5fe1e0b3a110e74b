#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "info/info.h"
#include "report/commands.h"
#include "report/fields.h"
#include "report_page_files.h"

namespace raysheaf::app {
namespace {

std::string scene_name(const ReportPage& page) {
  const std::string& name = page.report.picture.statistics.scene;
  return name.empty() ? printable(page.command.scene) : printable(name);
}

std::uint64_t sum_of(const FrameStatistics& s, std::uint64_t (BatchStatistics::*count)() const) {
  return std::accumulate(
      s.batches.begin(), s.batches.end(), std::uint64_t{0},
      [&](std::uint64_t sum, const BatchStatistics& batch) { return sum + (batch.*count)(); });
}

std::uint64_t rays_of(const FrameStatistics& s) {
  std::uint64_t rays = 0;
  for (const BatchStatistics& batch : s.batches) rays += batch.rays;
  return rays;
}

/// "dual needed 0.05 % of them, and 120 ms for the frame", about the method with the fewest tests.
std::string best_sentence(const Report& report) {
  const MethodReport* best = nullptr;
  std::uint64_t fewest = 0;
  for (const MethodReport& method : report.methods) {
    if (!method.ran) continue;
    const std::uint64_t tests = sum_of(method.counted, &BatchStatistics::total_tests);
    if (best != nullptr && tests >= fewest) continue;
    best = &method;
    fewest = tests;
  }
  if (best == nullptr || fewest == 0) return "";
  const auto all = static_cast<double>(sum_of(best->counted, &BatchStatistics::brute_force_tests));
  return fmt::format("Method {} made {}, which is {} % of that, and took {} ms for the frame.",
                     to_string(best->method), shown_count(fewest),
                     three_digits(100 * static_cast<double>(fewest) / all),
                     shown_ms(best->times.total_ms));
}

std::string alt_of(const Layer& layer, const std::string& scene) {
  return scene + ": " + layer.title + (layer.heat ? ", in false colours" : "");
}

void set_layers(const ReportPage& page, Fields* fields) {
  const std::string scene = scene_name(page);
  Fields layers = list_of_fields();
  for (const Layer& layer : page.layers) {
    Fields one;
    one.set("id", layer.id);
    one.set("title", layer.title);
    one.set("text", layer.text);
    one.set("alt", alt_of(layer, scene));
    one.set("mean", layer.heat ? Fields(three_digits(layer.mean)) : Fields(false));
    one.set("png", base64(encode_png(layer.image)));
    layers.push_back(one);
  }
  fields->set("layers", layers);
}

void set_heat_legend(const HeatScale& scale, Fields* fields) {
  constexpr int kStops = 16;
  std::string stops;
  for (int i = 0; i < kStops; ++i) {
    const auto c = false_color(static_cast<float>(i) / (kStops - 1));
    stops += fmt::format("{}#{:02x}{:02x}{:02x}", i == 0 ? "" : ", ", c[0], c[1], c[2]);
  }
  Fields ticks = list_of_fields();
  std::string power = "1" + std::string(static_cast<std::size_t>(scale.low_exponent), '0');
  fields->set("heat_low", power);
  for (int e = scale.low_exponent; e <= scale.high_exponent; ++e, power += '0') {
    ticks.push_back(Fields("label", shown_count(std::stoull(power))));
    fields->set("heat_high", power);
  }
  fields->set("heat_ticks", ticks);
  fields->set("heat_stops", stops);
}

Fields facts(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Fields all = list_of_fields();
  for (const auto& [name, value] : pairs) {
    Fields one;
    one.set("name", name);
    one.set("value", value);
    all.push_back(one);
  }
  return all;
}

std::string triple(const Vec3& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z);
}

std::string lights(const SceneDescription& scene) {
  std::array<int, 3> counts{};
  for (const Light& light : scene.lights) ++counts[static_cast<std::size_t>(light.type)];
  std::string text = std::to_string(scene.lights.size());
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      text += fmt::format("{}{} {}", text.find(':') == std::string::npos ? ": " : ", ", counts[i],
                          type_name(static_cast<Light::Type>(i)));
  return text;
}

std::string materials(const SceneDescription& scene) {
  const auto count = [&](auto is) {
    return std::count_if(scene.materials.begin(), scene.materials.end(), is);
  };
  return fmt::format("{}: {} of metal, {} transmit light, {} emit light", scene.materials.size(),
                     count([](const Material& m) { return m.metallic >= 0.5f; }),
                     count([](const Material& m) { return m.transmission > 0; }),
                     count([](const Material& m) {
                       return m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0;
                     }));
}

void set_scene(const ReportPage& page, Fields* fields) {
  const SceneDescription& scene = page.scene;
  const SceneInfo info = gather_info(scene);
  const std::uint64_t pixels =
      std::accumulate(scene.images.begin(), scene.images.end(), std::uint64_t{0},
                      [](std::uint64_t sum, const Image& image) {
                        return sum + std::uint64_t{image.width} * image.height;
                      });
  const Vec3 size{info.bounds.max.x - info.bounds.min.x, info.bounds.max.y - info.bounds.min.y,
                  info.bounds.max.z - info.bounds.min.z};
  fields->set(
      "scene_facts",
      facts({{"Scene", printable(page.command.scene)},
             {"Triangles", shown_count(info.triangles)},
             {"Meshes", shown_count(scene.meshes.size())},
             {"Instances of meshes", shown_count(scene.instances.size())},
             {"Bounds", triple(info.bounds.min) + " to " + triple(info.bounds.max)},
             {"Size", triple(size)},
             {"Materials", materials(scene)},
             {"Lights", lights(scene)},
             {"Textures", fmt::format("{}, of {} images with {} pixels", scene.textures.size(),
                                      scene.images.size(), shown_count(pixels))},
             {"Cameras", std::to_string(scene.cameras.size())}}));
  Fields warnings = list_of_fields();
  for (const std::string& warning : scene.warnings)
    warnings.push_back(Fields("text", printable(warning)));
  fields->set("warnings", warnings);
  fields->set("has_warnings", !scene.warnings.empty());
}

void set_commands(const ReportPage& page, Fields* fields) {
  Fields commands = list_of_fields();
  commands.push_back(Fields("text", printable(command_line(page.command))));
  for (const MethodReport& method : page.report.methods)
    if (method.ran)
      commands.push_back(
          Fields("text", printable(stats_command_line(page.command, method.method))));
  fields->set("commands", commands);
}

void set_summary(const ReportPage& page, Fields* fields) {
  const FrameStatistics& s = page.report.picture.statistics;
  fields->set("version", page.machine.version);
  fields->set("date", page.machine.date);
  fields->set("scene", scene_name(page));
  fields->set("width", std::to_string(s.width));
  fields->set("height", std::to_string(s.height));
  fields->set("rays", shown_count(rays_of(s)));
  fields->set("triangles", shown_count(s.triangles));
  fields->set("brute_tests", shown_count(sum_of(s, &BatchStatistics::brute_force_tests)));
  fields->set("best_sentence", best_sentence(page.report));
  fields->set("threads", std::to_string(s.threads));
  fields->set("load_ms", shown_ms(page.report.load_ms));
  fields->set("bundle_samples", std::to_string(kBundleSamples));
  const auto ran = std::count_if(page.report.methods.begin(), page.report.methods.end(),
                                 [](const MethodReport& m) { return m.ran; });
  fields->set("several", ran > 1);
  fields->set("brute_counted", ran != std::ssize(page.report.methods));
}

}  // namespace

ReportPage make_page(const ReportCommand& command, const SceneDescription& scene,
                     const Report& report) {
  ReportPage page{command, scene, report, describe_machine(report), bundle_levels(report), {}, {}};
  page.heat = heat_scale(report);
  page.layers = make_layers(report, page.heat, gather_info(scene).bounds);
  return page;
}

std::string to_html(const ReportPage& page) {
  Fields fields;
  set_summary(page, &fields);
  set_layers(page, &fields);
  fields.set("has_heat", true);
  set_heat_legend(page.heat, &fields);
  fields.set("tests", test_plots(page.report));
  fields.set("times", time_plot(page.report));
  fields.set("bundles", bundle_plots(page.bundles));
  set_scene(page, &fields);
  fields.set("machine_facts", facts(facts_of(page.machine)));
  set_commands(page, &fields);
  fields.set("json", to_json(page));
  fields.set("css", std::string(page_files::kReportCss));
  fields.set("js", std::string(page_files::kReportJs));
  fields.set("tests_plot",
             kainjow::mustache::partial{[] { return std::string(page_files::kTestsPlotHtml); }});
  kainjow::mustache::mustache html{std::string(page_files::kReportHtml)};
  return valid_utf8(html.render(fields));
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? std::uint32_t{bytes[i + k]} : 0u;
    };
    const std::uint32_t word = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace raysheaf::app
