// A non-owning span, a pointer and a length, that device code can use.
#pragma once

#include <cassert>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "base/host_device.h"

namespace raysheaf {

template <class T>
struct View {
  T* data = nullptr;
  std::size_t size = 0;

  View() = default;
  RAYSHEAF_HD View(T* first, std::size_t count) : data(first), size(count) {}
  /// Accepts any contiguous container. A temporary one lives until the end of the full expression.
  template <class Container, class = std::enable_if_t<std::is_convertible_v<
                                 decltype(std::declval<Container&>().data()), T*>>>
  View(Container&& container)  // NOLINT: a view
      : data(container.data()), size(container.size()) {}

  RAYSHEAF_HD T& operator[](std::size_t i) const {
    assert(i < size);
    return data[i];
  }
  [[nodiscard]] RAYSHEAF_HD bool empty() const { return size == 0; }
  [[nodiscard]] RAYSHEAF_HD T* begin() const { return data; }
  [[nodiscard]] RAYSHEAF_HD T* end() const { return data + size; }
  [[nodiscard]] RAYSHEAF_HD View slice(std::size_t first, std::size_t count) const {
    assert(first + count <= size);
    return {data + first, count};
  }
};

}  // namespace raysheaf
