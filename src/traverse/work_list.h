// The triangles that a node met, side by side: their numbers and their spheres.
#pragma once

#include <cstdint>

#include "base/aligned.h"
#include "traverse/sphere_filter.h"

namespace raysheaf {

class WorkList {
 public:
  explicit WorkList(std::uint32_t capacity) : ids_(capacity + kMargin) {
    for (auto& values : sphere_) values.resize(capacity + kMargin);
  }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] const std::uint32_t* ids() const { return ids_.data(); }
  [[nodiscard]] SphereArrays spheres() const {
    return {sphere_[0].data(), sphere_[1].data(), sphere_[2].data(), sphere_[3].data()};
  }
  void clear() { size_ = 0; }

  /// Appends the entries `index[0..count)` of a list whose entry i is triangle `ids[i]`, or `first
  /// + i` where there are no ids.
  void append(const SphereArrays& from, const std::uint32_t* ids, std::uint32_t first,
              const std::uint32_t* index, std::uint32_t count);

 private:
  static constexpr std::uint32_t kMargin = 16;  // SIMD stores may reach past the end
  std::uint32_t size_ = 0;
  AlignedVector<std::uint32_t> ids_;
  AlignedVector<float> sphere_[4];
};

}  // namespace raysheaf
