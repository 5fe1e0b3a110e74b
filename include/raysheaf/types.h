// Plain types of the public interface: vectors, affine maps, boxes, rays (one by one, or with their
// numbers in separate arrays) and hits. They have no operators; the library's mathematics is in
// src/base/vec.h.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

namespace raysheaf {

struct Vec2 {
  float x = 0, y = 0;
};

struct Vec3 {
  float x = 0, y = 0, z = 0;
};

struct Vec4 {
  float x = 0, y = 0, z = 0, w = 0;
};

/// An affine map, as three rows of four: `p' = m[r][0] x + m[r][1] y + m[r][2] z + m[r][3]`.
struct Affine {
  std::array<std::array<float, 4>, 3> m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

/// An axis-aligned box; empty if `min > max` on any axis, which is the default.
struct Box {
  Vec3 min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
           std::numeric_limits<float>::infinity()};
  Vec3 max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
           -std::numeric_limits<float>::infinity()};
};

inline constexpr std::uint32_t kInvalidId = 0xffffffffu;

/// The sides of triangles. The front is the side from which the corners run counter-clockwise in
/// the mesh's own space: a transform that mirrors does not turn a mesh inside out.
enum class Sides : std::uint8_t { kBoth, kFront, kBack };

/// The properties of a triangle that decide which of its sides are seen, as bits.
enum TriangleFlag : std::uint8_t {
  kSingleSided = 1,  ///< its material does not show the back
  kMirrored = 2,     ///< its instance mirrors: the front is clockwise
};

/// A ray. `t` counts in lengths of `direction`, which need not be a unit vector; a hit lies in
/// `[t_min, t_max]`, and `t_max` may be infinite.
struct Ray {
  Vec3 origin;
  float t_min = 0;
  Vec3 direction;
  float t_max = std::numeric_limits<float>::infinity();
};
static_assert(sizeof(Ray) == 32);

/// The hit of a ray. A miss has `prim_id == kInvalidId` and `t == +inf`; `u` and `v` are the
/// barycentric weights of the triangle's second and third vertex.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t prim_id = kInvalidId;
  std::uint32_t geom_id = kInvalidId;
  std::uint32_t inst_id = kInvalidId;
};

/// Names a triangle of a scene: an instance, and the triangle of its mesh.
struct TriangleId {
  std::uint32_t inst_id = kInvalidId, prim_id = kInvalidId;
};

/// Names one of many small scenes that share a `Scene`, its meshes and its queries. A ray or a
/// point sees an instance if both are in the same world, or if one of the two is in all worlds.
using WorldId = std::uint32_t;
inline constexpr WorldId kAllWorlds = 0xffffffffu;

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

/// A batch of `count` rays: a list of `Ray`, or their numbers in separate arrays. Doubles are
/// rounded to float.
///
/// For batches in which arrays repeat, as in all suns for all points, rays may come in blocks of
/// `block` rays: the numbers of ray i are those of row `i % block`, moved on by
/// `i / block * block_stride` numbers.
struct RayParts {
  std::size_t count;
  std::size_t block = 0;           ///< 0: all rays are one block
  NumberRows origins, directions;  ///< three numbers per row
  NumberRows t_min, t_max;         ///< one number per row; without data 0 and infinity
  const Ray* list = nullptr;       ///< unless null, the rays, and the arrays above are not used

  RayParts(std::size_t rays, NumberRows origin_rows, NumberRows direction_rows,
           NumberRows t_min_rows = {}, NumberRows t_max_rows = {})
      : count(rays),
        origins(origin_rows),
        directions(direction_rows),
        t_min(t_min_rows),
        t_max(t_max_rows) {}
  /// Any contiguous list of `Ray`.
  template <class List>
  requires std::convertible_to<const List&, std::span<const Ray>> RayParts(
      const List& rays)  // NOLINT: a view
      : RayParts(std::span<const Ray>(rays)) {}
  RayParts(std::span<const Ray> rays)  // NOLINT: a view
      : count(rays.size()), list(rays.data()) {}
};

}  // namespace raysheaf
