#include <vector>

#include "io/block_format.h"
#include "io/file_parts.h"
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

  std::string path;
  BlockFileOptions options;
  io::FileWriter file;
  std::vector<io::BlockEntry> index;
  std::uint64_t triangles = 0;
};

BlockFileWriter::BlockFileWriter(const std::string& path, const BlockFileOptions& options) {
  if (options.compress && !can_compress_blocks())
    throw Error(ErrorCode::kUnsupported, "this build has no Zstandard to compress blocks with",
                path);
  impl_ = std::make_unique<Impl>(path, options);
  // Its place; `finish` fills it.
  impl_->file.append(io::Bytes(sizeof(io::FileHead)));
}

BlockFileWriter::~BlockFileWriter() = default;

void BlockFileWriter::add(const TriangleBlock& block, const BlockShading& shading) {
  try {
    validate(block);
    validate(block, shading);
  } catch (const Error& error) {
    throw Error(error.code(), error.place() + ": " + error.sentence(),
                impl_->path + ": block " + std::to_string(impl_->index.size()));
  }
  io::BlockEntry entry{};
  const Box box = bounds_of(block);
  std::memcpy(entry.min, &box.min, sizeof entry.min);
  std::memcpy(entry.max, &box.max, sizeof entry.max);
  entry.triangles = static_cast<std::uint32_t>(block.triangles.size());
  entry.vertices = static_cast<std::uint32_t>(block.positions.size());
  entry.geometry = impl_->append(io::encode_geometry(block));
  entry.shading = impl_->append(io::encode_shading(shading));
  impl_->index.push_back(entry);
  impl_->triangles += entry.triangles;
}

void BlockFileWriter::finish(const SceneDescription& scene) {
  Impl& f = *impl_;
  validate_but_triangles(scene);
  if (!scene.environment.empty())
    throw Error(ErrorCode::kUnsupported, "block files hold no environment", f.path);
  if (f.index.empty()) throw Error(ErrorCode::kInvalidData, "the scene has no triangles", f.path);
  io::FileHead head{};
  std::memcpy(head.magic, io::kBlockMagic, sizeof head.magic);
  head.version = io::kBlockVersion;
  head.byte_order = io::kByteOrder;
  head.blocks = f.index.size();
  head.triangles = f.triangles;
  const std::span<const std::uint8_t> index(reinterpret_cast<const std::uint8_t*>(f.index.data()),
                                            f.index.size() * sizeof(io::BlockEntry));
  head.index_offset = f.file.size();
  head.index_checksum = io::checksum(index);
  f.file.append(index);
  const io::Bytes rest = io::encode_scene(scene);
  head.scene_offset = f.file.size();
  head.scene_bytes = rest.size();
  head.scene_checksum = io::checksum(rest);
  f.file.append(rest);
  head.file_bytes = f.file.size();
  head.head_checksum =
      io::checksum(io::bytes_of(head).first(sizeof head - sizeof head.head_checksum));
  f.file.overwrite(0, io::bytes_of(head));
  f.file.finish();
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
