#include "io/ply_header.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "io/gltf_rules.h"
#include "io/named_file.h"
#include "io/text_lines.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

PlyType type_named(std::string_view name, const std::string& place) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const auto& [text, type] : kNames) {
    if (text == name) return type;
  }
  throw Error(ErrorCode::kInvalidData,
              "\"" + printable(std::string(name)) + "\" is not a type of PLY", place);
}

/// Blender's exporter (2.47) wrote "Created by ..." without "comment" before it.
bool is_remark(std::string_view word) {
  return word == "comment" || word == "obj_info" || word == "Created";
}

/// Gaussian splats, in their two usual forms.
bool holds_splats(const PlyElement& vertices) {
  const auto has = [&](const char* name) { return vertices.find(name) >= 0; };
  return (has("f_dc_0") && has("scale_0") && has("rot_0")) ||
         (has("packed_position") && has("packed_scale"));
}

class HeaderReader {
 public:
  HeaderReader(std::span<const std::uint8_t> file, std::uint64_t file_bytes)
      : text_(reinterpret_cast<const char*>(file.data()), file.size()), file_bytes_(file_bytes) {}

  PlyHeader read() {
    find_line_end();
    if (next_line() != "ply") refuse("the file does not begin with \"ply\"");
    bool has_format = false;
    for (;;) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty()) continue;
      if (is_remark(words[0])) {
        read_remark(line);
        continue;
      }
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        read_format(words);
        has_format = true;
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        refuse("\"" + printable(std::string(words[0])) + "\" is not a word of a PLY header");
      }
    }
    if (!has_format) refuse("the header has no format line");
    header_.bytes = at_;
    check_counts();
    return std::move(header_);
  }

 private:
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  [[noreturn]] void refuse(const std::string& sentence) const {
    throw Error(ErrorCode::kInvalidData, sentence, place());
  }

  /// Rhinoceros ends lines with "\r", as old Macintoshes did. The body may contain any byte, so the
  /// end of the first line determines the end of all header lines.
  void find_line_end() {
    const std::size_t end = std::min(text_.find_first_of("\r\n"), text_.size());
    if (text_.substr(end, 1) == "\r" && text_.substr(end, 2) != "\r\n") line_end_ = '\r';
  }

  std::string_view next_line() {
    ++line_;
    const std::size_t end = text_.find(line_end_, at_);
    if (end == text_.npos || end > kMaxPlyHeaderBytes) refuse("the header has no end_header line");
    std::string_view line = text_.substr(at_, end - at_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at_ = end + 1;
    return trim(line);
  }

  /// MeshLab and others name images in comments.
  void read_remark(std::string_view line) {
    take_word(line);
    if (take_word(line) != "TextureFile") return;
    if (std::string name = unquoted(line); !name.empty())
      header_.textures.push_back(std::move(name));
  }

  void read_format(const std::vector<std::string_view>& words) {
    const std::string_view name = words.size() > 1 ? words[1] : "";
    if (name == "ascii")
      header_.format = PlyFormat::kAscii;
    else if (name == "binary_little_endian")
      header_.format = PlyFormat::kLittleEndian;
    else if (name == "binary_big_endian")
      header_.format = PlyFormat::kBigEndian;
    else
      refuse("\"" + printable(std::string(name)) + "\" is not a format of PLY");
  }

  void read_element(const std::vector<std::string_view>& words) {
    PlyElement element;
    const std::string_view number = words.size() > 2 ? words[2] : "";
    const char* end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(number.data(), end, element.count);
    if (words.size() != 3 || error != std::errc{} || stop != end) {
      refuse("an element line has a name and a count");
    }
    element.name = words[1];
    header_.elements.push_back(std::move(element));
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) refuse("a property comes before the first element");
    PlyProperty property;
    property.is_list = words.size() > 1 && words[1] == "list";
    if (words.size() != (property.is_list ? 5u : 3u))
      refuse("the property line has a wrong length");
    property.type = type_named(words[words.size() - 2], place());
    if (property.is_list) {
      property.count_type = type_named(words[2], place());
      if (property.count_type >= PlyType::kFloat32) refuse("a list's count must be an integer");
    }
    property.name = words.back();
    header_.elements.back().properties.push_back(std::move(property));
  }

  /// The fewest bytes that an element takes: in ASCII a digit and a blank for each number.
  [[nodiscard]] std::uint64_t least_bytes(const PlyElement& element) const {
    std::uint64_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
      const PlyType type = property.is_list ? property.count_type : property.type;
      bytes += header_.format == PlyFormat::kAscii ? 2 : size_of(type);
    }
    return bytes;
  }
  void check_counts() const {
    const std::uint64_t left = file_bytes_ - at_ + 1;
    for (const PlyElement& element : header_.elements) {
      const std::uint64_t least = least_bytes(element);
      if (element.count == 0) continue;
      if (least == 0 || element.count > left / least) {
        throw Error(ErrorCode::kInvalidData,
                    "says " + std::to_string(element.count) + ", more than the " +
                        std::to_string(left - 1) + " bytes after the header can hold",
                    "element " + printable(element.name));
      }
    }
  }

  std::string_view text_;
  std::uint64_t file_bytes_;
  std::size_t at_ = 0, line_ = 0;
  char line_end_ = '\n';
  PlyHeader header_;
};

}  // namespace

void check_faces(const PlyHeader& header) {
  const PlyElement* vertices = header.find("vertex");
  if (vertices == nullptr || vertices->count == 0) return;
  for (const char* name : {"face", "tristrips"})
    if (const PlyElement* faces = header.find(name); faces != nullptr && faces->count > 0) return;
  const bool splats = holds_splats(*vertices);
  const bool has_places =
      vertices->find("x") >= 0 && vertices->find("y") >= 0 && vertices->find("z") >= 0;
  if (!splats && !has_places) return;
  throw Error(ErrorCode::kInvalidData, "holds " + std::to_string(vertices->count) +
                                           (splats ? " Gaussian splats" : " points") +
                                           " and no faces; raysheaf renders triangles");
}

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& one) { return one.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

std::size_t size_of(PlyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

PlyHeader read_ply_header(std::span<const std::uint8_t> file, std::uint64_t file_bytes) {
  return HeaderReader(file, file_bytes).read();
}

}  // namespace raysheaf::io
