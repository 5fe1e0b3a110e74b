// The steps of building the hierarchy of object_tree/bvh.h, for the loops of bvh_cpu.cpp and of
// bvh_device.h. Their results do not depend on the order of the triangles, so that both build the
// same tree.
#pragma once

#include <cstdint>
#include <limits>

#include "base/vec.h"
#include "object_tree/bvh.h"

namespace raysheaf {

inline constexpr std::uint32_t kBvhBins = 16;

/// A triangle's box and number, which are moved together.
struct BvhItem {
  Vec3 min;
  std::uint32_t id;
  Vec3 max;

  /// Twice the centre.
  [[nodiscard]] RAYSHEAF_HD Vec3 center() const { return min + max; }
};

RAYSHEAF_HD inline BvhItem bvh_item(std::uint32_t id, Vec3 a, Vec3 b, Vec3 c) {
  return {min(min(a, b), c), id, max(max(a, b), c)};
}

RAYSHEAF_HD inline void include(Box* box, Vec3 low, Vec3 high) {
  box->min = min(box->min, low);
  box->max = max(box->max, high);
}

/// Half the surface, in binary64, so that the largest coordinates do not overflow.
RAYSHEAF_HD inline double half_area_if_any(const Box& box) {
  if (!(box.min.x <= box.max.x)) return 0;
  const double x = double{box.max.x} - box.min.x, y = double{box.max.y} - box.min.y,
               z = double{box.max.z} - box.min.z;
  return x * y + y * z + z * x;
}

/// A run of items that becomes one child.
struct BvhRun {
  std::uint32_t first = 0, count = 0;
  Box box, centers;

  [[nodiscard]] RAYSHEAF_HD bool is_leaf() const { return count <= kLeafTriangles; }
};

/// A node's children as they are split.
struct BvhOpening {
  BvhRun child[kBvhWidth];
  std::uint32_t children = 1;

  /// The child that is split next: the widest that is no leaf; `kInvalidId`: none.
  [[nodiscard]] RAYSHEAF_HD std::uint32_t widest() const {
    std::uint32_t best = kInvalidId;
    if (children == kBvhWidth) return best;
    double most = 0;
    for (std::uint32_t c = 0; c < children; ++c) {
      if (child[c].is_leaf()) continue;
      const double area = half_area_if_any(child[c].box);
      if (best != kInvalidId &&
          !(area > most || (area == most && child[c].count > child[best].count)))
        continue;
      best = c;
      most = area;
    }
    return best;
  }
  /// The number of children that become nodes.
  [[nodiscard]] RAYSHEAF_HD std::uint32_t nodes() const {
    std::uint32_t count = 0;
    for (std::uint32_t c = 0; c < children; ++c) count += child[c].is_leaf() ? 0 : 1;
    return count;
  }
};

struct BvhBins {
  Box box[kBvhBins];
  std::uint32_t count[kBvhBins] = {};
};

/// The bin of a centre along the widest axis of all centres of a run.
struct BvhBinning {
  int axis = 0;
  float low = 0, scale = 0;

  BvhBinning() = default;
  RAYSHEAF_HD explicit BvhBinning(const Box& centers) {
    const Vec3 size = centers.max - centers.min;
    axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    low = component(centers.min, axis);
    const float width = component(size, axis);
    scale = width > 0 ? static_cast<float>(kBvhBins) / width : 0;
    if (!(scale < std::numeric_limits<float>::infinity())) scale = 0;
  }
  [[nodiscard]] RAYSHEAF_HD std::uint32_t bin_of(const BvhItem& item) const {
    const float place = (component(item.center(), axis) - low) * scale;
    return static_cast<std::uint32_t>(clamp(place, 0, static_cast<float>(kBvhBins - 1)));
  }
};

/// The number of bins on the left of the cheapest cut; 0 if all items share a bin.
RAYSHEAF_HD inline std::uint32_t cheapest_cut(const BvhBins& bins) {
  double right_cost[kBvhBins] = {};
  Box box;
  std::uint32_t count = 0;
  for (std::uint32_t b = kBvhBins - 1; b > 0; --b) {
    include(&box, bins.box[b].min, bins.box[b].max);
    count += bins.count[b];
    right_cost[b] = half_area_if_any(box) * count;
  }
  const std::uint32_t total = count + bins.count[0];
  double best = std::numeric_limits<double>::infinity();
  std::uint32_t cut = 0;
  box = {};
  count = 0;
  for (std::uint32_t b = 1; b < kBvhBins; ++b) {
    include(&box, bins.box[b - 1].min, bins.box[b - 1].max);
    count += bins.count[b - 1];
    if (count == 0 || count == total) continue;
    const double cost = half_area_if_any(box) * count + right_cost[b];
    if (cost < best) {
      best = cost;
      cut = b;
    }
  }
  return cut;
}

/// `first`: a leaf's first place, or a node's number.
RAYSHEAF_HD inline void write_child(const BvhRun& run, std::uint32_t first, std::uint32_t c,
                                    BvhNode* node) {
  for (int axis = 0; axis < 3; ++axis) {
    node->bound[axis][c] = component(run.box.min, axis);
    node->bound[3 + axis][c] = component(run.box.max, axis);
  }
  node->first[c] = first;
  node->count[c] = static_cast<std::uint8_t>(run.is_leaf() ? run.count : 0);
}

}  // namespace raysheaf
