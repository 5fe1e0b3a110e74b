// Releases and reacquires the interpreter's lock, also while the interpreter is shutting down.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace raysheaf::python {

/// Calls `take()`, which acquires the lock. Before Python 3.14, a daemon thread that requests it
/// during shutdown is terminated by unwinding a stack that must not be unwound. Here it waits for
/// the end of the process instead, as it does from 3.14 on.
template <class Take>
void take_or_stay(const Take& take) {
  struct Stay {
    bool is_wanted = true;
    ~Stay() {
      while (is_wanted) std::this_thread::sleep_for(std::chrono::hours(1));
    }
  } stay;
  take();
  stay.is_wanted = false;
}

/// Releases the lock during its lifetime: meanwhile, the thread must not touch Python objects.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil() { take(); }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

  /// Throws what a signal handler raises. Call it on the thread that created this object.
  void check_signals() const {
    take();
    std::optional<nanobind::python_error> raised;
    if (PyErr_CheckSignals() != 0) raised.emplace();
    PyEval_SaveThread();
    if (raised) throw std::move(*raised);
  }

 private:
  void take() const {
    take_or_stay([this] { PyEval_RestoreThread(state_); });
  }

  PyThreadState* state_;
};

}  // namespace raysheaf::python
