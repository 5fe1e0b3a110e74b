// The source of a query's rays, which need not be stored as `Ray`.
#pragma once

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Thread-safe.
class RaySource {
 public:
  explicit RaySource(std::size_t size) : size_(size) {}
  virtual ~RaySource() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Rays [begin, end): in place, or in `room`, which has room for as many. They may be invalid.
  [[nodiscard]] virtual View<const Ray> peek(std::size_t begin, std::size_t end,
                                             Ray* room) const = 0;
  /// The same, validated: a source throws here for invalid rays. Each ray is taken once.
  [[nodiscard]] virtual View<const Ray> take(std::size_t begin, std::size_t end, Ray* room) const {
    return peek(begin, end, room);
  }

 protected:
  RaySource(const RaySource&) = default;
  RaySource& operator=(const RaySource&) = default;

 private:
  std::size_t size_;
};

/// Rays in memory, which are not validated.
class RaysInPlace final : public RaySource {
 public:
  explicit RaysInPlace(View<const Ray> rays) : RaySource(rays.size), rays_(rays) {}
  [[nodiscard]] View<const Ray> peek(std::size_t begin, std::size_t end,
                                     Ray* /*room*/) const override {
    return rays_.slice(begin, end - begin);
  }

 private:
  View<const Ray> rays_;
};

/// All rays in one array, filled by several threads; in `room` unless they are stored so.
[[nodiscard]] View<const Ray> take_all(const Executor& executor, const RaySource& rays,
                                       Buffer<Ray>* room);

}  // namespace raysheaf
