// Checksums, and compression if the build has Zstandard.
#include <xxhash.h>

#ifdef RAYSHEAF_HAS_ZSTD
#include <zstd.h>
#endif

#include "io/block_format.h"
#include "raysheaf/block_file.h"

namespace raysheaf {
namespace io {

std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

#ifdef RAYSHEAF_HAS_ZSTD

namespace {

constexpr int kLevel = 3;

/// Visits the first bytes of all four-byte words, then all second bytes and so on, and then the
/// bytes after the last whole word.
template <class Visit>
void for_each_place(std::size_t size, const Visit& visit) {
  const std::size_t words = size / 4;
  std::size_t place = 0;
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::size_t word = 0; word < words; ++word) visit(place++, 4 * word + plane);
  }
  for (; place < size; ++place) visit(place, place);
}

}  // namespace

Bytes compressed(std::span<const std::uint8_t> bytes) {
  Bytes planes(bytes.size()), out(ZSTD_compressBound(bytes.size()));
  for_each_place(bytes.size(),
                 [&](std::size_t plane, std::size_t word) { planes[plane] = bytes[word]; });
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), planes.data(), planes.size(), kLevel);
  if (ZSTD_isError(size) != 0 || size >= bytes.size()) return {};
  out.resize(size);
  return out;
}

bool decompress(std::span<const std::uint8_t> stored, Bytes* out) {
  Bytes planes(out->size());
  const std::size_t size =
      ZSTD_decompress(planes.data(), planes.size(), stored.data(), stored.size());
  if (ZSTD_isError(size) != 0 || size != planes.size()) return false;
  for_each_place(size, [&](std::size_t plane, std::size_t word) { (*out)[word] = planes[plane]; });
  return true;
}

#else

Bytes compressed(std::span<const std::uint8_t> /*bytes*/) {
  return {};
}
bool decompress(std::span<const std::uint8_t> /*stored*/, Bytes* /*out*/) {
  return false;
}

#endif

}  // namespace io

bool can_compress_blocks() {
#ifdef RAYSHEAF_HAS_ZSTD
  return true;
#else
  return false;
#endif
}

}  // namespace raysheaf
