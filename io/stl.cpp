#include "io/stl.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <span>
#include <string_view>

#include "io/file_parts.h"
#include "io/linear.h"
#include "io/polygon.h"
#include "io/refuse.h"
#include "io/stl_colors.h"
#include "io/text_lines.h"

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

/// Adds a triangle with vertices of its own, unless one is not finite. Whether it was added.
template <class AnyMesh>
bool add_triangle(const std::array<Vec3, 3>& corners, AnyMesh& mesh) {
  if (!std::all_of(corners.begin(), corners.end(), is_finite)) return false;
  for (const Vec3& corner : corners) mesh.positions.push_back(corner);
  const auto end = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
  return true;
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

std::uint64_t count_in_header(const Bytes& file) {
  return read_u32(file.data() + kTextBytes);
}
/// Whether the file's length matches its triangle count as in binary files.
bool has_binary_length(const Bytes& file) {
  return file.size() >= kHeadBytes &&
         file.size() == kHeadBytes + kTriangleBytes * count_in_header(file);
}

/// The text without what pads its end: zeros, or the character with which CP/M ended files.
std::string_view text_in(const Bytes& file) {
  std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  while (!text.empty() && (text.back() == '\0' || text.back() == '\x1a')) text.remove_suffix(1);
  return text;
}
bool is_control(char c) {
  return static_cast<unsigned char>(c) < ' ' && std::isspace(static_cast<unsigned char>(c)) == 0;
}
/// Binary files may also begin with "solid". If the length does not decide, a file without control
/// characters is text, and so is one that begins as text and has no zeros or a vertex in words.
bool is_ascii(const Bytes& file) {
  if (has_binary_length(file)) return false;
  const std::string_view text = text_in(file);
  if (std::none_of(text.begin(), text.end(), is_control)) return true;
  return begins_with_solid(file) &&
         (text.find('\0') == text.npos || in_lower_case(text).find("vertex") != text.npos);
}
/// Whether the text has two bytes for each letter.
bool is_utf16(const Bytes& file) {
  const std::string_view text = text_in(file);
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
         text.starts_with(std::string_view("s\0o\0l\0i\0d", 9)) ||
         text.starts_with(std::string_view("\0s\0o\0l\0i\0d", 10));
}

/// Reads a triangle of 50 bytes in a binary file. Whether its vertices are finite.
template <class AnyMesh>
bool read_record(const std::uint8_t* record, AnyMesh& mesh) {
  std::array<Vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint8_t* p = record + 12 + 12 * k;
    corners[k] = {read_float(p), read_float(p + 4), read_float(p + 8)};
  }
  return add_triangle(corners, mesh);
}
std::uint16_t attribute_of(const std::uint8_t* record) {
  return static_cast<std::uint16_t>(record[48] | record[49] << 8);
}

/// Reads a whole binary file.
class BinaryReader {
 public:
  BinaryReader(const Bytes& file, std::vector<std::string>& warnings)
      : file_(file), warnings_(warnings) {}

  /// Sets the material's colour, too.
  Mesh read(Vec3* base_color) {
    if (is_utf16(file_)) refuse("the text is UTF-16; UTF-8 is read", {}, ErrorCode::kUnsupported);
    if (file_.size() < kHeadBytes) refuse("the file is truncated inside its header", "STL header");
    const bool has_data = ends_after_data();
    const std::uint64_t count = has_data ? count_in_header(file_) : number_of_triangles();
    Mesh mesh;
    mesh.positions.reserve(3 * count);
    mesh.triangles.reserve(count);
    StlPainter<Mesh> painter({file_.data(), kTextBytes}, mesh);
    std::uint64_t odd = 0;
    const std::uint8_t* record = file_.data() + kHeadBytes;
    for (std::uint64_t t = 0; t < count; ++t) {
      const std::size_t data = has_data ? attribute_of(record) : 0;
      if (!read_record(record, mesh))
        ++odd;
      else if (!has_data)
        painter.add(attribute_of(record));
      record += kTriangleBytes + data;
    }
    if (has_data) warnings_.emplace_back("Data after the triangles of a binary STL are left out.");
    warn_of_odd_faces(odd, !mesh.triangles.empty(), warnings_);
    *base_color = painter.base_color();
    return mesh;
  }

