#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/area_tree.h"
#include "object_tree/float4.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kBins = 16;
/// The most items of a part.
constexpr std::uint32_t kPartItems = 1024;
/// Longer runs are cut by all threads, in blocks.
constexpr std::uint32_t kLongRun = 32768, kBlockItems = 4096;

/// The cost of visiting one more child, relative to that of a triangle.
constexpr double kCostOfChild = 1.4;

/// A box as two vectors. The fourth lanes hold the item's other fields, which are not used.
struct Box4 {
  Float4 min = all4(std::numeric_limits<float>::infinity());
  Float4 max = all4(-std::numeric_limits<float>::infinity());

  void grow(Float4 lo, Float4 hi) {
    min = raysheaf::min(min, lo);
    max = raysheaf::max(max, hi);
  }
  void grow(const Box4& other) { grow(other.min, other.max); }
  [[nodiscard]] Box box() const {
    alignas(16) float lo[4], hi[4];
    store4(min, lo);
    store4(max, hi);
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
  }
};

Float4 item_min(const AreaItem& item) {
  return load4(&item.min.x);
}
Float4 item_max(const AreaItem& item) {
  return load4(&item.max.x);
}

/// Half the surface, 0 for an empty box; in binary64, so that the largest coordinates do not
/// overflow.
double half_area(const Box4& box) {
  alignas(16) float size[4];
  store4(raysheaf::max(box.max - box.min, all4(0)), size);
  const double x = size[0], y = size[1], z = size[2];
  return x * (y + z) + y * z;
}

/// Items that become one child.
struct Run {
  std::uint32_t first = 0, count = 0;
  Box4 box, centers;
  double area = 0;
  bool splits = false;  ///< few enough items for a leaf, but two leaves are cheaper
};

struct Bins {
  std::array<Box4, kBins> box;
  std::array<std::uint32_t, kBins> weight{}, count{};

  void add(const Bins& other) {
    for (std::uint32_t b = 0; b < kBins; ++b) {
      box[b].grow(other.box[b]);
      weight[b] += other.weight[b];
      count[b] += other.count[b];
    }
  }
};

/// The bin of a centre along one axis.
struct Binning {
  int axis = 0;
  float low = 0, scale = 0;

  Binning(const Box& centers, int along, std::uint32_t bins) : axis(along) {
    low = component(centers.min, axis);
    const float width = component(centers.max, axis) - low;
    scale = width > 0 ? static_cast<float>(bins) / width : 0;
    if (!(scale < std::numeric_limits<float>::infinity())) scale = 0;
    last = static_cast<float>(bins - 1);
  }
  [[nodiscard]] std::uint32_t operator()(const AreaItem& item) const {
    const float center = (&item.min.x)[axis] + (&item.max.x)[axis];
    const float place = (center - low) * scale;
    return static_cast<std::uint32_t>(place < last ? place : last);
  }

  float last = 0;
};

int widest_axis(const Box& centers) {
  const Vec3 size = centers.max - centers.min;
  return size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
}

struct Cut {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  std::uint32_t bin = 0;  ///< the first bin on the right; 0: there is no cut
};

/// Keeps the cheapest cut between two bins.
void look_for_cut(const Bins& bins, std::uint32_t bin_count, int axis, Cut* best) {
  std::array<double, kBins> right_cost;
  std::array<std::uint32_t, kBins> right_items;
  Box4 box;
  std::uint32_t weight = 0, count = 0;
  for (std::uint32_t b = bin_count - 1; b > 0; --b) {
    box.grow(bins.box[b]);
    weight += bins.weight[b];
    count += bins.count[b];
    right_cost[b] = half_area(box) * weight;
    right_items[b] = count;
  }
  box = {};
  weight = count = 0;
  for (std::uint32_t b = 1; b < bin_count; ++b) {
    box.grow(bins.box[b - 1]);
    weight += bins.weight[b - 1];
    count += bins.count[b - 1];
    if (count == 0 || right_items[b] == 0) continue;
    const double cost = half_area(box) * weight + right_cost[b];
    if (cost < best->cost) *best = {cost, axis, b};
  }
}

