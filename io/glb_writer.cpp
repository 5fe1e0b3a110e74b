#include "io/glb_writer.h"

#include <algorithm>
#include <bit>

#include "io/refuse.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace io {

static_assert(std::endian::native == std::endian::little, "GLB is little-endian, and so are we");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8);

std::size_t GlbParts::add(const char* list, const Json& item) {
  auto& items = lists[list];
  items.push_back(item);
  return items.size() - 1;
}

std::size_t GlbParts::find_or_add(const char* list, const Json& item) {
  const auto& items = lists[list];
  const auto known = std::find(items.begin(), items.end(), item);
  return known == items.end() ? add(list, item) : static_cast<std::size_t>(known - items.begin());
}

std::size_t GlbParts::add_view(std::span<const std::uint8_t> bytes, int target) {
  binary.resize((binary.size() + 3) / 4 * 4);
  const std::size_t offset = binary.size();
  binary.insert(binary.end(), bytes.begin(), bytes.end());
  JsonObject view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target != 0) view.add("target", target);
  return add("bufferViews", view);
}

namespace {

void append_u32(Bytes& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}
void append_chunk(Bytes& glb, const char* type, std::span<const std::uint8_t> bytes,
                  std::uint8_t padding) {
  const std::size_t padded = (bytes.size() + 3) / 4 * 4;
  append_u32(glb, padded);
  glb.insert(glb.end(), type, type + 4);
  glb.insert(glb.end(), bytes.begin(), bytes.end());
  glb.insert(glb.end(), padded - bytes.size(), padding);
}

Json array_of(const auto& items) {
  JsonArray array;
  for (const auto& item : items) array.add(item);
  return array;
}

Json root_of(const GlbParts& parts) {
  JsonObject root{{"asset", JsonObject{{"version", "2.0"}, {"generator", "raysheaf"}}},
                  {"buffers", JsonArray{JsonObject{{"byteLength", parts.binary.size()}}}},
                  {"scene", 0}};
  if (!parts.extensions.empty()) root.add("extensionsUsed", array_of(parts.extensions));
  for (const auto& [name, items] : parts.lists) root.add(name, array_of(items));
  if (!parts.lights.empty()) {
    const Json punctual = JsonObject{{"lights", array_of(parts.lights)}};
    root.add("extensions", JsonObject{{"KHR_lights_punctual", punctual}});
  }
  return root;
}

Bytes assemble(const GlbParts& parts) {
  const std::string text = root_of(parts).text();
  const std::size_t total = 12 + 8 + (text.size() + 3) / 4 * 4 + 8 + (parts.binary.size() + 3);
  if (total > kMaxFileBytes) {
    throw Error(ErrorCode::kUnsupported, "the scene does not fit into the 4 GiB of a GLB");
  }
  Bytes glb;
  glb.reserve(total);
  glb.insert(glb.end(), {'g', 'l', 'T', 'F'});
  append_u32(glb, 2);
  append_u32(glb, 0);
  append_chunk(glb, "JSON", as_bytes(text), ' ');
  append_chunk(glb, "BIN", parts.binary, 0);
  for (std::size_t i = 0; i < 4; ++i) glb[8 + i] = static_cast<std::uint8_t>(glb.size() >> (8 * i));
  return glb;
}

Bytes encode_glb(const SceneDescription& scene) {
  validate(scene);
  GlbParts parts;
  write_meshes(scene, parts);
  write_materials(scene, parts);
  write_nodes(scene, parts);
  return assemble(parts);
}

}  // namespace
}  // namespace io

void save_glb(const SceneDescription& scene, const std::string& path) {
  io::within_memory(path, [&] {
    io::Bytes glb;
    try {
      glb = io::encode_glb(scene);
    } catch (const Error& error) {
      throw Error(error.code(), error.sentence(),
                  error.place().empty() ? path : path + ": " + error.place());
    }
    io::write_file(path, glb);
  });
}

}  // namespace raysheaf
