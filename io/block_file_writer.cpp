#include <vector>

#include "io/block_format.h"
#include "io/file_parts.h"
#include "io/refuse.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"

namespace raysheaf {

struct BlockFileWriter::Impl {
  Impl(const std::string& name, const BlockFileOptions& wanted)
      : path(name), options(wanted), file(name) {}

  [[nodiscard]] io::SectionPlace append(const io::Bytes& section) {
    const io::Bytes packed = options.compress ? io::compressed(section) : io::Bytes{};
    const io::Bytes& stored = packed.empty() ? section : packed;
    const io::SectionPlace place{file.size(), static_cast<std::uint32_t>(stored.size()),
                                 static_cast<std::uint32_t>(section.size()), io::checksum(stored)};
    file.append(stored);
    return place;
  }

  void add(const TriangleBlock& block, const BlockShading& shading);
  void finish(const SceneDescription& scene);

  std::string path;
  BlockFileOptions options;
  io::FileWriter file;
  std::vector<io::BlockEntry> index;
  std::uint64_t triangles = 0;
  std::uint32_t materials = 0;  ///< number of materials that the scene must have
};

BlockFileWriter::BlockFileWriter(const std::string& path, const BlockFileOptions& options) {
  if (options.compress && !can_compress_blocks())
    throw Error(ErrorCode::kUnsupported, "this build has no Zstandard to compress blocks with",
                path);
  io::within_memory(path, [&] {
    impl_ = std::make_unique<Impl>(path, options);
    // Reserves room for the head, which `finish` writes.
    impl_->file.append(io::Bytes(sizeof(io::FileHead)));
  });
}

BlockFileWriter::~BlockFileWriter() = default;

void BlockFileWriter::Impl::add(const TriangleBlock& block, const BlockShading& shading) {
  try {
    validate(block);
    validate(block, shading);
  } catch (const Error& error) {
    throw Error(error.code(), error.place() + ": " + error.sentence(),
                path + ": block " + std::to_string(index.size()));
  }
  io::BlockEntry entry{};
  const Box box = bounds_of(block);
  std::memcpy(entry.min, &box.min, sizeof entry.min);
  std::memcpy(entry.max, &box.max, sizeof entry.max);
  entry.triangles = static_cast<std::uint32_t>(block.triangles.size());
  entry.vertices = static_cast<std::uint32_t>(block.positions.size());
  entry.geometry = append(io::encode_geometry(block));
  entry.shading = append(io::encode_shading(shading));
  index.push_back(entry);
  for (const std::uint32_t material : shading.materials)
    if (material != kInvalidId) materials = std::max(materials, material + 1);
  triangles += entry.triangles;
}

void BlockFileWriter::Impl::finish(const SceneDescription& scene) {
  validate_but_triangles(scene);
  if (!scene.environment.empty())
    throw Error(ErrorCode::kUnsupported, "block files hold no environment", path);
  if (materials > scene.materials.size())
    throw Error(ErrorCode::kInvalidData,
                "a block names material " + std::to_string(materials - 1) + ", but the scene has " +
                    std::to_string(scene.materials.size()),
                path);
  if (index.empty()) throw Error(ErrorCode::kInvalidData, "the scene has no triangles", path);
  io::FileHead head{};
  std::memcpy(head.magic, io::kBlockMagic, sizeof head.magic);
  head.version = io::kBlockVersion;
  head.byte_order = io::kByteOrder;
  head.blocks = index.size();
  head.triangles = triangles;
  const std::span<const std::uint8_t> list(reinterpret_cast<const std::uint8_t*>(index.data()),
                                           index.size() * sizeof(io::BlockEntry));
  head.index_offset = file.size();
  head.index_checksum = io::checksum(list);
  file.append(list);
  const io::Bytes rest = io::encode_scene(scene);
  head.scene_offset = file.size();
  head.scene_bytes = rest.size();
  head.scene_checksum = io::checksum(rest);
  file.append(rest);
  head.file_bytes = file.size();
  head.head_checksum =
      io::checksum(io::bytes_of(head).first(sizeof head - sizeof head.head_checksum));
  file.overwrite(0, io::bytes_of(head));
  file.finish();
}

void BlockFileWriter::add(const TriangleBlock& block, const BlockShading& shading) {
  io::within_memory(impl_->path, [&] { impl_->add(block, shading); });
}

void BlockFileWriter::finish(const SceneDescription& scene) {
  io::within_memory(impl_->path, [&] { impl_->finish(scene); });
}

std::uint64_t BlockFileWriter::triangle_count() const {
  return impl_->triangles;
}
std::uint64_t BlockFileWriter::block_count() const {
  return impl_->index.size();
}
std::uint64_t BlockFileWriter::written_bytes() const {
  return impl_->file.size();
}

}  // namespace raysheaf