/// A range of items.
struct Range {
  std::uint32_t begin, end;
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

/// Exchanges the items of two lists of ranges, which hold equally many: piece `piece` of `pieces`.
void exchange(AreaItem* items, const std::vector<Range>& a, const std::vector<Range>& b,
              std::size_t piece, std::size_t pieces) {
  std::uint64_t all = 0;
  for (const Range& range : a) all += range.size();
  const std::uint64_t end = all * (piece + 1) / pieces;
  std::uint64_t at = all * piece / pieces;
  std::uint64_t skip_a = at, skip_b = at;
  std::size_t i = 0, j = 0;
  while (at < end) {
    for (; skip_a >= a[i].size(); ++i) skip_a -= a[i].size();
    for (; skip_b >= b[j].size(); ++j) skip_b -= b[j].size();
    const std::uint64_t count = std::min({end - at, a[i].size() - skip_a, b[j].size() - skip_b});
    AreaItem *const one = items + a[i].begin + skip_a, *const other = items + b[j].begin + skip_b;
    std::swap_ranges(one, one + count, other);
    at += count;
    skip_a += count;
    skip_b += count;
  }
}

/// Cuts runs; long ones outside loops of the executor.
class Splitter {
 public:
  Splitter(const Executor& executor, View<AreaItem> items, const AreaOptions& options)
      : executor_(executor), items_(items), options_(options) {}

  [[nodiscard]] static bool is_long(const Run& run) { return run.count > kLongRun; }

  [[nodiscard]] bool is_leaf(const Run& run) const { return run.count <= options_.leaf_items; }

  [[nodiscard]] Run measured(std::uint32_t first, std::uint32_t count) const {
    Run run{first, count, {}, {}, 0, false};
    if (is_long(run)) {
      const std::vector<Run> parts =
          for_each_block<Run>(run, [&](std::uint32_t begin, std::uint32_t end) {
            return measured_alone(begin, end - begin);
          });
      for (const Run& part : parts) {
        run.box.grow(part.box);
        run.centers.grow(part.centers);
      }
    } else {
      run = measured_alone(first, count);
    }
    run.area = half_area(run.box);
    return run;
  }

  /// Whether a node has room for every item, so that cuts would only determine their order.
  [[nodiscard]] bool fits_node(const Run& run) const {
    return options_.leaf_items == 1 && run.count <= kBvhWidth;
  }
  void write_all(const Run& run, AreaNode* node) const {
    node->children = run.count;
    for (std::uint32_t c = 0; c < run.count; ++c) {
      const AreaItem& item = items_[run.first + c];
      node->box[c] = {item.min, item.max};
      node->child[c] = {AreaChild::kItems, run.first + c, 1};
    }
  }

  /// Splits a run into up to kBvhWidth runs, in the order of their items; returns how many.
  std::uint32_t open(const Run& whole, std::array<Run, kBvhWidth>* children) const {
    std::uint32_t count = 1;
    (*children)[0] = whole;
    while (count < kBvhWidth) {
      Run* widest = nullptr;
      for (std::uint32_t c = 0; c < count; ++c) {
        Run& run = (*children)[c];
        if (is_leaf(run) && !run.splits) continue;
        if (widest == nullptr || run.area > widest->area ||
            (run.area == widest->area && run.count > widest->count))
          widest = &run;
      }
      if (widest == nullptr) break;
      std::move_backward(widest + 1, children->data() + count, children->data() + count + 1);
      split(*widest, widest, widest + 1);
      ++count;
    }
    return count;
  }

 private:
  /// Calls `body(begin, end)` for blocks of a run in parallel; returns the results.
  template <class Result, class Body>
  std::vector<Result> for_each_block(const Run& run, const Body& body) const {
    std::vector<Result> results(div_ceil(run.count, kBlockItems));
    executor_.for_each(results.size(), 1, [&](std::size_t b) {
      const std::uint32_t begin = run.first + static_cast<std::uint32_t>(b) * kBlockItems;
      results[b] = body(begin, std::min(run.first + run.count, begin + kBlockItems));
    });
    return results;
  }

  [[nodiscard]] Run measured_alone(std::uint32_t first, std::uint32_t count) const {
    Run run{first, count, {}, {}, 0, false};
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Float4 lo = item_min(items_[i]), hi = item_max(items_[i]), center = lo + hi;
      run.box.grow(lo, hi);
      run.centers.grow(center, center);
    }
    return run;
  }

