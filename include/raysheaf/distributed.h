// Several processes, on one or more machines, that share the work on one image or on one batch of
// rays (docs/mpi.md).
//
//   rays       every process has the scene; tiles of primary rays, or parts of each batch, go to
//              the next idle process
//   geometry   every process streams its own blocks past all rays; the closest hits are combined
//
// Every process calls the same functions with the same arguments, in the same order, and gets the
// same answers, bit for bit, as a single process.
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

/// The processes of a run; each has a number from 0, its rank. `mpi_communicator` implements it
/// with MPI; a program may implement its own. Used from one thread at a time. All functions except
/// `rank`, `size` and `take` are collective: all processes call them in the same order.
class Communicator {
 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  [[nodiscard]] virtual std::uint32_t rank() const = 0;
  [[nodiscard]] virtual std::uint32_t size() const = 0;

  /// Sends the bytes of rank 0 to all processes.
  virtual void broadcast(std::span<std::byte> bytes) = 0;

  /// Combines from[i] into into[i] for `count` elements. The processes' elements are combined in
  /// any order, so the operation must be associative and commutative.
  using Combine = void (*)(const std::byte* from, std::byte* into, std::size_t count);
  /// Replaces each process's elements by the combination over all processes. Without elements it is
  /// a barrier.
  virtual void combine(std::span<std::byte> elements, std::size_t element_bytes, Combine how) = 0;

  /// Takes the smallest number from 0 to `items` - 1 that no process has taken yet; none if all are
  /// taken. After a call that returns none, a collective function must be called before the next
  /// `take`.
  [[nodiscard]] virtual std::optional<std::uint64_t> take(std::uint64_t items) = 0;

  /// Reports that this process cannot continue, with the error that it caught. The other processes'
  /// current or next collective call throws the error that this returns: that of the lowest rank
  /// that failed, with the rank in its place. Afterwards only this function may be called.
  [[nodiscard]] virtual Error fail(const Error& error) noexcept = 0;
};

/// A context that shares batches of rays among processes: those of a `Renderer` on it, of
/// `closest_hit` and of `any_hit`. Rank 0 renders what OpenGL draws. Each process answers small
/// batches by itself. Throws `Error` as `Context` does.
[[nodiscard]] Context distributed(const ContextOptions& options,
                                  std::shared_ptr<Communicator> ranks);

/// For `StreamOptions::exchange`, with `part` = rank and `parts` = size: each process streams its
/// own blocks. `ranks` must outlive the result.
[[nodiscard]] std::unique_ptr<HitExchange> make_hit_exchange(Communicator& ranks);

// The next two functions are those of the library raysheaf::mpi, which exists if raysheaf was built
// with MPI: only programs that link it need MPI.

/// The processes of MPI_COMM_WORLD. Starts MPI if the program has not, and then finalizes it when
/// the communicator is destroyed, which all processes do after their last collective call. Calls
/// MPI only on the caller's thread (MPI_THREAD_FUNNELED is enough). Errors of MPI itself abort the
/// run, unless the program sets a different error handler.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator();

/// The processes of another communicator, passed as the result of MPI_Comm_c2f so that this header
/// does not need mpi.h. Collective over them. The program starts and finalizes MPI.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator(int communicator);

}  // namespace raysheaf
