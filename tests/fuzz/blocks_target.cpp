// Block files with arbitrary bytes. The target corrects their checksums, because otherwise all
// would be refused.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "fuzz/targets.h"
#include "io/block_format.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"

namespace raysheaf::fuzz {
namespace {

using io::Bytes;

/// The range of bytes at this place, or an empty one.
std::span<std::uint8_t> part(Bytes& bytes, std::uint64_t offset, std::uint64_t size) {
  if (offset > bytes.size() || size > bytes.size() - offset) return {};
  return std::span(bytes).subspan(offset, size);
}

void seal(Bytes& bytes) {
  io::FileHead head{};
  if (bytes.size() < sizeof head) return;
  std::memcpy(&head, bytes.data(), sizeof head);
  constexpr std::uint64_t kEntry = sizeof(io::BlockEntry);
  const std::uint64_t count = std::min<std::uint64_t>(head.blocks, 64);
  const auto index = part(bytes, head.index_offset, count * kEntry);
  for (std::size_t at = 0; at + kEntry <= index.size(); at += kEntry) {
    io::BlockEntry entry{};
    std::memcpy(&entry, index.data() + at, kEntry);
    for (io::SectionPlace* section : {&entry.geometry, &entry.shading})
      section->checksum = io::checksum(part(bytes, section->offset, section->stored));
    std::memcpy(index.data() + at, &entry, kEntry);
  }
  head.file_bytes = bytes.size();
  head.index_checksum = io::checksum(index);
  head.scene_checksum = io::checksum(part(bytes, head.scene_offset, head.scene_bytes));
  head.head_checksum =
      io::checksum(io::bytes_of(head).first(sizeof head - sizeof head.head_checksum));
  std::memcpy(bytes.data(), &head, sizeof head);
}

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("raysheaf-fuzz-blocks-" + std::to_string(getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

void use(const std::string& path) {
  const BlockFile file(path);
  BlockShading shading;
  for (std::size_t i = 0; i < file.blocks().size(); ++i) file.read_shading(i, &shading);
  RenderOptions options;
  options.width = options.height = 4;
  options.threads = 1;
  options.primary = Primary::kTrace;
  static_cast<void>(render(file, options));
}

}  // namespace

void run_blocks(Input input) {
  static const Folder folder;
  const std::string path = (folder.path / "scene.rsb").string();
  Bytes bytes(input.begin(), input.end());
  seal(bytes);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  try {
    use(path);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kInternal && !error.sentence().empty()) return;
    std::fprintf(stderr, "not a sentence for users: %s\n", error.what());
    std::abort();
  }
}

}  // namespace raysheaf::fuzz
