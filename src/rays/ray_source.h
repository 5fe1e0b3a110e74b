// Where a query's rays come from: not all lie in memory as rays.
#pragma once

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// For any number of threads.
class RaySource {
 public:
  explicit RaySource(std::size_t size) : size_(size) {}
  virtual ~RaySource() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Whether they lie in memory as rays.
  [[nodiscard]] virtual bool is_in_place() const { return false; }
  /// Rays [begin, end): where they lie, or in `room`, which has room for as many. They may be
  /// wrong.
  [[nodiscard]] virtual View<const Ray> peek(std::size_t begin, std::size_t end,
                                             Ray* room) const = 0;
  /// The same, looked over: what a source throws for wrong ones comes from here. Each ray is taken
  /// once.
  [[nodiscard]] virtual View<const Ray> take(std::size_t begin, std::size_t end, Ray* room) const {
    return peek(begin, end, room);
  }

 protected:
  RaySource(const RaySource&) = default;
  RaySource& operator=(const RaySource&) = default;

 private:
  std::size_t size_;
};

/// Rays in memory, which nobody looks over.
class RaysInPlace final : public RaySource {
 public:
  explicit RaysInPlace(View<const Ray> rays) : RaySource(rays.size), rays_(rays) {}
  [[nodiscard]] bool is_in_place() const override { return true; }
  [[nodiscard]] View<const Ray> peek(std::size_t begin, std::size_t end,
                                     Ray* /*room*/) const override {
    return rays_.slice(begin, end - begin);
  }

 private:
  View<const Ray> rays_;
};

/// All of them in a row, taken by several threads; in `room` unless they lie so.
[[nodiscard]] View<const Ray> take_all(const Executor& executor, const RaySource& rays,
                                       Buffer<Ray>* room);

}  // namespace raysheaf
