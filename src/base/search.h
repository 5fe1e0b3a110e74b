// Binary search in the values of a function, on the host and on a device.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"

namespace raysheaf {

/// The first index in [0, count) whose number is not below `value`; `count` if there is none. The
/// numbers ascend.
template <class Number>
RAYSHEAF_HD std::size_t first_not_below(const Number& number, std::size_t count,
                                        std::uint64_t value) {
  std::size_t first = 0, end = count;
  while (first < end) {
    const std::size_t middle = first + (end - first) / 2;
    if (number(middle) < value) {
      first = middle + 1;
    } else {
      end = middle;
    }
  }
  return first;
}

}  // namespace raysheaf