 private:
  /// Whether the file ends after the last triangle's data, where a triangle's attribute is the
  /// number of bytes that follow it, and would not without these.
  [[nodiscard]] bool ends_after_data() const {
    if (has_binary_length(file_)) return false;
    std::uint64_t at = kHeadBytes;
    for (std::uint64_t t = count_in_header(file_); t > 0; --t) {
      if (file_.size() - at < kTriangleBytes) return false;
      at += kTriangleBytes + attribute_of(file_.data() + at);
      if (at > file_.size()) return false;
    }
    return at == file_.size() && at > kHeadBytes;
  }

  /// The header's number, unless the file has more whole triangles.
  std::uint64_t number_of_triangles() {
    const std::uint64_t said = count_in_header(file_), bytes = file_.size() - kHeadBytes,
                        fitting = bytes / kTriangleBytes;
    if (said > fitting) {
      refuse("the file is truncated: it says that it has " + std::to_string(said) +
                 " triangles, but has bytes for " + std::to_string(fitting),
             "STL header");
    }
    const auto rest =
        file_.begin() + static_cast<std::ptrdiff_t>(kHeadBytes + kTriangleBytes * said);
    const bool is_padded =
        std::all_of(rest, file_.end(), [](std::uint8_t byte) { return byte == 0; });
    if (!is_padded && (said == 0 || bytes % kTriangleBytes == 0)) {
      warnings_.push_back("The file says that it has " + std::to_string(said) +
                          " triangles, but has bytes for " + std::to_string(fitting) + "; " +
                          std::to_string(fitting) + " are read.");
      return fitting;
    }
    if (rest != file_.end())
      warnings_.push_back(std::to_string(file_.end() - rest) +
                          " bytes after the last triangle of a binary STL are left out.");
    return said;
  }

  const Bytes& file_;
  std::vector<std::string>& warnings_;
};

/// Reads the words of an ASCII STL. A solid's name is the rest of its line.
class AsciiReader {
 public:
  explicit AsciiReader(const Bytes& file)
      : text_(text_in(file)), at_(begins_with_mark(file) ? kMark.size() : 0) {}

  std::vector<Mesh> read() {
    std::vector<Mesh> meshes;
    for (std::string word = next_keyword(); !word.empty(); word = next_keyword()) {
      if (word != "solid" && word != "facet")
        refuse(in_quotes(word) + " where a solid should begin", place());
      const bool has_line = word == "solid";
      std::string name = has_line ? rest_of_line() : std::string();
      if (has_line) word = next_keyword();
      meshes.push_back(read_solid(std::move(name), std::move(word), !has_line));
    }
    return meshes;
  }
  /// Adds a warning for each kind of content that was left out. `any_left`: there are triangles.
  void warn(bool any_left, std::vector<std::string>& warnings) const {
    if (had_colors_) warnings.emplace_back("The color lines of an ASCII STL file are left out.");
    if (has_commas_) warnings.emplace_back(kCommaRemark);
    warn_of_odd_faces(odd_, any_left, warnings);
  }

