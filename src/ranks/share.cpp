#include "ranks/share.h"

#include <algorithm>
#include <cstring>

namespace raysheaf {
namespace {

/// A piece with fewer rays is not worth its two messages.
constexpr std::size_t kFewestOfAPiece = 8192;
constexpr std::size_t kPiecesARank = 4;

void unite_bytes(const std::byte* from, std::byte* into, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) into[i] |= from[i];
}

template <class T>
void add_numbers(const std::byte* from, std::byte* into, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    T a, b;
    std::memcpy(&a, from + i * sizeof(T), sizeof(T));
    std::memcpy(&b, into + i * sizeof(T), sizeof(T));
    b += a;
    std::memcpy(into + i * sizeof(T), &b, sizeof(T));
  }
}

template <class T>
void add_all(Communicator& ranks, std::span<T> numbers) {
  ranks.combine(std::as_writable_bytes(numbers), sizeof(T), add_numbers<T>);
}

}  // namespace

Pieces pieces_of(std::size_t count, std::uint32_t ranks) {
  const std::size_t wanted = kPiecesARank * ranks;
  return {count, std::max(kFewestOfAPiece, (count + wanted - 1) / wanted)};
}

void share_out(Communicator& ranks, const Pieces& pieces,
               const std::function<void(std::size_t begin, std::size_t end)>& work) {
  while (const auto piece = ranks.take(pieces.number())) {
    const std::size_t begin = *piece * pieces.size;
    work(begin, std::min(begin + pieces.size, pieces.count));
  }
}

void unite(Communicator& ranks, std::span<std::byte> bytes) {
  ranks.combine(bytes, 1, unite_bytes);
}

void add(Communicator& ranks, std::span<std::uint64_t> counts) {
  add_all(ranks, counts);
}
void add(Communicator& ranks, std::span<double> sums) {
  add_all(ranks, sums);
}
void add(Communicator& ranks, std::span<float> sums) {
  add_all(ranks, sums);
}

}  // namespace raysheaf
