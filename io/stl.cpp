#include "io/stl.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include "io/file_parts.h"
#include "io/gltf_rules.h"
#include "io/refuse.h"
#include "io/stl_colors.h"

namespace raysheaf::io {
namespace {

constexpr std::size_t kTextBytes = 80, kHeadBytes = 84, kTriangleBytes = 50;

std::uint32_t read_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}
float read_float(const std::uint8_t* p) {
  const std::uint32_t bits = read_u32(p);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// `place()` describes the vertex for error messages.
template <class AnyMesh, class Place>
void add_vertex(AnyMesh& mesh, Vec3 p, const Place& place) {
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    refuse("the vertex is not finite", place());
  }
  mesh.positions.push_back(p);
}
template <class AnyMesh>
void add_triangle(AnyMesh& mesh) {
  const auto end = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

/// The UTF-8 byte order mark, with which some programs begin ASCII files.
constexpr std::string_view kMark = "\xef\xbb\xbf";

bool begins_with_mark(std::span<const std::uint8_t> file) {
  return file.size() >= kMark.size() && std::memcmp(file.data(), kMark.data(), kMark.size()) == 0;
}

bool begins_with_solid(std::span<const std::uint8_t> file) {
  std::size_t i = begins_with_mark(file) ? kMark.size() : 0;
  while (i < file.size() && std::isspace(file[i]) != 0) ++i;
  constexpr std::string_view kWord = "solid";
  for (std::size_t k = 0; k < kWord.size(); ++k) {
    if (i + k >= file.size() || std::tolower(file[i + k]) != kWord[k]) return false;
  }
  return true;
}

/// Whether the file's length matches its triangle count as in binary files.
bool has_binary_length(const Bytes& file) {
  return file.size() >= kHeadBytes &&
         file.size() == kHeadBytes + kTriangleBytes * std::uint64_t{read_u32(file.data() + 80)};
}
/// Binary files may also begin with "solid". If the length does not decide, a file without zero
/// bytes is text.
bool is_ascii(const Bytes& file) {
  if (!begins_with_solid(file) || has_binary_length(file)) return false;
  return std::find(file.begin(), file.end(), std::uint8_t{0}) == file.end();
}

/// Reads triangle `number` from its record in a binary file.
template <class AnyMesh>
void read_record(const std::uint8_t* record, std::uint64_t number, AnyMesh& mesh,
                 StlPainter<AnyMesh>& painter) {
  const std::uint8_t* p = record + 12;
  for (int k = 0; k < 3; ++k, p += 12) {
    add_vertex(mesh, {read_float(p), read_float(p + 4), read_float(p + 8)},
               [number] { return "triangle[" + std::to_string(number) + "]"; });
  }
  add_triangle(mesh);
  painter.add(static_cast<std::uint16_t>(p[0] | p[1] << 8));
}

Mesh read_binary(const Bytes& file, Vec3* base_color) {
  if (file.size() < kHeadBytes) refuse("the file is truncated inside its header", "STL header");
  const std::uint64_t count = read_u32(file.data() + 80);
  if (count > (file.size() - kHeadBytes) / kTriangleBytes) {
    refuse("the file is truncated: it says that it has " + std::to_string(count) +
               " triangles, but has bytes for " +
               std::to_string((file.size() - kHeadBytes) / kTriangleBytes),
           "STL header");
  }
  Mesh mesh;
  mesh.positions.reserve(3 * count);
  mesh.triangles.reserve(count);
  StlPainter<Mesh> painter({file.data(), kTextBytes}, mesh);
  for (std::uint64_t t = 0; t < count; ++t) {
    read_record(file.data() + kHeadBytes + kTriangleBytes * t, t, mesh, painter);
  }
  *base_color = painter.base_color();
  return mesh;
}

/// Reads the words of an ASCII STL. A solid's name is the rest of its line.
class AsciiReader {
 public:
  explicit AsciiReader(const Bytes& file)
      : text_(reinterpret_cast<const char*>(file.data()), file.size()),
        at_(begins_with_mark(file) ? kMark.size() : 0) {}

  std::vector<Mesh> read() {
    std::vector<Mesh> meshes;
    for (std::string word = next_keyword(); !word.empty(); word = next_keyword()) {
      if (word != "solid")
        refuse("\"" + printable(word) + "\" where a solid should begin", place());
      meshes.push_back(read_solid());
    }
    return meshes;
  }
  [[nodiscard]] bool had_colors() const { return had_colors_; }

 private:
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }

  Mesh read_solid() {
    Mesh mesh;
    mesh.name = rest_of_line();
    for (;;) {
      const std::string word = next_keyword();
      if (word == "endsolid") break;
      if (word != "facet") {
        refuse(word.empty() ? "the file is truncated: the solid has no end"
                            : "\"" + printable(word) + "\" where a facet should begin",
               place());
      }
      read_facet(mesh);
    }
    rest_of_line();
    return mesh;
  }

  void read_facet(Mesh& mesh) {
    expect("normal");
    // Skips the normal's three words, where some programs write "nan".
    for (int i = 0; i < 3; ++i) next_word();
    expect("outer"), expect("loop");
    for (int i = 0; i < 3; ++i) {
      expect("vertex");
      const float x = next_number(), y = next_number(), z = next_number();
      add_vertex(mesh, {x, y, z}, [this] { return place(); });
    }
    expect("endloop"), expect("endfacet");
    add_triangle(mesh);
  }

  /// The next keyword. Some programs write "end loop", "end facet" and "end solid"; ANSA writes
  /// lines of "color" with three numbers anywhere.
  std::string next_keyword() {
    for (;;) {
      std::string word = next_word();
      if (word == "end") return word + next_word();
      if (word != "color" && word != "colour") return word;
      had_colors_ = true;
      rest_of_line();
    }
  }

  void expect(const char* wanted) {
    const std::string word = next_keyword();
    if (word == wanted) return;
    refuse(word.empty() ? "the file is truncated: it ends before \"" + std::string(wanted) + "\""
                        : "\"" + printable(word) + "\" where \"" + wanted + "\" is needed",
           place());
  }

  float next_number() {
    const std::string word = next_word();
    const char* first = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* last = word.data() + word.size();
    float value = 0;
    const auto [stop, error] = std::from_chars(first, last, value);
    // Numbers that underflow become zero; those that overflow are refused as not finite.
    if (error == std::errc::result_out_of_range) {
      value = static_cast<float>(std::strtod(word.c_str(), nullptr));
    } else if (error != std::errc{} || stop != last) {
      refuse("\"" + printable(word) + "\" is not a number", place());
    }
    return value;
  }

  std::string next_word() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
      const bool ends =
          text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_, 2) != "\r\n");
      if (ends) ++line_;
      ++at_;
    }
    std::string word;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_++])));
    }
    return word;
  }
  std::string rest_of_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    std::string rest(text_.substr(at_, end - at_));
    at_ = end;
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!rest.empty() && blank(rest.back())) rest.pop_back();
    rest.erase(0, std::min(rest.find_first_not_of(" \t"), rest.size()));
    return rest;
  }

  std::string_view text_;
  std::size_t at_, line_ = 1;
  bool had_colors_ = false;
};