 private:
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }

  /// `word` is the first after the name. Without a line "solid", the file's end is the solid's.
  Mesh read_solid(std::string name, std::string word, bool may_end) {
    Mesh mesh;
    mesh.name = std::move(name);
    for (; word != "endsolid"; word = next_keyword()) {
      if (word.empty() && may_end) return mesh;
      if (word != "facet") {
        refuse(word.empty() ? "the file is truncated: the solid has no end"
                            : in_quotes(word) + " where a facet should begin",
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
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) {
      expect("vertex");
      const float x = next_number(), y = next_number(), z = next_number();
      corner = {x, y, z};
    }
    expect("endloop"), expect("endfacet");
    if (!add_triangle(corners, mesh)) ++odd_;
  }

  /// The next keyword. Some programs write "end loop", "end facet" and "end solid", others
  /// comments; ANSA writes lines of "color" with three numbers anywhere.
  std::string next_keyword() {
    for (;;) {
      std::string word = next_word();
      if (word == "end") return word + next_word();
      const bool is_color = word == "color" || word == "colour";
      const bool is_comment = word.starts_with('#') || word.starts_with(';') ||
                              word.starts_with('!') || word.starts_with("//");
      if (!is_color && !is_comment) return word;
      had_colors_ = had_colors_ || is_color;
      rest_of_line();
    }
  }

  void expect(const char* wanted) {
    const std::string word = next_keyword();
    if (word == wanted) return;
    refuse(word.empty() ? "the file is truncated: it ends before \"" + std::string(wanted) + "\""
                        : in_quotes(word) + " where \"" + wanted + "\" is needed",
           place());
  }

  /// Numbers beyond the range of float are infinite, or 0.
  float next_number() {
    const std::string word = next_word();
    const std::optional<double> number = read_number(word, &has_commas_);
    if (!number) refuse(in_quotes(word) + " is not a number", place());
    return static_cast<float>(*number);
  }
  [[nodiscard]] bool is_at_blank() const {
    return std::isspace(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '\0';
  }

  std::string next_word() {
    while (at_ < text_.size() && is_at_blank()) {
      const bool ends =
          text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_, 2) != "\r\n");
      if (ends) ++line_;
      ++at_;
    }
    std::string word;
    while (at_ < text_.size() && !is_at_blank()) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_++])));
    }
    return word;
  }
  std::string rest_of_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string_view rest = text_.substr(at_, end - at_);
    at_ = end;
    return std::string(trim(rest));
  }

  std::string_view text_;
  std::size_t at_, line_ = 1;
  bool had_colors_ = false, has_commas_ = false;
  std::uint64_t odd_ = 0;
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
  scene.name = stem_of(from.path);
  Vec3 color = kStlGrey;
  if (is_ascii(file)) {
    AsciiReader reader(file);
    scene.meshes = reader.read();
    const auto has_triangles = [](const Mesh& mesh) { return !mesh.triangles.empty(); };
    reader.warn(std::any_of(scene.meshes.begin(), scene.meshes.end(), has_triangles),
                scene.warnings);
  } else {
    scene.meshes.push_back(BinaryReader(file, scene.warnings).read(&color));
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
  if (file.size() != kHeadBytes + kTriangleBytes * count || 3 * count >= kInvalidId ||
      count <= options.triangles_at_once)
    return std::nullopt;
  OuterScene scene;
  scene.columns = std::make_unique<OuterColumns>(options);
  OuterMesh& mesh = scene.meshes.emplace_back(scene.columns.get());
  StlPainter<OuterMesh> painter({some.data(), kTextBytes}, mesh);
  std::uint64_t odd = 0;
  constexpr std::uint64_t kAtOnce = 1u << 14;
  for (std::uint64_t t = 0; t < count; ++t) {
    const std::uint64_t within = t % kAtOnce;
    if (within == 0) {
      some.resize(kTriangleBytes * std::min(kAtOnce, count - t));
      file.read(kHeadBytes + kTriangleBytes * t, some, "");
    }
    const std::uint8_t* const record = some.data() + kTriangleBytes * within;
    if (read_record(record, mesh))
      painter.add(attribute_of(record));
    else
      ++odd;
  }
  warn_of_odd_faces(odd, !mesh.triangles.empty(), scene.rest.warnings);
  mesh.materials.push_back(0);
  scene.rest.name = stem_of(path);
  scene.rest.meshes.emplace_back();
  scene.rest.files = {path};
  name_and_paint(scene.rest, painter.base_color());
  return scene;
}

}  // namespace raysheaf::io