  void split(const Run run, Run* left, Run* right) const {
    const Box centers = run.centers.box();
    const std::uint32_t bins = run.count < 32 ? 8 : kBins;
    Cut cut;
    const int widest = widest_axis(centers);
    for (int axis = 0; axis < 3; ++axis) {
      if (!options_.three_axes && axis != widest) continue;
      const Binning binning(centers, axis, bins);
      if (binning.scale == 0) continue;
      look_for_cut(fill(run, binning), bins, axis, &cut);
    }
    const std::uint32_t count =
        cut.bin == 0 ? run.count / 2 : partition(run, Binning(centers, cut.axis, bins), cut.bin);
    *left = measured(run.first, count);
    *right = measured(run.first + count, run.count - count);
    if (!options_.small_leaves) return;
    left->splits = pays_to_split(*left);
    right->splits = pays_to_split(*right);
  }

  /// Whether two leaves instead of one save more tests of triangles than they cost. Sorts the run's
  /// items along the widest axis, and tries every cut.
  [[nodiscard]] bool pays_to_split(const Run& run) const {
    if (!is_leaf(run) || run.count < 2) return false;
    AreaItem* const items = items_.data + run.first;
    const int axis = widest_axis(run.centers.box());
    const auto center = [axis](const AreaItem& item) {
      return (&item.min.x)[axis] + (&item.max.x)[axis];
    };
    std::sort(items, items + run.count, [&](const AreaItem& a, const AreaItem& b) {
      return center(a) < center(b) || (center(a) == center(b) && a.ref < b.ref);
    });
    const auto cost_of = [&](std::uint32_t begin, std::uint32_t end) {
      Box4 box;
      for (std::uint32_t i = begin; i < end; ++i) box.grow(item_min(items[i]), item_max(items[i]));
      return half_area(box) * (end - begin);
    };
    const double most = (run.count - kCostOfChild) * run.area;
    for (std::uint32_t cut = 1; cut < run.count; ++cut)
      if (cost_of(0, cut) + cost_of(cut, run.count) < most) return true;
    return false;
  }

  [[nodiscard]] Bins fill(const Run& run, const Binning& binning) const {
    const auto fill_block = [&](std::uint32_t begin, std::uint32_t end) {
      Bins bins;
      for (std::uint32_t i = begin; i < end; ++i) {
        const AreaItem& item = items_[i];
        const std::uint32_t b = binning(item);
        bins.box[b].grow(item_min(item), item_max(item));
        bins.weight[b] += item.weight;
        ++bins.count[b];
      }
      return bins;
    };
    if (!is_long(run)) return fill_block(run.first, run.first + run.count);
    Bins bins;
    for (const Bins& block : for_each_block<Bins>(run, fill_block)) bins.add(block);
    return bins;
  }

  /// Moves the items of the bins before `cut` to the front; returns how many.
  [[nodiscard]] std::uint32_t partition(const Run& run, const Binning& binning,
                                        std::uint32_t cut) const {
    const auto partition_block = [&](std::uint32_t begin, std::uint32_t end) {
      return partition_alone(begin, end, binning, cut);
    };
    if (!is_long(run)) return partition_block(run.first, run.first + run.count);
    const std::vector<std::uint32_t> left_of = for_each_block<std::uint32_t>(run, partition_block);
    std::uint32_t left = 0;
    for (const std::uint32_t each : left_of) left += each;
    // The items of the right side before the border, and of the left side after it.
    const std::uint32_t border = run.first + left;
    std::vector<Range> rights, lefts;
    std::uint32_t begin = run.first;
    for (const std::uint32_t each : left_of) {
      const std::uint32_t end = std::min(run.first + run.count, begin + kBlockItems);
      const std::uint32_t middle = begin + each;
      if (middle < std::min(end, border)) rights.push_back({middle, std::min(end, border)});
      if (std::max(begin, border) < middle) lefts.push_back({std::max(begin, border), middle});
      begin = end;
    }
    executor_.for_each(left_of.size(), 1, [&](std::size_t b) {
      exchange(items_.data, rights, lefts, b, left_of.size());
    });
    return left;
  }

  /// The same for [begin, end). Has no branch that depends on the items, which would be
  /// unpredictable.
  [[nodiscard]] std::uint32_t partition_alone(std::uint32_t begin, std::uint32_t end,
                                              const Binning& binning, std::uint32_t cut) const {
    AreaItem* const items = items_.data + begin;
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < end - begin; ++i) {
      const AreaItem item = items[i];
      items[i] = items[left];
      items[left] = item;
      left += binning(item) < cut ? 1 : 0;
    }
    return left;
  }

  const Executor& executor_;
  View<AreaItem> items_;
  AreaOptions options_;
};

