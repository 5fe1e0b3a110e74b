// Ctrl-C during long work.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <future>
#include <optional>

namespace raysheaf::python {

/// Throws what a handler of a signal raised. For a wait without the interpreter's lock.
inline void check_signals() {
  const nanobind::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
}

/// Runs `body(stop)` on a thread of its own, without the interpreter's lock, while this one
/// listens: Python hands signals to its main thread alone. What a handler raises, KeyboardInterrupt
/// for one, sets `stop`, and is thrown once `body` has ended, however it did. Else throws what
/// `body` throws.
template <class Body>
void interruptible(const Body& body) {
  namespace nb = nanobind;
  constexpr std::chrono::milliseconds kBetweenLooks{50};
  std::optional<nb::python_error> raised;
  {
    const nb::gil_scoped_release release;
    std::atomic<bool> stop = false;
    std::future<void> done = std::async(std::launch::async, [&] { body(stop); });
    while (done.wait_for(kBetweenLooks) != std::future_status::ready) {
      if (stop) continue;
      const nb::gil_scoped_acquire acquire;
      if (PyErr_CheckSignals() != 0) {
        raised.emplace();
        stop = true;
      }
    }
    if (!stop) done.get();
  }
  if (raised) throw std::move(*raised);
}

}  // namespace raysheaf::python
