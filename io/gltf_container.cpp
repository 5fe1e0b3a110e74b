#include <cstring>

#include "io/gltf_json.h"
#include "io/refuse.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

constexpr std::uint32_t kMagic = 0x46546c67;   // "glTF"
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

/// Where the chunk after one that ends at `end` begins: at the next multiple of four, or at once,
/// as some writers have it.
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

}  // namespace

GltfParts split_gltf(const GltfBytes& file) {
  if (file.size() >= 4 && read_u32(file, 0) == kMagic) return split_glb(file);
  return {file, {}, false};
}

}  // namespace raysheaf::io
