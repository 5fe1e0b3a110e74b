// Sharing work among processes (raysheaf/distributed.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "raysheaf/distributed.h"

namespace raysheaf {

/// The pieces of [0, count): few enough that each is an efficient batch, many enough that no
/// process waits long for the last one.
struct Pieces {
  std::size_t count = 0, size = 1;

  [[nodiscard]] std::size_t number() const { return (count + size - 1) / size; }
};
[[nodiscard]] Pieces pieces_of(std::size_t count, std::uint32_t ranks);

/// Calls `work(begin, end)` for this process's pieces; every piece goes to one process. A
/// collective call must follow.
void share_out(Communicator& ranks, const Pieces& pieces,
               const std::function<void(std::size_t begin, std::size_t end)>& work);

/// Bitwise or, for arrays of which each process has a part and zeros elsewhere.
void unite(Communicator& ranks, std::span<std::byte> bytes);
template <class T>
void unite(Communicator& ranks, std::span<T> elements) {
  static_assert(std::is_trivially_copyable_v<T>);
  unite(ranks, std::as_writable_bytes(elements));
}

/// Computes `count` numbers in rank 0 and sends them to every process; null: a single process.
template <class Make>
[[nodiscard]] std::vector<std::uint32_t> made_by_first(Communicator* ranks, std::size_t count,
                                                       const Make& make) {
  if (ranks == nullptr) return make();
  std::vector<std::uint32_t> made(count);
  if (ranks->rank() == 0) made = make();
  ranks->broadcast(std::as_writable_bytes(std::span(made)));
  return made;
}

/// Replaces numbers by their sums over all processes.
void add(Communicator& ranks, std::span<std::uint64_t> counts);
void add(Communicator& ranks, std::span<double> sums);
void add(Communicator& ranks, std::span<float> sums);

}  // namespace raysheaf