/// Names the scene's mesh and adds its material.
void name_and_paint(SceneDescription& scene, Vec3 color) {
  Material material;
  material.name = "default";
  material.double_sided = true;
  material.base_color = {color.x, color.y, color.z, 1};
  scene.materials.push_back(material);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    Mesh& mesh = scene.meshes[m];
    if (mesh.name.empty()) mesh.name = scene.name;
    mesh.materials = {0};
    scene.instances.push_back({mesh.name, m, {}});
  }
}

}  // namespace

bool may_be_stl(const Bytes& file) {
  const bool is_blank =
      std::all_of(file.begin(),
                  file.begin() + static_cast<std::ptrdiff_t>(std::min(file.size(), std::size_t{4})),
                  [](std::uint8_t byte) { return byte == 0; });
  return begins_with_solid(file) || has_binary_length(file) || is_blank;
}

SceneDescription load_stl(const Bytes& file, const SceneFile& from) {
  SceneDescription scene;
  scene.name = std::filesystem::path(from.path).stem().string();
  Vec3 color = kStlGrey;
  if (is_ascii(file)) {
    AsciiReader reader(file);
    scene.meshes = reader.read();
    if (reader.had_colors())
      scene.warnings.emplace_back("The color lines of an ASCII STL file are left out.");
  } else {
    scene.meshes.push_back(read_binary(file, &color));
  }
  std::erase_if(scene.meshes, [](const Mesh& mesh) { return mesh.triangles.empty(); });
  name_and_paint(scene, color);
  return scene;
}

std::optional<OuterScene> read_outer_stl(const std::string& path, const PackOptions& options) {
  const FileReader file(path);
  if (file.size() < kHeadBytes) return std::nullopt;
  Bytes some(kHeadBytes);
  file.read(0, some, "");
  const std::uint64_t count = read_u32(some.data() + 80);
  const bool fits = file.size() == kHeadBytes + kTriangleBytes * count;
  const auto is_blank = [](std::uint8_t c) { return std::isspace(c) != 0; };
  if (!fits && (begins_with_solid(some) || std::all_of(some.begin(), some.end(), is_blank)))
    return std::nullopt;
  if (count > (file.size() - kHeadBytes) / kTriangleBytes || 3 * count >= kInvalidId ||
      count <= options.triangles_at_once)
    return std::nullopt;
  OuterScene scene;
  scene.columns = std::make_unique<OuterColumns>(options);
  OuterMesh& mesh = scene.meshes.emplace_back(scene.columns.get());
  StlPainter<OuterMesh> painter({some.data(), kTextBytes}, mesh);
  constexpr std::uint64_t kAtOnce = 1u << 14;
  for (std::uint64_t t = 0; t < count; ++t) {
    const std::uint64_t within = t % kAtOnce;
    if (within == 0) {
      some.resize(kTriangleBytes * std::min(kAtOnce, count - t));
      file.read(kHeadBytes + kTriangleBytes * t, some, "");
    }
    read_record(some.data() + kTriangleBytes * within, t, mesh, painter);
  }
  mesh.materials.push_back(0);
  scene.rest.name = std::filesystem::path(path).stem().string();
  scene.rest.meshes.emplace_back();
  scene.rest.files = {path};
  name_and_paint(scene.rest, painter.base_color());
  return scene;
}

}  // namespace raysheaf::io
