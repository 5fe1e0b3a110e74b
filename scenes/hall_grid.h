// The vertices and cells of a hall's patch, computed from their numbers without storing others.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "base/vec.h"
#include "scenes/hall_patch.h"

namespace raysheaf::builtin {

/// The point at u and v in [0, 1] of a patch, moved along its normal.
[[nodiscard]] Vec3 displaced(const HallPatch& patch, float u, float v);

/// The vertices of a grid. Round shapes share the last column with the first, and spheres have no
/// first and last row: their poles are the first and the last vertex.
class Grid {
 public:
  Grid(const HallPatch& patch, PatchGrid grid)
      : patch_(patch),
        columns_(grid.columns),
        rows_(grid.rows),
        round_(patch.shape != HallPatch::Shape::kWall),
        ball_(patch.shape == HallPatch::Shape::kBall),
        stride_(round_ ? columns_ : columns_ + 1) {}

  [[nodiscard]] std::size_t vertex_count() const {
    return ball_ ? std::size_t{stride_} * (rows_ - 1) + 2 : std::size_t{stride_} * (rows_ + 1);
  }

  [[nodiscard]] std::uint32_t vertex(std::uint32_t column, std::uint32_t row) const {
    if (round_) column %= columns_;
    if (!ball_) return row * stride_ + column;
    if (row == 0) return 0;
    if (row == rows_) return static_cast<std::uint32_t>(vertex_count() - 1);
    return 1 + (row - 1) * stride_ + column;
  }

  /// Inverse of `vertex`.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> place(std::uint32_t i) const {
    if (!ball_) return {i % stride_, i / stride_};
    if (i == 0) return {0, 0};
    if (i == vertex_count() - 1) return {0, rows_};
    return {(i - 1) % stride_, 1 + (i - 1) / stride_};
  }

  [[nodiscard]] Vec3 position(std::uint32_t i) const {
    const auto [column, row] = place(i);
    return displaced(patch_, static_cast<float>(column) / static_cast<float>(columns_),
                     static_cast<float>(row) / static_cast<float>(rows_));
  }

  /// From the neighbours on the grid; at a pole, along the axis. `position(column, row)` returns
  /// their positions.
  template <class Position>
  [[nodiscard]] Vec3 normal(std::uint32_t i, const Position& position) const {
    const auto [column, row] = place(i);
    if (ball_ && (row == 0 || row == rows_)) return {0, row == 0 ? -1.0f : 1.0f, 0};
    const std::uint32_t left = round_ ? column + columns_ - 1 : std::max(column, 1u) - 1;
    const std::uint32_t right = round_ ? column + 1 : std::min(column + 1, columns_);
    const Vec3 along = position(right, row) - position(left, row);
    const Vec3 up =
        position(column, std::min(row + 1, rows_)) - position(column, std::max(row, 1u) - 1);
    return normalized(cross(along, up));
  }

  /// Two triangles of a cell, one at the poles of a sphere. Counter-clockwise about u x v.
  void add_cells(std::uint32_t row, std::array<std::uint32_t, 3>* out) const {
    for (std::uint32_t c = 0; c < columns_; ++c) {
      const std::uint32_t p = vertex(c, row), q = vertex(c + 1, row);
      const std::uint32_t r = vertex(c + 1, row + 1), s = vertex(c, row + 1);
      if (p != q) *out++ = {p, q, r};
      if (r != s) *out++ = {p, r, s};
    }
  }

  /// The number of a row's first triangle.
  [[nodiscard]] std::size_t first_triangle(std::uint32_t row) const {
    const std::size_t missing = ball_ && row > 0 ? columns_ : 0;
    return std::size_t{2} * columns_ * row - missing;
  }

  [[nodiscard]] bool is_round() const { return round_; }
  [[nodiscard]] bool is_ball() const { return ball_; }
  [[nodiscard]] std::uint32_t columns() const { return columns_; }
  [[nodiscard]] std::uint32_t rows() const { return rows_; }

 private:
  const HallPatch& patch_;
  std::uint32_t columns_, rows_;
  bool round_, ball_;
  std::uint32_t stride_;
};

}  // namespace raysheaf::builtin
