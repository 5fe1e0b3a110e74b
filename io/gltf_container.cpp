#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "io/file_kind.h"
#include "io/gltf_json.h"
#include "io/refuse.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

constexpr std::uint32_t kJson = 0x4e4f534a;    // "JSON"
constexpr std::uint32_t kBinary = 0x004e4942;  // "BIN"
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

std::uint32_t read_u32(const GltfBytes& from, std::uint64_t offset) {
  Bytes scratch;
  const auto bytes = from.read(offset, 4, scratch);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8 |
         static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
}

struct Chunk {
  std::uint32_t type = 0;
  GltfBytes bytes;
};

Chunk chunk_at(const GltfBytes& glb, std::size_t at, int number) {
  const std::string place = "GLB chunk " + std::to_string(number);
  if (glb.size() - at < kChunkHeaderBytes) refuse("the chunk's header is cut off", place);
  const std::size_t length = read_u32(glb, at);
  const std::size_t left = glb.size() - at - kChunkHeaderBytes;
  if (length > left) {
    refuse("the chunk says that it has " + std::to_string(length) + " bytes, but only " +
               std::to_string(left) + " follow",
           place);
  }
  return {read_u32(glb, at + 4), glb.subspan(at + kChunkHeaderBytes, length)};
}

/// Where the chunk after one that ends at `end` begins: at the next multiple of four, or
/// immediately, because some writers omit the padding.
std::size_t chunk_after(const GltfBytes& glb, std::size_t end) {
  const bool at_once = glb.size() - end >= kChunkHeaderBytes && read_u32(glb, end + 4) == kBinary;
  return at_once ? end : (end + 3) / 4 * 4;
}

GltfParts split_glb(const GltfBytes& file) {
  if (file.size() < kHeaderBytes) refuse("the file is cut off inside its header", "GLB header");
  const std::uint32_t version = read_u32(file, 4);
  if (version != 2) {
    throw Error(ErrorCode::kUnsupported,
                "GLB version " + std::to_string(version) + " is not read, only 2", "GLB header");
  }
  const std::size_t length = read_u32(file, 8);
  if (length > file.size()) {
    refuse("the file is truncated: it says that it has " + std::to_string(length) +
               " bytes, but has " + std::to_string(file.size()),
           "GLB header");
  }
  const GltfBytes glb = file.subspan(0, length);
  if (length < kHeaderBytes) refuse("the declared length is too small", "GLB header");
  const Chunk text = chunk_at(glb, kHeaderBytes, 0);
  if (text.type != kJson) refuse("the first chunk is not JSON", "GLB chunk 0");
  GltfParts parts{text.bytes, {}, true};
  const std::size_t next = chunk_after(glb, kHeaderBytes + kChunkHeaderBytes + text.bytes.size());
  if (next >= glb.size()) return parts;
  const Chunk binary = chunk_at(glb, next, 1);
  if (binary.type == kBinary) parts.binary = binary.bytes;
  return parts;
}

bool begins_with(const GltfBytes& file, std::string_view bytes) {
  if (file.size() < bytes.size()) return false;
  Bytes scratch;
  const auto there = file.read(0, bytes.size(), scratch);
  return std::equal(bytes.begin(), bytes.end(), there.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// The kind of a file that is neither GLB nor JSON, or an empty string.
std::string foreign_kind(const GltfBytes& file) {
  using namespace std::string_view_literals;
  for (const std::string_view bytes : {"\xff\xfe"sv, "\xfe\xff"sv, "{\0"sv, "\0{"sv})
    if (begins_with(file, bytes)) return "text in UTF-16; glTF is JSON in UTF-8";
  Bytes scratch;
  const FileKind* kind =
      kind_by_content(file.read(0, std::min<std::uint64_t>(file.size(), kKindBytes), scratch));
  return kind == nullptr ? std::string() : described(*kind);
}

/// Whether the file may be JSON: its first byte after blanks and a byte order mark is a brace.
bool may_be_json(const GltfBytes& file) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  constexpr std::uint64_t kMostBlanks = 4096;
  Bytes scratch;
  const auto head = file.read(0, std::min<std::uint64_t>(file.size(), kMostBlanks), scratch);
  std::size_t i = begins_with(file, kMark) ? kMark.size() : 0;
  while (i < head.size() &&
         (head[i] == ' ' || head[i] == '\t' || head[i] == '\r' || head[i] == '\n'))
    ++i;
  return i == head.size() || head[i] == '{' || head[i] == '[';
}

}  // namespace

GltfParts split_gltf(const GltfBytes& file, bool is_glb) {
  if (begins_with(file, "glTF")) return split_glb(file);
  if (const std::string kind = foreign_kind(file); !kind.empty())
    refuse(std::string("is not a ") + (is_glb ? "GLB" : "glTF") + " file, but " + kind);
  if (!may_be_json(file)) {
    refuse(is_glb ? "is not a GLB file: it begins neither with \"glTF\" nor as JSON"
                  : "is not a glTF file: it does not begin as JSON");
  }
  return {file, {}, false};
}

}  // namespace raysheaf::io
