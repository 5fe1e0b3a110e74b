// Several processes that work on one picture or on one batch of rays, on one machine or on many
// (docs/mpi.md).
//
//   rays       every process has the scene; groups of first hits, or pieces of each batch, go to
//              whoever is free
//   geometry   every process streams its own blocks past all rays; the least hits are found
//
// Every process calls the same functions with the same arguments, in the same order, and gets the
// same answers: those, bit for bit, that one process would have got.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "raysheaf/context.h"
#include "raysheaf/error.h"

namespace raysheaf {

class HitExchange;

/// The processes of a run; each has a number from 0, its rank. raysheaf/mpi.h has those of MPI; a
/// program may bring its own. Used from one thread at a time. But for `rank`, `size` and `take`
/// its functions are collective: all processes call the same ones in the same order.
class Communicator {
 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  [[nodiscard]] virtual std::uint32_t rank() const = 0;
  [[nodiscard]] virtual std::uint32_t size() const = 0;

  /// All get the bytes of rank 0.
  virtual void broadcast(std::span<std::byte> bytes) = 0;

  /// into[i] becomes from[i] combined with into[i]: in any order, so that it must not matter.
  using Combine = void (*)(const std::byte* from, std::byte* into, std::size_t count);
  /// Everyone's elements become those of all, combined. No elements: waits for all.
  virtual void combine(std::span<std::byte> elements, std::size_t element_bytes, Combine how) = 0;

  /// The least of 0 to `items` - 1 that no process has taken yet; none when all are. A call that
  /// gives none is followed by a collective one before anything is taken again.
  [[nodiscard]] virtual std::optional<std::uint64_t> take(std::uint64_t items) = 0;

  /// Of a process that cannot go on, with what it caught. The others' next collective call, or
  /// the one that they are in, throws what this returns: the error of the lowest rank that failed,
  /// with that rank in its place. Afterwards nothing but this may be called.
  [[nodiscard]] virtual Error fail(const Error& error) noexcept = 0;
};

/// A context whose batches of rays are shared among processes: those of a `Renderer` on it, of
/// `closest_hit` and of `any_hit`. What OpenGL shows is that of rank 0. Batches of few rays are
/// everyone's own. Throws `Error` as `Context` does.
[[nodiscard]] Context distributed(const ContextOptions& options,
                                  std::shared_ptr<Communicator> ranks);

/// For `StreamOptions::exchange`, with `part` = rank and `parts` = size: processes that stream
/// their own blocks each. `ranks` must outlive it.
[[nodiscard]] std::unique_ptr<HitExchange> make_hit_exchange(Communicator& ranks);

}  // namespace raysheaf
