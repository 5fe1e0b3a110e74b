// The loops of the object tree over all triangles, by SIMD.
#pragma once

#include <cstdint>
#include <vector>

#include "object_tree/area_tree.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Columns of doubled centres, by number. The x of triangles without area is NaN.
struct CenterColumns {
  float* axis[3];
};

/// Computes the centres of [begin, end), and the box of those that have an area. Appends the
/// numbers of the others to `left_out`; if it is null, they count as if they had one.
void measure_centers(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                     CenterColumns centers, Box* bounds, std::vector<std::uint32_t>* left_out);

/// A strip of one to four consecutive triangles, as a word: the number of the first, and the count
/// less 1 in the low `kStripBits` bits.
inline constexpr std::uint32_t kStripBits = 2;

/// Joins consecutive triangles of [begin, end) that have an area and belong to the same run, as
/// long as the box of a strip grows little. Writes the strips and the centres of their boxes from
/// place 0 on, and returns how many. Computes the box of these centres. Appends the numbers of
/// triangles without area to `left_out`; if it is null, they count as if they had one.
std::uint32_t join_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                             CenterColumns centers, std::uint32_t* strips, Box* bounds,
                             std::vector<std::uint32_t>* left_out);

/// The leaves of a part of the source.
struct SourceLeaves {
  std::uint32_t count = 0;
  Box bounds;                           ///< of the centres of their boxes
  std::vector<std::uint32_t> strips;    ///< that belong to no leaf yet
  std::vector<std::uint32_t> left_out;  ///< triangles without area
};

/// The number of quads for the triangles [begin, end) if each has the next four of a run.
std::uint32_t count_quads(const TriangleSource& source, std::uint32_t begin, std::uint32_t end);

/// Writes these quads from `quads[first_quad]` on, and joins up to `most_quads` consecutive ones to
/// leaves. The leaves and the centres of their boxes are written from place `first_quad` on. Four
/// triangles whose box is too large, or of which one has no area, leave only their first strip in
/// the quad. `keep_flat`: triangles without area count as if they had one.
void write_source_leaves(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t most_quads, bool keep_flat, std::uint32_t first_quad,
                         TriangleQuad* quads, CenterColumns centers, AreaItem* leaves,
                         SourceLeaves* result);

/// Writes strips as leaves of one quad each: quads, leaves and the centres of their boxes, all from
/// place `first_quad` on. Returns the box of the centres.
Box write_strip_leaves(const TriangleSource& source, View<const std::uint32_t> strips,
                       std::uint32_t first_quad, TriangleQuad* quads, CenterColumns centers,
                       AreaItem* leaves);

/// A Morton curve through cubic cells (Morton 1966): `bits` bits per axis, x lowest.
struct MortonCurve {
  Vec3 low;
  float up = 1;     ///< a power of two that scales tiny scenes out of the subnormal numbers
  float scale = 0;  ///< cells per unit of doubled centre, after `up`
  std::uint32_t bits = 0;
  std::uint32_t id_bits = 0;
};

/// Writes `key << id_bits | number` for the triangles of [begin, end) that have an area, or
/// `key << id_bits | strips[number]` if `strips` is not null, consecutively, and counts the keys by
/// their highest bits, `key >> bucket_shift`. Returns how many.
std::uint32_t write_keys(CenterColumns centers, const std::uint32_t* strips,
                         const MortonCurve& curve, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t bucket_shift, std::uint64_t* keys,
                         std::uint32_t* bucket_counts);

/// Moves keys to the buckets of their highest bits, `key >> (id_bits + bucket_shift)`:
/// `place[bucket]` is the next free place. With `records`, the triangles move to the same places
/// there, and the low `id_bits` bits of the items in `sorted` become that place.
void scatter_keys(const TriangleSource& source, View<const std::uint64_t> keys,
                  const MortonCurve& curve, std::uint32_t bucket_shift, std::uint32_t* place,
                  std::uint64_t* sorted, TriangleRecord* records);

/// Consecutive leaves: leaf i has the next `sizes[i]` items of `sorted`, which are given by their
/// low `id_bits` bits.
struct LeafItems {
  const std::uint64_t* sorted;
  std::uint32_t id_bits;
  const std::uint8_t* sizes;
  std::uint32_t leaf_count;

  [[nodiscard]] std::uint32_t item(std::uint32_t i) const {
    return static_cast<std::uint32_t>(sorted[i] & ((std::uint64_t{1} << id_bits) - 1));
  }
};

/// Writes the quads of leaves one after the other, from `quads[first_quad]` on, and the boxes of
/// the leaves' corners, with the number of their triangles as weight and their first quad as `ref`.
/// Items are the numbers of triangles, or their places in `records`, if not null.
void write_leaves(const TriangleSource& source, const TriangleRecord* records,
                  const LeafItems& leaves, std::uint32_t first_quad, TriangleQuad* quads,
                  AreaItem* boxes);

/// The same for items that are strips.
void write_leaves_of_strips(const TriangleSource& source, const LeafItems& leaves,
                            std::uint32_t first_quad, TriangleQuad* quads, AreaItem* boxes);

/// The union of all eight boxes of a node.
void node_box(const BvhNode& node, Box* box);

}  // namespace raysheaf
