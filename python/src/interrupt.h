// Ctrl-C during long work.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <system_error>

#include "gil.h"
#include "raysheaf/error.h"

namespace raysheaf::python {

/// Throws once a long work is to stop. For a wait within `interruptible`.
inline void give_up_if(const std::atomic<bool>& stop) {
  if (stop) throw Error(ErrorCode::kCancelled, "the wait was stopped");
}

/// Runs `body(stop)` on a thread of its own, without the interpreter's lock, while this one
/// listens: Python hands signals to its main thread alone. What a handler raises, KeyboardInterrupt
/// for one, sets `stop`, and is thrown once `body` has ended, however it did. Else throws what
/// `body` throws. Where the system starts no thread, `body` runs on this one, and signals wait.
template <class Body>
void interruptible(const Body& body) {
  namespace nb = nanobind;
  constexpr std::chrono::milliseconds kBetweenLooks{50};
  std::optional<nb::python_error> raised;
  {
    const WithoutGil released;
    std::atomic<bool> stop = false;
    const auto work = [&] { body(stop); };
    std::future<void> done;
    try {
      done = std::async(std::launch::async, work);
    } catch (const std::system_error&) {
      done = std::async(std::launch::deferred, work);
    }
    while (done.wait_for(kBetweenLooks) == std::future_status::timeout) {
      if (stop) continue;
      try {
        released.check_signals();
      } catch (nb::python_error& error) {
        raised.emplace(std::move(error));
        stop = true;
      }
    }
    if (!stop) done.get();
  }
  if (raised) throw std::move(*raised);
}

}  // namespace raysheaf::python
