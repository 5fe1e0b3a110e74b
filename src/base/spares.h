// Working memory of threads, kept for reuse by the next thread that needs it.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

namespace raysheaf {

/// `T` has `bytes()`, the memory that it holds. Thread-safe.
template <class T>
class Spares {
 public:
  [[nodiscard]] std::unique_ptr<T> take() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!spare_.empty()) {
        std::unique_ptr<T> one = std::move(spare_.back());
        spare_.pop_back();
        return one;
      }
    }
    return std::make_unique<T>();
  }
  void give(std::unique_ptr<T> one) noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    try {
      spare_.push_back(std::move(one));
    } catch (const std::bad_alloc&) {
      // Destructors call this, so it must not throw: if the list cannot grow, the object is
      // destroyed.
    }
  }
  [[nodiscard]] std::size_t bytes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::size_t sum = 0;
    for (const std::unique_ptr<T>& one : spare_) sum += one->bytes();
    return sum;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<T>> spare_;
};

/// One of the spares, while in scope.
template <class T>
class Borrowed {
 public:
  explicit Borrowed(Spares<T>& from) : from_(from), one_(from.take()) {}
  ~Borrowed() { from_.give(std::move(one_)); }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  T& operator*() const { return *one_; }
  T* operator->() const { return one_.get(); }

 private:
  Spares<T>& from_;
  std::unique_ptr<T> one_;
};

}  // namespace raysheaf
