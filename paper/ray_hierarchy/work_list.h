// The triangles that a node intersects, stored contiguously: their numbers, and the fields that its
// children's tests read.
#pragma once

#include <cstdint>

#include "base/aligned.h"
#include "paper/ray_hierarchy/node_filter.h"

namespace raysheaf {

template <std::size_t kFields>
class WorkList {
 public:
  using Fields = FieldPointers<kFields>;

  /// A list without fields belongs to a node without children.
  WorkList(std::uint32_t capacity, bool with_fields)
      : with_fields_(with_fields), ids_(capacity + kMargin) {
    if (!with_fields_) return;
    for (auto& values : fields_) values.resize(capacity + kMargin);
  }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] const std::uint32_t* ids() const { return ids_.data(); }
  [[nodiscard]] Fields fields() const {
    Fields pointers{};
    for (std::size_t k = 0; k < kFields; ++k) pointers[k] = fields_[k].data();
    return pointers;
  }
  void clear() { size_ = 0; }

  /// Appends the entries `index[0..count)` of a list whose entry i is triangle `ids[i]`, or `first
  /// + i` if `ids` is null.
  void append(const Fields& from, const std::uint32_t* ids, std::uint32_t first,
              const std::uint32_t* index, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i)
      ids_[size_ + i] = ids != nullptr ? ids[index[i]] : first + index[i];
    for (std::size_t k = 0; with_fields_ && k < kFields; ++k)
      gather_floats(from[k], index, count, fields_[k].data() + size_);
    size_ += count;
  }

 private:
  static constexpr std::uint32_t kMargin = 16;  // SIMD stores may write past the end
  std::uint32_t size_ = 0;
  bool with_fields_;
  AlignedVector<std::uint32_t> ids_;
  AlignedVector<float> fields_[kFields];
};

}  // namespace raysheaf
