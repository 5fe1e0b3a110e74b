#include "raysheaf/block_file.h"
#include "io/refuse.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <vector>

#include "io/block_format.h"
#include "io/file_parts.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

using io::refuse;

bool lies_in(std::uint64_t offset, std::uint64_t bytes, std::uint64_t file_bytes) {
  return offset <= file_bytes && bytes <= file_bytes - offset;
}

/// A free list of buffers, so that each reading thread reuses one instead of allocating.
class Pool {
 public:
  io::Bytes take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return {};
    io::Bytes bytes = std::move(free_.back());
    free_.pop_back();
    return bytes;
  }
  void give(io::Bytes bytes) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(bytes));
  }

 private:
  std::mutex mutex_;
  std::vector<io::Bytes> free_;
};

}  // namespace

struct BlockFile::Impl {
  explicit Impl(const std::string& name) : path(name), file(name) {
    read_head();
    read_index();
    read_scene();
  }

  void read_head() {
    if (file.size() < sizeof head)
      refuse("has " + std::to_string(file.size()) + " bytes, too few for a block file", path);
    file.read(0, {reinterpret_cast<std::uint8_t*>(&head), sizeof head}, path);
    if (std::memcmp(head.magic, io::kBlockMagic, sizeof head.magic) != 0)
      refuse("is not a block file: it does not begin with their signature", path);
    if (head.byte_order != io::kByteOrder)
      refuse("its byte order is not the one of block files", path);
    if (head.version != io::kBlockVersion)
      throw Error(ErrorCode::kUnsupported,
                  "is of version " + std::to_string(head.version) + ", and this reads version " +
                      std::to_string(io::kBlockVersion),
                  path);
    if (io::checksum(io::bytes_of(head).first(sizeof head - sizeof head.head_checksum)) !=
        head.head_checksum)
      refuse("its head is damaged: the checksum does not match", path);
    if (head.file_bytes != file.size())
      refuse("has " + std::to_string(file.size()) + " bytes, but was written with " +
                 std::to_string(head.file_bytes),
             path);
  }

  void read_index() {
    constexpr std::uint64_t kMostBlocks = 0xffffffff;
    if (head.blocks == 0 || head.blocks > kMostBlocks ||
        !lies_in(head.index_offset, head.blocks * sizeof(io::BlockEntry), head.file_bytes))
      refuse("its list of blocks lies outside the file", path);
    entries.resize(head.blocks);
    const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(entries.data()),
                                        entries.size() * sizeof(io::BlockEntry));
    file.read(head.index_offset, bytes, path);
    if (io::checksum(bytes) != head.index_checksum)
      refuse("its list of blocks is damaged: the checksum does not match", path);
    std::uint64_t triangles = 0;
    infos.reserve(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      check(entries[i], i);
      triangles += entries[i].triangles;
    }
    if (triangles != head.triangles)
      refuse("its blocks have " + std::to_string(triangles) + " triangles, but its head says " +
                 std::to_string(head.triangles),
             path);
  }

  void check(const io::BlockEntry& entry, std::size_t number) {
    if (entry.triangles == 0 || entry.triangles > kBlockTriangles ||
        entry.vertices > kBlockVertices)
      refuse("cannot have " + std::to_string(entry.triangles) + " triangles and " +
                 std::to_string(entry.vertices) + " vertices",
             place(number));
    for (const io::SectionPlace& section : {entry.geometry, entry.shading}) {
      if (!lies_in(section.offset, section.stored, head.file_bytes))
        refuse("lies outside the file", place(number));
      if (section.bytes > io::kMostSectionBytes || section.stored > section.bytes)
        refuse("cannot take " + std::to_string(section.bytes) + " bytes", place(number));
      compressed = compressed || section.stored < section.bytes;
    }
    BlockInfo info;
    std::memcpy(&info.bounds.min, entry.min, sizeof entry.min);
    std::memcpy(&info.bounds.max, entry.max, sizeof entry.max);
    for (int axis = 0; axis < 3; ++axis) {
      if (!(entry.min[axis] >= -1e18f && entry.min[axis] <= entry.max[axis] &&
            entry.max[axis] <= 1e18f))
        refuse("its bounds are not a box", place(number));
    }
    info.triangles = entry.triangles;
    info.geometry_bytes = entry.geometry.stored;
    info.shading_bytes = entry.shading.stored;
    infos.push_back(info);
  }

  void read_scene() {
    if (!lies_in(head.scene_offset, head.scene_bytes, head.file_bytes))
      refuse("its scene lies outside the file", path);
    io::Bytes bytes(head.scene_bytes);
    file.read(head.scene_offset, bytes, path);
    if (io::checksum(bytes) != head.scene_checksum)
      refuse("its scene is damaged: the checksum does not match", path);
    io::naming(path, [&] {
      scene = io::decode_scene(bytes);
      scene.files = {path};
      validate_but_triangles(scene);
      if (scene.cameras.empty()) refuse("there is none", "cameras");
    });
  }

  [[nodiscard]] std::string place(std::size_t number) const {
    return path + ": block " + std::to_string(number);
  }

  /// Reads a section, verifies its checksum, decompresses it, and calls `decode` with its bytes.
  template <class Decode>
  void read(std::size_t number, const io::SectionPlace& section, const Decode& decode) const {
    io::Bytes stored = pool.take();
    stored.resize(section.stored);
    file.read(section.offset, stored, place(number));
    if (io::checksum(stored) != section.checksum)
      refuse("its bytes are damaged: the checksum does not match", place(number));
    if (section.stored < section.bytes) {
      if (!can_compress_blocks())
        throw Error(ErrorCode::kUnsupported, "is compressed, and this build has no Zstandard",
                    place(number));
      io::Bytes whole(section.bytes);
      if (!io::decompress(stored, &whole)) refuse("cannot be decompressed", place(number));
      stored.swap(whole);
    }
    try {
      decode(stored);
    } catch (const Error& error) {
      refuse(error.sentence(), place(number));
    }
    pool.give(std::move(stored));
  }

  std::string path;
  io::FileReader file;
  io::FileHead head{};
  std::vector<io::BlockEntry> entries;
  std::vector<BlockInfo> infos;
  SceneDescription scene;
  bool compressed = false;
  mutable Pool pool;
};

BlockFile::BlockFile(const std::string& path) {
  impl_ = io::within_memory(path, [&] { return std::make_unique<Impl>(path); });
}

BlockFile::~BlockFile() = default;

std::span<const BlockInfo> BlockFile::blocks() const {
  return impl_->infos;
}

void BlockFile::read(std::size_t block, TriangleBlock* out) const {
  const io::BlockEntry& entry = impl_->entries.at(block);
  io::within_memory(impl_->path, [&] {
    impl_->read(block, entry.geometry,
                [out](const io::Bytes& bytes) { io::decode_geometry(bytes, out); });
  });
}

void BlockFile::read_shading(std::size_t block, BlockShading* out) const {
  const io::BlockEntry& entry = impl_->entries.at(block);
  io::within_memory(impl_->path, [&] {
    impl_->read(block, entry.shading,
                [out](const io::Bytes& bytes) { io::decode_shading(bytes, out); });
  });
}

const SceneDescription& BlockFile::scene() const {
  return impl_->scene;
}
std::string BlockFile::place(std::size_t block) const {
  return impl_->place(block);
}
std::uint64_t BlockFile::triangle_count() const {
  return impl_->head.triangles;
}
std::uint64_t BlockFile::file_bytes() const {
  return impl_->head.file_bytes;
}
bool BlockFile::compressed() const {
  return impl_->compressed;
}

}  // namespace raysheaf
