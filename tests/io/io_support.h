// A temporary folder for each test, and helpers that write files into it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::test {

using Bytes = std::vector<std::uint8_t>;

class IoTest : public ::testing::Test {
 protected:
  IoTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("raysheaf_") + info->test_suite_name() + "_" + info->name() +
                       "_" + std::to_string(::getpid());
    for (char& c : name) c = c == '/' ? '_' : c;
    folder_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~IoTest() override {
    std::error_code ignored;
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  std::string write(const std::string& name, const Bytes& bytes) const {
    return write(name, std::string(bytes.begin(), bytes.end()));
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_;
};

/// Expects that loading fails with this code and that what() contains each of these words.
inline void expect_refused(const std::string& path, ErrorCode code,
                           const std::vector<std::string>& words) {
  try {
    static_cast<void>(load_scene(path));
    ADD_FAILURE() << path << " was read";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(error.code(), code) << what;
    EXPECT_TRUE(what.starts_with(path)) << what;
    for (const std::string& word : words) {
      EXPECT_NE(what.find(word), what.npos) << "no \"" << word << "\" in: " << what;
    }
  }
}

/// Replaces every "\n" by `end`.
inline std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string changed;
  for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
  return changed;
}

inline bool warns(const SceneDescription& scene, const std::string& word) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(word) != warning.npos) return true;
  }
  return false;
}

template <class T>
void append(Bytes& bytes, T value) {
  std::uint8_t raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}
template <class T>
void append_swapped(Bytes& bytes, T value) {
  std::uint8_t raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  for (std::size_t i = sizeof value; i-- > 0;) bytes.push_back(raw[i]);
}

std::string base64(const Bytes& bytes);

/// A glTF file under construction: JSON and one buffer.
class GltfFile {
 public:
  GltfFile() { json["asset"]["version"] = "2.0"; }

  std::size_t add(const char* list, nlohmann::json item) {
    json[list].push_back(std::move(item));
    return json[list].size() - 1;
  }
  template <class T>
  std::size_t view(const std::vector<T>& values) {
    while (buffer.size() % 4 != 0) buffer.push_back(0);
    const std::size_t offset = buffer.size();
    for (const T& value : values) append(buffer, value);
    return add("bufferViews",
               {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", buffer.size() - offset}});
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, const char* type, int component,
                       std::size_t width, bool normalized = false) {
    return add("accessors", {{"bufferView", view(values)},
                             {"componentType", component},
                             {"count", values.size() / width},
                             {"type", type},
                             {"normalized", normalized}});
  }
  std::size_t positions(const std::vector<float>& values) {
    return accessor(values, "VEC3", 5126, 3);
  }
  /// Adds a mesh of one primitive, a node, and the scene that shows it.
  void show(const nlohmann::json& primitive) {
    const std::size_t mesh = add("meshes", {{"primitives", {primitive}}});
    node({{"mesh", mesh}});
  }
  void node(const nlohmann::json& node) { roots.push_back(add("nodes", node)); }
  /// A triangle in the plane z = 0.
  void show_triangle() {
    show({{"attributes", {{"POSITION", positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
  }

  [[nodiscard]] std::string text(const std::string& uri = {}) const {
    nlohmann::json whole = finished();
    const std::string data = "data:application/octet-stream;base64," + base64(buffer);
    if (!buffer.empty()) whole["buffers"][0]["uri"] = uri.empty() ? data : uri;
    return whole.dump();
  }
  /// `beyond`: how many bytes after a multiple of four the first chunk ends and the second begins.
  [[nodiscard]] Bytes glb(std::size_t beyond = 0) const {
    std::string text = finished().dump();
    while (text.size() % 4 != beyond) text += ' ';
    Bytes padded = buffer;
    while (padded.size() % 4 != 0) padded.push_back(0);
    Bytes out = {'g', 'l', 'T', 'F'};
    append(out, std::uint32_t{2});
    append(out, static_cast<std::uint32_t>(28 + text.size() + padded.size()));
    append(out, static_cast<std::uint32_t>(text.size()));
    for (const char c : std::string("JSON") + text) out.push_back(static_cast<std::uint8_t>(c));
    append(out, static_cast<std::uint32_t>(padded.size()));
    for (const char c : std::string("BIN\0", 4)) out.push_back(static_cast<std::uint8_t>(c));
    out.insert(out.end(), padded.begin(), padded.end());
    return out;
  }

  nlohmann::json json;
  Bytes buffer;
  std::vector<std::size_t> roots;

 private:
  [[nodiscard]] nlohmann::json finished() const {
    nlohmann::json whole = json;
    if (!buffer.empty() && !whole.contains("buffers")) {
      whole["buffers"][0]["byteLength"] = buffer.size();
    }
    if (!whole.contains("scenes") && !roots.empty()) {
      whole["scenes"][0]["nodes"] = roots;
      whole["scene"] = 0;
    }
    return whole;
  }
};

inline std::string base64(const Bytes& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() || k < 2 ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  // Each missing byte of the last group is one '='.
  const std::size_t missing = (3 - bytes.size() % 3) % 3;
  for (std::size_t k = 0; k < missing; ++k) text[text.size() - 1 - k] = '=';
  return text;
}

}  // namespace raysheaf::test
