#include "base/forks.h"

#include <atomic>
#include <vector>

#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf {
namespace {

/// Never destroyed, because a process may fork until its end.
struct Forks {
  std::atomic<std::uint32_t> number{0};
  std::mutex mutex;
  std::vector<std::mutex*> held;

  Forks() {
    system::watch_forks([] { all().lock(); }, [] { all().unlock(); },
                        [] {
                          all().number.fetch_add(1, std::memory_order_relaxed);
                          all().unlock();
                        });
  }
  static Forks& all() {
    static Forks* const kForks = new Forks;
    return *kForks;
  }

 private:
  void lock() {
    mutex.lock();
    for (std::mutex* one : held) one->lock();
  }
  void unlock() {
    for (std::mutex* one : held) one->unlock();
    mutex.unlock();
  }
};

}  // namespace

std::uint32_t fork_number() noexcept {
  return Forks::all().number.load(std::memory_order_relaxed);
}

void check_not_forked(std::uint32_t made, const char* place) {
  if (made == fork_number()) return;
  throw Error(ErrorCode::kWrongState,
              "it was made before this process was forked, and its threads are not here: make "
              "another one, or start processes without fork",
              place);
}

void hold_over_forks(std::mutex* mutex) {
  Forks& forks = Forks::all();
  const std::lock_guard lock(forks.mutex);
  forks.held.push_back(mutex);
}

}  // namespace raysheaf