/// Builds the nodes of one part, depth first.
class PartBuilder {
 public:
  PartBuilder(const Splitter& splitter, std::vector<AreaNode>* nodes)
      : splitter_(splitter), nodes_(nodes) {}

  std::uint32_t build(const Run& run) {
    const auto number = static_cast<std::uint32_t>(nodes_->size());
    nodes_->emplace_back();
    if (splitter_.fits_node(run)) {
      splitter_.write_all(run, &nodes_->back());
      return number;
    }
    std::array<Run, kBvhWidth> children;
    const std::uint32_t count = splitter_.open(run, &children);
    (*nodes_)[number].children = count;
    for (std::uint32_t c = 0; c < count; ++c) {
      const Run& child = children[c];
      (*nodes_)[number].box[c] = child.box.box();
      const AreaChild what = splitter_.is_leaf(child)
                                 ? AreaChild{AreaChild::kItems, child.first, child.count}
                                 : AreaChild{AreaChild::kNode, build(child), 0};
      (*nodes_)[number].child[c] = what;
    }
    return number;
  }

 private:
  const Splitter& splitter_;
  std::vector<AreaNode>* nodes_;
};

/// Splits runs level by level until each is small enough for a part.
class TopBuilder {
 public:
  TopBuilder(const Executor& executor, const Splitter& splitter, AreaTree* tree)
      : executor_(executor), splitter_(splitter), tree_(tree) {}

  void build(const Run& whole) {
    tree_->top.clear();
    std::vector<Run> level;
    if (whole.count > kPartItems)
      level.push_back(whole);
    else
      parts_.push_back(whole);
    while (!level.empty()) level = build_level(level);
  }

  [[nodiscard]] const std::vector<Run>& parts() const { return parts_; }

 private:
  std::vector<Run> build_level(const std::vector<Run>& level) {
    std::vector<std::array<Run, kBvhWidth>> children(level.size());
    const std::size_t first = tree_->top.size(), after = first + level.size();
    tree_->top.resize(after);
    const auto open = [&](std::size_t i) {
      tree_->top[first + i].children = splitter_.open(level[i], &children[i]);
    };
    for (std::size_t i = 0; i < level.size(); ++i)
      if (Splitter::is_long(level[i])) open(i);
    executor_.for_each(level.size(), 1, [&](std::size_t i) {
      if (!Splitter::is_long(level[i])) open(i);
    });
    std::vector<Run> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      AreaNode& node = tree_->top[first + i];
      for (std::uint32_t c = 0; c < node.children; ++c) {
        const Run& run = children[i][c];
        node.box[c] = run.box.box();
        if (splitter_.is_leaf(run)) {
          node.child[c] = {AreaChild::kItems, run.first, run.count};
        } else if (run.count <= kPartItems) {
          node.child[c] = {AreaChild::kPart, static_cast<std::uint32_t>(parts_.size()), 0};
          parts_.push_back(run);
        } else {
          node.child[c] = {AreaChild::kNode, static_cast<std::uint32_t>(after + next.size()), 0};
          next.push_back(run);
        }
      }
    }
    return next;
  }

  const Executor& executor_;
  const Splitter& splitter_;
  AreaTree* tree_;
  std::vector<Run> parts_;
};

}  // namespace

std::size_t AreaTree::memory_bytes() const {
  std::size_t bytes = top.capacity() * sizeof(AreaNode) + parts.capacity() * sizeof(AreaPart);
  for (const AreaPart& part : parts) bytes += part.nodes.capacity() * sizeof(AreaNode);
  return bytes;
}

void build_area_tree(const Executor& executor, View<AreaItem> items, const AreaOptions& options,
                     AreaTree* tree) {
  const Splitter splitter(executor, items, options);
  TopBuilder top(executor, splitter, tree);
  tree->part_count = 0;
  tree->top.clear();
  if (items.empty()) return;
  top.build(splitter.measured(0, static_cast<std::uint32_t>(items.size)));
  const std::vector<Run>& runs = top.parts();
  tree->part_count = runs.size();
  if (tree->parts.size() < runs.size()) tree->parts.resize(runs.size());
  executor.for_each(runs.size(), 1, [&](std::size_t p) {
    AreaPart& part = tree->parts[p];
    part.first = runs[p].first;
    part.count = runs[p].count;
    part.box = runs[p].box.box();
    part.nodes.clear();
    PartBuilder(splitter, &part.nodes).build(runs[p]);
  });
}

}  // namespace raysheaf
