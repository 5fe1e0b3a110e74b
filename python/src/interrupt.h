// Makes long work interruptible by Ctrl-C.
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

/// Throws if long work should stop; for waits within `interruptible`.
inline void give_up_if(const std::atomic<bool>& stop) {
  if (stop) throw Error(ErrorCode::kCancelled, "the wait was stopped");
}

/// Runs `body(stop)` on a thread of its own, without the interpreter's lock, while this thread
/// handles signals, because Python delivers them only to its main thread. If a handler raises, for
/// instance KeyboardInterrupt, this sets `stop`, waits until `body` has ended, and throws the
/// handler's exception. Otherwise it throws what `body` throws. If no thread can be started, `body`
/// runs on this one, and signals wait.
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
