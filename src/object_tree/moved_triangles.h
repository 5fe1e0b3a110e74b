// The triangles that have moved since the object tree was updated.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raysheaf {

/// Triangles [first, first + count).
struct TriangleRange {
  std::uint32_t first = 0, count = 0;
};

/// A set of triangles as bits; all of them if they are many.
class MovedTriangles {
 public:
  [[nodiscard]] bool all() const { return all_; }
  /// Must not be called if `all()` is true.
  [[nodiscard]] bool has(std::uint32_t triangle) const {
    const std::size_t word = triangle / kBits;
    return word < words_.size() && (words_[word] >> triangle % kBits & 1) != 0;
  }

  [[nodiscard]] static MovedTriangles everything() {
    MovedTriangles moved;
    moved.add_all();
    return moved;
  }

  void clear() {
    words_.clear();
    sum_ = 0;
    all_ = false;
  }
  void add_all() {
    clear();
    all_ = true;
  }
  /// `triangles`: the total number.
  void add(TriangleRange range, std::uint32_t triangles) {
    if (all_ || range.count == 0) return;
    sum_ += range.count;
    if (sum_ >= triangles / 2) return add_all();
    words_.resize((std::size_t{triangles} + kBits - 1) / kBits);
    const std::size_t end = std::size_t{range.first} + range.count;
    for (std::size_t at = range.first; at < end;) {
      const std::size_t bits = std::min(end - at, kBits - at % kBits);
      const std::uint64_t ones = bits == kBits ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
      words_[at / kBits] |= ones << at % kBits;
      at += bits;
    }
  }

  [[nodiscard]] std::size_t memory_bytes() const {
    return words_.capacity() * sizeof(std::uint64_t);
  }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> words_;
  std::uint64_t sum_ = 0;  ///< of the added ranges
  bool all_ = false;
};

}  // namespace raysheaf
