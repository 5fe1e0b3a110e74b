#include "object_tree/bvh.h"

#include <algorithm>
#include <array>

#include "base/vec.h"
#include "exec/scan.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kBins = 16;

/// A triangle's box and number, which are moved together.
struct Item {
  Vec3 min;
  std::uint32_t id;
  Vec3 max;

  /// Twice the centre.
  [[nodiscard]] Vec3 center() const { return min + max; }
};

void grow(Box* box, Vec3 lo, Vec3 hi) {
  box->min = min(box->min, lo);
  box->max = max(box->max, hi);
}

/// Half the surface, in binary64, so that the largest coordinates do not overflow.
double half_area_if_any(const Box& box) {
  if (!(box.min.x <= box.max.x)) return 0;
  const double x = double{box.max.x} - box.min.x, y = double{box.max.y} - box.min.y,
               z = double{box.max.z} - box.min.z;
  return x * y + y * z + z * x;
}

/// A run of items that becomes one child.
struct Run {
  std::uint32_t first = 0, count = 0;
  Box box, centers;
};

bool is_wider(const Run& a, const Run& b) {
  const double area_a = half_area_if_any(a.box), area_b = half_area_if_any(b.box);
  return area_a != area_b ? area_a > area_b : a.count > b.count;
}

struct Bins {
  std::array<Box, kBins> box;
  std::array<std::uint32_t, kBins> count{};

  void add(const Bins& other) {
    for (std::uint32_t b = 0; b < kBins; ++b) {
      grow(&box[b], other.box[b].min, other.box[b].max);
      count[b] += other.count[b];
    }
  }
};

/// The bin of a centre along the widest axis of all centres of a run.
struct Binning {
  int axis;
  float low, scale;

  explicit Binning(const Box& centers) {
    const Vec3 size = centers.max - centers.min;
    axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    low = component(centers.min, axis);
    const float width = component(size, axis);
    scale = width > 0 ? static_cast<float>(kBins) / width : 0;
    if (!(scale < std::numeric_limits<float>::infinity())) scale = 0;
  }
  [[nodiscard]] std::uint32_t operator()(const Item& item) const {
    const float place = (component(item.center(), axis) - low) * scale;
    return static_cast<std::uint32_t>(clamp(place, 0, static_cast<float>(kBins - 1)));
  }
};

