#include "io/json_text.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

using nlohmann::json;

/// The parser recurses, so the depth is counted before it sees the text.
void check_depth(std::span<const std::uint8_t> text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(text[i]);
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > kMaxJsonDepth) refuse("is nested more than 64 deep", "JSON");
  }
}

}  // namespace

json parse_json(std::span<const std::uint8_t> text) {
  check_depth(text);
  try {
    return json::parse(text.begin(), text.end());
  } catch (const json::exception& error) {
    // The library's sentence follows its identifier in brackets.
    const std::string_view what = error.what();
    const std::size_t start = what.find("] ");
    refuse(printable(std::string(what.substr(start == what.npos ? 0 : start + 2))).c_str(), "JSON");
  }
}

void require_object(const json& value, const std::string& place) {
  if (!value.is_object()) refuse("is not an object", place);
}

const json& member_of(const json& object, const char* name, const std::string& place) {
  const auto member = object.find(name);
  if (member == object.end()) refuse("is missing", (place.empty() ? "" : place + ".") + name);
  return *member;
}

double number_of(const json& value, const std::string& place) {
  if (!value.is_number()) refuse("is not a number", place);
  const double number = value.get<double>();
  if (!(std::fabs(number) <= double{std::numeric_limits<float>::max()}))
    refuse("is not a number that a float can hold", place);
  return number;
}

Vec3 vector_of(const json& value, const std::string& place) {
  if (!value.is_array() || value.size() != 3) refuse("is not an array of three numbers", place);
  float numbers[3];
  for (std::size_t i = 0; i < 3; ++i)
    numbers[i] = static_cast<float>(number_of(value[i], place + "[" + std::to_string(i) + "]"));
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace raysheaf::io
