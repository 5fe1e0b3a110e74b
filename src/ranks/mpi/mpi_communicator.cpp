// Only this file calls MPI. Every collective call begins with an exchange of failures: in this way
// all processes learn of one's error at their next meeting, unwind like a single process, and none
// is killed. MPI_Abort is not used.
#include <mpi.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "raysheaf/distributed.h"

namespace raysheaf {
namespace {

/// Bytes that are sent at once: MPI allocates the same amount again for receiving.
constexpr std::size_t kPieceBytes = std::size_t{4} << 20;
/// Adding this to the counter leaves nothing to take; 65 535 processes may add it before the sum
/// overflows.
constexpr std::uint64_t kNoMoreWork = std::uint64_t{1} << 48;
constexpr int kNobody = std::numeric_limits<int>::max();

/// MPI's operations are functions without a context argument: this is the current operation. Only
/// one thread calls MPI.
Communicator::Combine at_work = nullptr;

void combine_elements(void* from, void* into, int* count, MPI_Datatype* /*type*/) {
  at_work(static_cast<const std::byte*>(from), static_cast<std::byte*>(into),
          static_cast<std::size_t>(*count));
}

int size_of(std::size_t bytes) {
  return static_cast<int>(bytes);
}

/// Starts and finalizes MPI.
struct Session {
  Session() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() { MPI_Finalize(); }
};

class MpiCommunicator : public Communicator {
 public:
  MpiCommunicator(MPI_Comm all, std::unique_ptr<Session> session) : session_(std::move(session)) {
    MPI_Comm_dup(all, &all_);
    MPI_Comm_rank(all_, &rank_);
    MPI_Comm_size(all_, &size_);
    MPI_Win_allocate(rank_ == 0 ? sizeof(std::uint64_t) : 0, sizeof(std::uint64_t), MPI_INFO_NULL,
                     all_, static_cast<void*>(&counter_), &window_);
    if (rank_ == 0) *counter_ = 0;
    MPI_Barrier(all_);
    MPI_Win_lock_all(MPI_MODE_NOCHECK, window_);
  }
  ~MpiCommunicator() override {
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
    MPI_Comm_free(&all_);
  }

  [[nodiscard]] std::uint32_t rank() const override { return static_cast<std::uint32_t>(rank_); }
  [[nodiscard]] std::uint32_t size() const override { return static_cast<std::uint32_t>(size_); }

  void broadcast(std::span<std::byte> bytes) override {
    hear_of_failures(nullptr);
    send(bytes, 0);
  }

  void combine(std::span<std::byte> elements, std::size_t element_bytes, Combine how) override {
    hear_of_failures(nullptr);
    if (elements.empty()) return;
    MPI_Datatype type = MPI_DATATYPE_NULL;
    MPI_Op operation = MPI_OP_NULL;
    MPI_Type_contiguous(size_of(element_bytes), MPI_BYTE, &type);
    MPI_Type_commit(&type);
    MPI_Op_create(combine_elements, 1, &operation);
    at_work = how;
    const std::size_t piece = std::max<std::size_t>(kPieceBytes / element_bytes, 1) * element_bytes;
    for (std::size_t begin = 0; begin < elements.size(); begin += piece) {
      const std::size_t bytes = std::min(piece, elements.size() - begin);
      MPI_Allreduce(MPI_IN_PLACE, elements.data() + begin, size_of(bytes / element_bytes), type,
                    operation, all_);
    }
    MPI_Op_free(&operation);
    MPI_Type_free(&type);
  }

  // The counter is not reset: when all processes have learned that nothing is left, it has grown by
  // the number of items and by one for each process.
  [[nodiscard]] std::optional<std::uint64_t> take(std::uint64_t items) override {
    const std::uint64_t item = add_to_counter(1) - base_;
    if (item < items) return item;
    base_ += items + size();
    return std::nullopt;
  }

  [[nodiscard]] Error fail(const Error& error) noexcept override {
    if (!failure_) {
      static_cast<void>(add_to_counter(kNoMoreWork));
      try {
        hear_of_failures(&error);
      } catch (const Error&) {  // the same error that the other processes throw
      }
    }
    return *failure_;
  }

 private:
  std::uint64_t add_to_counter(std::uint64_t number) {
    std::uint64_t before = 0;
    MPI_Fetch_and_op(&number, &before, MPI_UINT64_T, 0, 0, MPI_SUM, window_);
    MPI_Win_flush(0, window_);
    return before;
  }

  void send(std::span<std::byte> bytes, int from) {
    for (std::size_t begin = 0; begin < bytes.size(); begin += kPieceBytes) {
      const std::size_t size = std::min(kPieceBytes, bytes.size() - begin);
      MPI_Bcast(bytes.data() + begin, size_of(size), MPI_BYTE, from, all_);
    }
  }

  std::string sent(const std::string& text, int from) {
    std::uint64_t size = text.size();
    send(std::as_writable_bytes(std::span(&size, 1)), from);
    std::string same = text;
    same.resize(size);
    send(std::as_writable_bytes(std::span(same)), from);
    return same;
  }

  /// Throws the error of the lowest rank that failed. `mine`: this process's; null: none.
  void hear_of_failures(const Error* mine) {
    if (failure_) throw Error(*failure_);
    int who = mine != nullptr ? rank_ : kNobody;
    MPI_Allreduce(MPI_IN_PLACE, &who, 1, MPI_INT, MPI_MIN, all_);
    if (who == kNobody) return;
    const bool is_mine = mine != nullptr && who == rank_;
    int code = is_mine ? static_cast<int>(mine->code()) : 0;
    MPI_Bcast(&code, 1, MPI_INT, who, all_);
    const std::string sentence = sent(is_mine ? mine->sentence() : "", who);
    const std::string place = sent(is_mine ? mine->place() : "", who);
    const std::string rank = "rank " + std::to_string(who) + " of " + std::to_string(size_);
    failure_.emplace(static_cast<ErrorCode>(code), sentence,
                     place.empty() ? rank : rank + ": " + place);
    throw Error(*failure_);
  }

  std::unique_ptr<Session> session_;  // destroyed last
  MPI_Comm all_ = MPI_COMM_NULL;
  MPI_Win window_ = MPI_WIN_NULL;
  int rank_ = 0, size_ = 1;
  std::uint64_t* counter_ = nullptr;  ///< of rank 0; other processes have no memory for it
  std::uint64_t base_ = 0;            ///< the counter's value before the current items
  std::optional<Error> failure_;
};

}  // namespace

std::shared_ptr<Communicator> mpi_communicator() {
  int started = 0;
  MPI_Initialized(&started);
  auto session = started == 0 ? std::make_unique<Session>() : nullptr;
  return std::make_shared<MpiCommunicator>(MPI_COMM_WORLD, std::move(session));
}

std::shared_ptr<Communicator> mpi_communicator(int communicator) {
  return std::make_shared<MpiCommunicator>(MPI_Comm_f2c(communicator), nullptr);
}

}  // namespace raysheaf
