#include "scene_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "values.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

std::string beside(const std::string& file, const std::string& name) {
  return (fs::path(file).parent_path() / name).string();
}

/// 0 of what is no file, as folders.
std::uintmax_t size_of_file(const std::string& path) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  return failed ? 0 : size;
}

std::string text_of_file(const std::string& path) {
  std::string text(size_of_file(path), ' ');
  std::ifstream(path, std::ios::binary)
      .read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

/// The JSON of a .glb, which is its first chunk.
std::string first_chunk(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 20> head{};
  std::uint32_t size = 0;
  if (!file.read(head.data(), head.size())) return "";
  std::memcpy(&size, head.data() + 12, sizeof size);
  if (size > size_of_file(path)) return "";
  std::string text(size, ' ');
  file.read(text.data(), size);
  return text;
}

/// The strings behind `key` wherever it stands in a JSON text, data URIs left out.
Names strings_of(const std::string& json, const std::string& key) {
  const std::string quoted = '"' + key + '"';
  const auto skip = [&json](std::size_t at) {
    return std::min(json.find_first_not_of(" \t\r\n", at), json.size());
  };
  Names strings;
  for (std::size_t at = 0; (at = json.find(quoted, at)) != json.npos;) {
    const std::size_t colon = skip(at += quoted.size());
    const std::size_t begin = skip(colon + 1);
    if (colon >= json.size() || json[colon] != ':' || begin >= json.size() || json[begin] != '"')
      continue;
    std::size_t end = begin + 1;
    while (end < json.size() && json[end] != '"') end += json[end] == '\\' ? 2 : 1;
    if (end >= json.size()) break;
    if (json.compare(begin + 1, 5, "data:") != 0) {
      const auto value =
          nlohmann::json::parse(json.substr(begin, end + 1 - begin), nullptr, /*throw*/ false);
      if (value.is_string()) strings.push_back(value);
    }
    at = end;
  }
  return strings;
}

std::string without_percent(const std::string& uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const std::string digits = uri.substr(i, 3);
    if (digits.size() == 3 && digits[0] == '%' && std::isxdigit(digits[1]) != 0 &&
        std::isxdigit(digits[2]) != 0) {
      name += static_cast<char>(std::stoi(digits.substr(1), nullptr, 16));
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

Names named_by_gltf(const std::string& path, const std::string& json) {
  Names names;
  for (const std::string& uri : strings_of(json, "uri"))
    names.push_back(beside(path, without_percent(uri)));
  return names;
}

/// Of the lines of an OBJ or MTL file that begin with a word which `is_wanted`: what follows it,
/// and the last word, before which options may stand.
template <typename Wanted>
Names named_in_lines(const std::string& path, Wanted is_wanted) {
  Names names;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::string_view all = line;
    const std::size_t begin = std::min(all.find_first_not_of(" \t"), all.size());
    const std::size_t end = std::min(all.find_first_of(" \t", begin), all.size());
    if (!is_wanted(all.substr(begin, end - begin))) continue;
    std::string rest = line.substr(std::min(all.find_first_not_of(" \t", end), all.size()));
    while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) rest.pop_back();
    if (rest.empty()) continue;
    names.push_back(beside(path, rest));
    names.push_back(beside(path, rest.substr(rest.find_last_of(" \t") + 1)));
  }
  return names;
}

Names named_by_obj(const std::string& path) {
  Names names = named_in_lines(path, [](std::string_view word) { return word == "mtllib"; });
  const std::size_t libraries = names.size();
  for (std::size_t i = 0; i < libraries; ++i) {
    const Names maps = named_in_lines(names[i], [](std::string_view word) {
      return word.starts_with("map_") || word == "bump" || word == "norm" || word == "disp" ||
             word == "decal" || word == "refl";
    });
    names.insert(names.end(), maps.begin(), maps.end());
  }
  return names;
}

Names named_by_sequence(const std::string& path) {
  const std::string json = text_of_file(path);
  Names names;
  for (const std::string& frame : strings_of(json, "file")) names.push_back(beside(path, frame));
  for (const std::string& still : strings_of(json, "static")) {
    names.push_back(beside(path, still));
    if (has_ending(still, ".json")) continue;  // a sequence does not stand still
    const Names of_still = files_named_by(names.back());
    names.insert(names.end(), of_still.begin(), of_still.end());
  }
  return names;
}

}  // namespace

std::vector<std::string> files_named_by(const std::string& scene) {
  if (has_ending(scene, ".gltf")) return named_by_gltf(scene, text_of_file(scene));
  if (has_ending(scene, ".glb")) return named_by_gltf(scene, first_chunk(scene));
  if (has_ending(scene, ".obj")) return named_by_obj(scene);
  if (has_ending(scene, ".json")) return named_by_sequence(scene);
  return {};
}

}  // namespace raysheaf::app