/// The number of bins on the left of the cheapest cut; 0 if all items share a bin.
std::uint32_t cheapest_cut(const Bins& bins) {
  std::array<double, kBins> right_cost{};
  Box box;
  std::uint32_t count = 0;
  for (std::uint32_t b = kBins - 1; b > 0; --b) {
    grow(&box, bins.box[b].min, bins.box[b].max);
    count += bins.count[b];
    right_cost[b] = half_area_if_any(box) * count;
  }
  const std::uint32_t total = count + bins.count[0];
  double best = std::numeric_limits<double>::infinity();
  std::uint32_t cut = 0;
  box = {};
  count = 0;
  for (std::uint32_t b = 1; b < kBins; ++b) {
    grow(&box, bins.box[b - 1].min, bins.box[b - 1].max);
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

class Builder {
 public:
  Builder(const Executor& executor, const TriangleView& triangles)
      : executor_(executor), items_(triangles.count), moved_(triangles.count) {
    executor_.for_each(items_.size(), kCopyGrain, [&](std::size_t i) {
      const auto corner = [&](int k) {
        return Vec3{triangles.vertex[k][0][i], triangles.vertex[k][1][i],
                    triangles.vertex[k][2][i]};
      };
      const Vec3 a = corner(0), b = corner(1), c = corner(2);
      items_[i] = {min(min(a, b), c), static_cast<std::uint32_t>(i), max(max(a, b), c)};
    });
  }

  Bvh build() {
    Bvh bvh;
    if (items_.empty()) return bvh;
    bvh.level_starts = {0};
    std::vector<Run> level{measured(0, static_cast<std::uint32_t>(items_.size()))};
    while (!level.empty()) level = build_level(level, &bvh);
    bvh.triangles.resize(items_.size());
    executor_.for_each(items_.size(), kCopyGrain,
                       [&](std::size_t i) { bvh.triangles[i] = items_[i].id; });
    return bvh;
  }

 private:
  using Children = std::array<Run, kBvhWidth>;

  /// Builds one node per run; returns their children that are not leaves, as the runs of the next
  /// level.
  std::vector<Run> build_level(const std::vector<Run>& level, Bvh* bvh) {
    const std::uint32_t first = bvh->level_starts.back();
    bvh->nodes.resize(first + level.size());
    bvh->level_starts.push_back(static_cast<std::uint32_t>(bvh->nodes.size()));
    std::vector<Children> children(level.size());
    std::vector<std::uint32_t> places(level.size());
    executor_.for_each(level.size(), 1, [&](std::size_t i) {
      BvhNode* node = &bvh->nodes[first + i];
      node->children = open(level[i], &children[i]);
      for (std::uint32_t c = 0; c < node->children; ++c)
        places[i] += children[i][c].count > kLeafTriangles ? 1 : 0;
    });
    std::vector<Run> next(exclusive_scan(executor_, places, places));
    executor_.for_each(level.size(), 1, [&](std::size_t i) {
      BvhNode* node = &bvh->nodes[first + i];
      std::uint32_t place = places[i];
      for (std::uint32_t c = 0; c < node->children; ++c) {
        const Run& run = children[i][c];
        const bool leaf = run.count <= kLeafTriangles;
        write_child(run, leaf ? run.first : bvh->level_starts.back() + place, c, node);
        if (!leaf) next[place++] = run;
      }
    });
    for (std::uint32_t n = first; n < bvh->nodes.size(); ++n)
      for (const std::uint8_t count : bvh->nodes[n].count) bvh->leaf_count += count != 0 ? 1 : 0;
    return next;
  }

  static void write_child(const Run& run, std::uint32_t first, std::uint32_t c, BvhNode* node) {
    for (int axis = 0; axis < 3; ++axis) {
      node->bound[axis][c] = component(run.box.min, axis);
      node->bound[3 + axis][c] = component(run.box.max, axis);
    }
    node->first[c] = first;
    node->count[c] = static_cast<std::uint8_t>(run.count <= kLeafTriangles ? run.count : 0);
  }

  /// Splits a run into up to kBvhWidth; returns how many.
  std::uint32_t open(const Run& whole, Children* children) {
    std::uint32_t count = 1;
    (*children)[0] = whole;
    while (count < kBvhWidth) {
      Run* widest = nullptr;
      for (std::uint32_t c = 0; c < count; ++c) {
        Run& run = (*children)[c];
        if (run.count > kLeafTriangles && (widest == nullptr || is_wider(run, *widest)))
          widest = &run;
      }
      if (widest == nullptr) break;
      const std::uint32_t left = split(*widest);
      (*children)[count++] = measured(widest->first + left, widest->count - left);
      *widest = measured(widest->first, left);
    }
    return count;
  }

  /// Moves the items of the left part to the front; returns how many, never none or all.
  std::uint32_t split(const Run& run) {
    const Binning bin(run.centers);
    const std::uint32_t cut = cheapest_cut(fill_bins(run, bin));
    if (cut == 0) return run.count / 2;
    const Item* from = items_.data() + run.first;
    Item* to = moved_.data() + run.first;
    const auto is_right = [&](std::size_t i) { return bin(from[i]) >= cut; };
    const FlagCounts counts = count_flags(executor_, run.count, is_right);
    const std::uint32_t left = run.count - counts.total;
    for_each_scanned(executor_, counts, run.count, is_right,
                     [&](std::size_t i, bool right, std::uint32_t s) {
                       to[right ? left + s - 1 : i - s] = from[i];
                     });
    for_each_block(run.first, run.count, [&](std::size_t begin, std::size_t end, std::size_t) {
      std::copy(moved_.begin() + static_cast<std::ptrdiff_t>(begin),
                moved_.begin() + static_cast<std::ptrdiff_t>(end),
                items_.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    return left;
  }

  Bins fill_bins(const Run& run, const Binning& bin) {
    std::vector<Bins> parts(div_ceil(run.count, kScanBlock));
    for_each_block(run.first, run.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t n = bin(items_[i]);
        grow(&parts[b].box[n], items_[i].min, items_[i].max);
        ++parts[b].count[n];
      }
    });
    for (std::size_t b = 1; b < parts.size(); ++b) parts[0].add(parts[b]);
    return parts[0];
  }

  /// The run with its boxes.
  Run measured(std::uint32_t first, std::uint32_t count) {
    std::vector<Run> parts(div_ceil(count, kScanBlock));
    for_each_block(first, count, [&](std::size_t begin, std::size_t end, std::size_t b) {
      for (std::size_t i = begin; i < end; ++i) {
        grow(&parts[b].box, items_[i].min, items_[i].max);
        grow(&parts[b].centers, items_[i].center(), items_[i].center());
      }
    });
    for (std::size_t b = 1; b < parts.size(); ++b) {
      grow(&parts[0].box, parts[b].box.min, parts[b].box.max);
      grow(&parts[0].centers, parts[b].centers.min, parts[b].centers.max);
    }
    parts[0].first = first;
    parts[0].count = count;
    return parts[0];
  }

  /// Calls `body(begin, end, block)` for the blocks of a run, whose borders do not depend on the
  /// number of threads.
  template <class Body>
  void for_each_block(std::uint32_t first, std::uint32_t count, const Body& body) {
    executor_.for_each(div_ceil(count, kScanBlock), 1, [&](std::size_t block) {
      const std::size_t begin = block * kScanBlock;
      body(first + begin, first + std::min<std::size_t>(begin + kScanBlock, count), block);
    });
  }

  const Executor& executor_;
  std::vector<Item> items_, moved_;
};

}  // namespace

Bvh build_bvh(const Executor& executor, const TriangleView& triangles) {
  return Builder(executor, triangles).build();
}

}  // namespace raysheaf
