#include "scenes/hall_tiles.h"

#include <algorithm>
#include <vector>

#include "base/bits.h"
#include "scenes/hall_grid.h"

namespace raysheaf::builtin {
namespace {

/// 2 * 180 * 180 triangles and 181 * 181 vertices fit into a block.
constexpr std::uint32_t kCells = 180;
/// Number of tiles that are made at once.
constexpr std::size_t kTogether = 16;

struct Tile {
  std::uint32_t first_column, end_column, first_row, end_row;  ///< of cells
};

struct Made {
  TriangleBlock block;
  BlockShading shading;
};

/// Divides the cells [0, count) into nearly equal parts of at most `kCells`: where each begins.
std::vector<std::uint32_t> cuts(std::uint32_t count) {
  const std::uint32_t parts = div_ceil(count, kCells);
  std::vector<std::uint32_t> starts;
  for (std::uint64_t i = 0; i <= parts; ++i)
    starts.push_back(static_cast<std::uint32_t>(count * i / parts));
  return starts;
}

class TileMaker {
 public:
  TileMaker(const Grid& grid, Tile tile, std::uint32_t id, Made* out)
      : grid_(grid), tile_(tile), out_(*out) {
    add_vertices();
    add_triangles();
    const auto count = static_cast<std::uint32_t>(out_.block.triangles.size());
    out_.block.parts = {{id, id, 0, count}};
    out_.block.sides = {kSingleSided};
    out_.shading.materials = {0};
    out_.shading.has_normals = {1};
    out_.shading.has_uvs = {0};
  }

 private:
  /// Corners of the tile's cells; normals also need the cells around them. Columns of round patches
  /// wrap around.
  void add_vertices() {
    const std::uint32_t turn = grid_.columns();
    const bool round = grid_.is_round();
    const std::uint32_t left =
        round ? (tile_.first_column + turn - 1) % turn : std::max(tile_.first_column, 1u) - 1;
    const std::uint32_t right = round ? left + (tile_.end_column - tile_.first_column) + 2
                                      : std::min(tile_.end_column + 1, turn);
    const std::uint32_t bottom = std::max(tile_.first_row, 1u) - 1;
    const std::uint32_t top = std::min(tile_.end_row + 1, grid_.rows());
    const std::uint32_t width = right - left + 1;
    std::vector<Vec3> around;
    around.reserve(std::size_t{width} * (top - bottom + 1));
    for (std::uint32_t row = bottom; row <= top; ++row) {
      for (std::uint32_t column = left; column <= right; ++column)
        around.push_back(grid_.position(grid_.vertex(column, row)));
    }
    const auto at = [&](std::uint32_t column, std::uint32_t row) {
      const std::uint32_t place = round ? (column + turn - left) % turn : column - left;
      return around[std::size_t{row - bottom} * width + place];
    };
    for (std::uint32_t row = tile_.first_row; row <= tile_.end_row; ++row) {
      for (std::uint32_t column = tile_.first_column; column <= tile_.end_column; ++column) {
        if (!owns(column, row)) continue;
        out_.block.positions.push_back(at(column, row));
        out_.shading.normals.push_back(grid_.normal(grid_.vertex(column, row), at));
      }
    }
  }

  /// Poles have one vertex, and a tile that spans the whole circumference shares the last column
  /// with the first.
  [[nodiscard]] bool is_pole(std::uint32_t row) const {
    return grid_.is_ball() && (row == 0 || row == grid_.rows());
  }
  [[nodiscard]] bool goes_round() const {
    return grid_.is_round() && tile_.end_column - tile_.first_column == grid_.columns();
  }
  [[nodiscard]] bool owns(std::uint32_t column, std::uint32_t row) const {
    if (is_pole(row)) return column == tile_.first_column;
    return !goes_round() || column != tile_.end_column;
  }

  [[nodiscard]] std::uint32_t local(std::uint32_t column, std::uint32_t row) const {
    const std::uint32_t columns = tile_.end_column - tile_.first_column + (goes_round() ? 0 : 1);
    const bool after_pole = is_pole(tile_.first_row);
    const std::uint32_t rows = row - tile_.first_row;
    const std::uint32_t start = rows == 0    ? 0
                                : after_pole ? 1 + (rows - 1) * columns
                                             : rows * columns;
    return is_pole(row) ? start : start + (column - tile_.first_column) % columns;
  }

  void add_triangles() {
    for (std::uint32_t row = tile_.first_row; row < tile_.end_row; ++row) {
      const bool lower_pole = is_pole(row), upper_pole = is_pole(row + 1);
      const std::uint32_t a_cell = lower_pole || upper_pole ? 1 : 2;
      auto number =
          static_cast<std::uint32_t>(grid_.first_triangle(row)) + a_cell * tile_.first_column;
      for (std::uint32_t c = tile_.first_column; c < tile_.end_column; ++c) {
        const std::uint32_t p = local(c, row), q = local(c + 1, row);
        const std::uint32_t r = local(c + 1, row + 1), s = local(c, row + 1);
        if (!lower_pole) add({p, q, r}, number++);
        if (!upper_pole) add({p, r, s}, number++);
      }
    }
  }

  void add(std::array<std::uint32_t, 3> corners, std::uint32_t number) {
    out_.block.triangles.push_back(corners);
    out_.block.prim_ids.push_back(number);
  }

  const Grid& grid_;
  Tile tile_;
  Made& out_;
};

}  // namespace

void hall_tiles(const Executor& executor, const HallPatch& patch, PatchGrid size, std::uint32_t id,
                BlockSink* sink) {
  const Grid grid(patch, size);
  std::vector<Tile> tiles;
  const std::vector<std::uint32_t> columns = cuts(size.columns), rows = cuts(size.rows);
  for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
    for (std::size_t c = 0; c + 1 < columns.size(); ++c)
      tiles.push_back({columns[c], columns[c + 1], rows[r], rows[r + 1]});
  }
  for (std::size_t first = 0; first < tiles.size(); first += kTogether) {
    std::vector<Made> made(std::min(kTogether, tiles.size() - first));
    executor.for_each(made.size(), 1,
                      [&](std::size_t i) { TileMaker(grid, tiles[first + i], id, &made[i]); });
    for (const Made& m : made) sink->add(m.block, m.shading);
  }
}

}  // namespace raysheaf::builtin
