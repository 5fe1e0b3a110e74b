#include <nlohmann/json.hpp>

#include <algorithm>

#include "info/info.h"
#include "report/commands.h"
#include "report/page.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json histogram_json(const Histogram& h) {
  return {{"first_exponent", h.first},
          {"shares", h.shares},
          {"low", h.low},
          {"median", h.median},
          {"high", h.high}};
}

Json bundles_json(const std::vector<BundleLevel>& levels) {
  Json all = Json::array();
  for (const BundleLevel& level : levels)
    all.push_back({{"method", to_string(level.method)},
                   {"level", level.level},
                   {"samples", level.samples},
                   {"mean_rays", level.mean_rays},
                   {"direction_degrees", histogram_json(level.direction_degrees)},
                   {"origin_percent", histogram_json(level.origin_percent)},
                   {"looseness", histogram_json(level.loose)},
                   {"overall_looseness", level.looseness}});
  return all;
}

Json methods_json(const Report& report) {
  Json all = Json::array();
  for (const MethodReport& method : report.methods)
    all.push_back({{"method", to_string(method.method)},
                   {"ran", method.ran},
                   {"counted", Json::parse(to_json(method.counted, report.load_ms))},
                   {"timed", Json::parse(to_json(method.times, report.load_ms))}});
  return all;
}

Json machine_json(const Machine& m) {
  return {{"processor", m.processor}, {"cores", m.cores},
          {"threads", m.threads},     {"memory_bytes", m.memory_bytes},
          {"simd", m.simd},           {"opengl", m.opengl},
          {"system", m.system},       {"compiler", m.compiler}};
}

Json layers_json(const std::vector<Layer>& layers) {
  Json all = Json::array();
  for (const Layer& layer : layers) {
    Json one = {{"id", layer.id}, {"title", layer.title}};
    if (layer.heat) one["mean_tests"] = layer.mean;
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

std::string to_json(const ReportPage& page) {
  const Json all = {
      {"raysheaf", page.machine.version},
      {"date", page.machine.date},
      {"command", command_line(page.command)},
      {"methods", methods_json(page.report)},
      {"bundles", bundles_json(page.bundles)},
      {"layers", layers_json(page.layers)},
      {"heat_scale",
       {{"low_exponent", page.heat.low_exponent}, {"high_exponent", page.heat.high_exponent}}},
      {"scene", Json::parse(info_json(gather_info(page.scene)))},
      {"machine", machine_json(page.machine)}};
  const std::string text = all.dump(1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string valid_utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace raysheaf::app
