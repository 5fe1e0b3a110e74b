// The interpreter's lock, let go and taken again, also where the interpreter is about to end.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#ifdef __GLIBCXX__
#include <cxxabi.h>
#endif

namespace raysheaf::python {

/// Calls `take()`, which takes the lock. Until Python 3.14 a daemon thread that asks for it once
/// the interpreter ends is ended in there, by unwinding a stack that must not be unwound; here it
/// waits for the end of the process instead, as it does from 3.14 on.
template <class Take>
void take_or_stay(const Take& take) {
#ifdef __GLIBCXX__
  try {
    take();
  } catch (const abi::__forced_unwind&) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
#else
  take();
#endif
}

/// Without the lock while it lives: what happens meanwhile touches no Python object.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil() { take(); }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

  /// Throws what a handler of a signal raises. On the thread that made this.
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
