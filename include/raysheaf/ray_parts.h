// Rays whose origins and directions are in separate arrays of float or double, with any strides.
//
// The threads that trace them pack a few thousand rays at a time in their caches, which is faster
// than packing a batch beforehand.
#pragma once

#include <cstddef>
#include <type_traits>

namespace raysheaf {

/// Rows of numbers: the number at (row, column) is `row * row_stride + column * column_stride`
/// numbers after `data`. Strides may be negative, or 0 if all rows are the same.
struct NumberRows {
  const void* data = nullptr;
  bool is_double = false;
  std::ptrdiff_t row_stride = 0, column_stride = 1;
  std::ptrdiff_t block_stride = 0;  ///< only for `RayParts` with blocks

  NumberRows() = default;
  template <class Number>
  explicit NumberRows(const Number* first, std::ptrdiff_t rows_apart = 3,
                      std::ptrdiff_t columns_apart = 1)
      : data(first),
        is_double(std::is_same_v<Number, double>),
        row_stride(rows_apart),
        column_stride(columns_apart) {
    static_assert(std::is_same_v<Number, double> || std::is_same_v<Number, float>);
  }
};

/// A batch of `count` rays. Doubles are rounded to float.
///
/// For batches in which arrays repeat, as in all suns for all points, rays may come in blocks of
/// `block` rays: the numbers of ray i are those of row `i % block`, moved on by
/// `i / block * block_stride` numbers.
struct RayParts {
  std::size_t count;
  std::size_t block = 0;           ///< 0: all rays are one block
  NumberRows origins, directions;  ///< three numbers per row
  NumberRows t_min, t_max;         ///< one number per row; without data 0 and infinity

  RayParts(std::size_t rays, NumberRows origin_rows, NumberRows direction_rows,
           NumberRows t_min_rows = {}, NumberRows t_max_rows = {})
      : count(rays),
        origins(origin_rows),
        directions(direction_rows),
        t_min(t_min_rows),
        t_max(t_max_rows) {}
};

}  // namespace raysheaf
