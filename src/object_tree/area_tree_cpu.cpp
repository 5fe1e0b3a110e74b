#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>
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
/// A block of a long run.
constexpr std::uint32_t kBlockItems = 4096;

/// How often each item of a run is visited: by a split (three axes of bins, partition,
/// measurement), by an opening into eight, and by a whole part.
constexpr std::uint32_t kVisitsOfSplit = 5, kVisitsOfOpening = 3 * kVisitsOfSplit,
                        kVisitsOfPart = 55;
constexpr std::uint64_t kAllVisits = std::uint64_t{1} << 62;

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

/// Cuts runs, each by one thread.
class Splitter {
 public:
  Splitter(View<AreaItem> items, const AreaOptions& options) : items_(items), options_(options) {}

  [[nodiscard]] View<AreaItem> items() const { return items_; }
  [[nodiscard]] bool is_leaf(const Run& run) const { return run.count <= options_.leaf_items; }
  [[nodiscard]] bool is_long(const Run& run) const { return run.count > options_.long_run; }

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
    while (Run* const next = next_to_split(children, count)) {
      make_room(children, count++, next);
      split(*next, next, next + 1);
    }
    return count;
  }
  /// The widest of the runs that are split; null if there is none, or no room.
  [[nodiscard]] Run* next_to_split(std::array<Run, kBvhWidth>* children,
                                   std::uint32_t count) const {
    if (count == kBvhWidth) return nullptr;
    Run* widest = nullptr;
    for (std::uint32_t c = 0; c < count; ++c) {
      Run& run = (*children)[c];
      if (is_leaf(run) && !run.splits) continue;
      if (widest == nullptr || run.area > widest->area ||
          (run.area == widest->area && run.count > widest->count))
        widest = &run;
    }
    return widest;
  }
  /// Frees the place after a run.
  static void make_room(std::array<Run, kBvhWidth>* children, std::uint32_t count, Run* run) {
    std::move_backward(run + 1, children->data() + count, children->data() + count + 1);
  }

  void split(const Run run, Run* left, Run* right) const {
    Cut cut;
    for (int axis = 0; axis < 3; ++axis) {
      if (const std::optional<Binning> binning = binning_of(run, axis))
        look_for_cut(fill(run.first, run.first + run.count, *binning), bins_of(run), axis, &cut);
    }
    const std::uint32_t count =
        cut.bin == 0 ? run.count / 2
                     : partition(run.first, run.first + run.count, binning_of(run, cut), cut.bin);
    finish_split(measured(run.first, count), measured(run.first + count, run.count - count), left,
                 right);
  }

  // The parts of `split`, by which `LongSplit` splits a run in blocks.

  [[nodiscard]] Run measured(std::uint32_t first, std::uint32_t count) const {
    Run run{first, count, {}, {}, 0, false};
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Float4 lo = item_min(items_[i]), hi = item_max(items_[i]), center = lo + hi;
      run.box.grow(lo, hi);
      run.centers.grow(center, center);
    }
    run.area = half_area(run.box);
    return run;
  }
  [[nodiscard]] static std::uint32_t bins_of(const Run& run) { return run.count < 32 ? 8 : kBins; }
  /// None along an axis that is not searched, or along which all centres are the same.
  [[nodiscard]] std::optional<Binning> binning_of(const Run& run, int axis) const {
    const Box centers = run.centers.box();
    if (!options_.three_axes && axis != widest_axis(centers)) return {};
    const Binning binning(centers, axis, bins_of(run));
    return binning.scale == 0 ? std::nullopt : std::optional(binning);
  }
  [[nodiscard]] static Binning binning_of(const Run& run, const Cut& cut) {
    return {run.centers.box(), cut.axis, bins_of(run)};
  }
  [[nodiscard]] Bins fill(std::uint32_t begin, std::uint32_t end, const Binning& binning) const {
    Bins bins;
    for (std::uint32_t i = begin; i < end; ++i) {
      const AreaItem& item = items_[i];
      const std::uint32_t b = binning(item);
      bins.box[b].grow(item_min(item), item_max(item));
      bins.weight[b] += item.weight;
      ++bins.count[b];
    }
    return bins;
  }
  /// Moves the items of the bins before `cut` to the front; returns how many. Has no branch that
  /// depends on the items, which would be unpredictable.
  [[nodiscard]] std::uint32_t partition(std::uint32_t begin, std::uint32_t end,
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
  void finish_split(const Run& first, const Run& second, Run* left, Run* right) const {
    *left = first;
    *right = second;
    if (!options_.small_leaves) return;
    left->splits = pays_to_split(*left);
    right->splits = pays_to_split(*right);
  }

 private:
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

  View<AreaItem> items_;
  AreaOptions options_;
};

/// Measures a run by all threads, in blocks.
class LongMeasure {
 public:
  LongMeasure(std::uint32_t first, std::uint32_t count) : first_(first), count_(count) {
    blocks_.resize(div_ceil(count, kBlockItems));
  }

  /// Returns whether it is complete.
  bool advance(const Executor& executor, const Splitter& splitter, Visits* visits) {
    const std::size_t some = visits->take(blocks_.size() - next_, kBlockItems);
    executor.for_each(some, 1, [&](std::size_t i) {
      const auto begin = static_cast<std::uint32_t>(next_ + i) * kBlockItems;
      blocks_[next_ + i] = splitter.measured(first_ + begin, std::min(count_ - begin, kBlockItems));
    });
    next_ += some;
    return next_ == blocks_.size();
  }
  [[nodiscard]] Run result() const {
    Run run{first_, count_, {}, {}, 0, false};
    for (const Run& block : blocks_) {
      run.box.grow(block.box);
      run.centers.grow(block.centers);
    }
    run.area = half_area(run.box);
    return run;
  }

 private:
  std::uint32_t first_, count_;
  std::vector<Run> blocks_;
  std::size_t next_ = 0;
};

/// `Splitter::split` by all threads, in blocks.
class LongSplit {
 public:
  explicit LongSplit(const Run& run) : run_(run), blocks_(div_ceil(run.count, kBlockItems)) {
    bins_.resize(blocks_);
    left_of_.resize(blocks_);
  }

  /// Returns whether it is complete.
  bool advance(const Executor& executor, const Splitter& splitter, Visits* visits) {
    for (; stage_ != kDone; next_ = 0, stage_ = static_cast<Stage>(stage_ + 1))
      if (!advance_stage(executor, splitter, visits)) return false;
    return true;
  }
  void finish(const Splitter& splitter, Run* left, Run* right) const {
    splitter.finish_split(left_->result(), right_->result(), left, right);
  }

 private:
  enum Stage { kFill, kPartition, kExchange, kMeasureLeft, kMeasureRight, kDone };

  bool advance_stage(const Executor& executor, const Splitter& splitter, Visits* visits) {
    if (stage_ == kMeasureLeft) return left_->advance(executor, splitter, visits);
    if (stage_ == kMeasureRight) return right_->advance(executor, splitter, visits);
    if (stage_ != kFill && cut_.bin == 0) return divide(run_.count / 2);
    const std::uint64_t each = stage_ == kFill ? 3 * kBlockItems : kBlockItems;
    const std::size_t first = next_, some = visits->take(blocks_ - next_, each);
    executor.for_each(some, 1, [&](std::size_t i) { take_block(splitter, first + i); });
    next_ += some;
    if (next_ < blocks_) return false;
    if (stage_ == kFill) choose_cut(splitter);
    if (stage_ == kPartition) plan_exchange();
    if (stage_ == kExchange) divide(left_count_);
    return true;
  }

  void take_block(const Splitter& splitter, std::size_t block) {
    const std::uint32_t begin = run_.first + static_cast<std::uint32_t>(block) * kBlockItems;
    const std::uint32_t end = std::min(run_.first + run_.count, begin + kBlockItems);
    if (stage_ == kFill) {
      for (int axis = 0; axis < 3; ++axis)
        if (const std::optional<Binning> binning = splitter.binning_of(run_, axis))
          bins_[block][axis] = splitter.fill(begin, end, *binning);
    } else if (stage_ == kPartition) {
      left_of_[block] = splitter.partition(begin, end, Splitter::binning_of(run_, cut_), cut_.bin);
    } else {
      exchange(splitter.items().data, rights_, lefts_, block, blocks_);
    }
  }

  void choose_cut(const Splitter& splitter) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!splitter.binning_of(run_, axis).has_value()) continue;
      Bins bins;
      for (const std::array<Bins, 3>& block : bins_) bins.add(block[axis]);
      look_for_cut(bins, Splitter::bins_of(run_), axis, &cut_);
    }
  }

  /// Lists the items of the right side before the border, and of the left side after it.
  void plan_exchange() {
    for (const std::uint32_t each : left_of_) left_count_ += each;
    const std::uint32_t border = run_.first + left_count_;
    std::uint32_t begin = run_.first;
    for (const std::uint32_t each : left_of_) {
      const std::uint32_t end = std::min(run_.first + run_.count, begin + kBlockItems);
      const std::uint32_t middle = begin + each;
      if (middle < std::min(end, border)) rights_.push_back({middle, std::min(end, border)});
      if (std::max(begin, border) < middle) lefts_.push_back({std::max(begin, border), middle});
      begin = end;
    }
  }

  bool divide(std::uint32_t count) {
    left_.emplace(run_.first, count);
    right_.emplace(run_.first + count, run_.count - count);
    return true;
  }

  Run run_;
  std::size_t blocks_, next_ = 0;
  Stage stage_ = kFill;
  std::vector<std::array<Bins, 3>> bins_;  ///< of each block
  Cut cut_;
  std::vector<std::uint32_t> left_of_;  ///< how many items of each block go to the left
  std::uint32_t left_count_ = 0;
  std::vector<Range> rights_, lefts_;
  std::optional<LongMeasure> left_, right_;
};

/// `Splitter::open` for a long run.
class LongOpening {
 public:
  explicit LongOpening(const Run& whole) { children_[0] = whole; }

  /// Returns whether it is complete.
  bool advance(const Executor& executor, const Splitter& splitter, Visits* visits) {
    while (Run* const next = splitter.next_to_split(&children_, count_)) {
      if (splitter.is_long(*next)) {
        if (!split_.has_value()) split_.emplace(*next);
        if (!split_->advance(executor, splitter, visits)) return false;
        Splitter::make_room(&children_, count_++, next);
        split_->finish(splitter, next, next + 1);
        split_.reset();
      } else {
        if (visits->take(1, std::uint64_t{kVisitsOfSplit} * next->count) == 0) return false;
        Splitter::make_room(&children_, count_++, next);
        splitter.split(*next, next, next + 1);
      }
    }
    return true;
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const std::array<Run, kBvhWidth>& children() const { return children_; }

 private:
  std::array<Run, kBvhWidth> children_;
  std::uint32_t count_ = 1;
  std::optional<LongSplit> split_;
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

}  // namespace

/// Splits runs level by level until each is small enough for a part, then builds the parts.
class AreaTreeBuilder::Steps {
 public:
  Steps(View<AreaItem> items, const AreaOptions& options, AreaTree* tree)
      : splitter_(items, options),
        tree_(*tree),
        measure_(std::in_place, 0, static_cast<std::uint32_t>(items.size)) {
    tree_.top.clear();
    tree_.part_count = 0;
  }

  void advance(const Executor& executor, Visits* visits) {
    if (measure_.has_value()) {
      if (!measure_->advance(executor, splitter_, visits)) return;
      begin_top(measure_->result());
      measure_.reset();
    }
    while (!level_.empty()) {
      if (!open_level(executor, visits)) return;
      finish_level();
      if (level_.empty()) begin_parts();
    }
    build_parts(executor, visits);
  }
  [[nodiscard]] bool is_complete() const {
    return !measure_.has_value() && level_.empty() && next_part_ == parts_.size();
  }
  [[nodiscard]] std::size_t memory_bytes() const {
    return (level_.capacity() + parts_.capacity()) * sizeof(Run) +
           opened_.capacity() * sizeof(Opened);
  }

 private:
  struct Opened {
    std::uint32_t count = 0;
    std::array<Run, kBvhWidth> children;
  };

  void begin_top(const Run& whole) {
    if (whole.count > kPartItems) return begin_level({whole});
    parts_.push_back(whole);
    begin_parts();
  }
  void begin_level(std::vector<Run> level) {
    level_ = std::move(level);
    opened_.assign(level_.size(), {});
    next_ = 0;
    if (level_.empty()) return;
    // Long runs one after the other, then short ones in parallel.
    order_.clear();
    for (std::uint32_t i = 0; i < level_.size(); ++i)
      if (splitter_.is_long(level_[i])) order_.push_back(i);
    long_count_ = order_.size();
    for (std::uint32_t i = 0; i < level_.size(); ++i)
      if (!splitter_.is_long(level_[i])) order_.push_back(i);
  }

  /// Returns whether all runs of the level are split.
  bool open_level(const Executor& executor, Visits* visits) {
    for (; next_ < long_count_; ++next_) {
      const std::uint32_t run = order_[next_];
      if (!opening_.has_value()) opening_.emplace(level_[run]);
      if (!opening_->advance(executor, splitter_, visits)) return false;
      opened_[run] = {opening_->count(), opening_->children()};
      opening_.reset();
    }
    std::size_t end = next_;
    while (end < order_.size() &&
           visits->take(1, std::uint64_t{kVisitsOfOpening} * level_[order_[end]].count) == 1)
      ++end;
    executor.for_each(end - next_, 1, [&](std::size_t i) {
      const std::uint32_t run = order_[next_ + i];
      opened_[run].count = splitter_.open(level_[run], &opened_[run].children);
    });
    next_ = end;
    return next_ == order_.size();
  }

  /// Writes the nodes of the level, and begins the next.
  void finish_level() {
    const std::size_t first = tree_.top.size(), after = first + level_.size();
    tree_.top.resize(after);
    std::vector<Run> next;
    for (std::size_t i = 0; i < level_.size(); ++i) {
      AreaNode& node = tree_.top[first + i];
      node.children = opened_[i].count;
      for (std::uint32_t c = 0; c < node.children; ++c) {
        const Run& run = opened_[i].children[c];
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
    begin_level(std::move(next));
  }

  void begin_parts() {
    tree_.part_count = parts_.size();
    if (tree_.parts.size() < parts_.size()) tree_.parts.resize(parts_.size());
  }
  void build_parts(const Executor& executor, Visits* visits) {
    std::size_t end = next_part_;
    while (end < parts_.size() &&
           visits->take(1, std::uint64_t{kVisitsOfPart} * parts_[end].count) == 1)
      ++end;
    executor.for_each(end - next_part_, 1, [&](std::size_t i) {
      const Run& run = parts_[next_part_ + i];
      AreaPart& part = tree_.parts[next_part_ + i];
      part.first = run.first;
      part.count = run.count;
      part.box = run.box.box();
      part.nodes.clear();
      PartBuilder(splitter_, &part.nodes).build(run);
    });
    next_part_ = end;
  }

  Splitter splitter_;
  AreaTree& tree_;
  std::optional<LongMeasure> measure_;
  std::vector<Run> level_;            ///< the runs of the current level
  std::vector<Opened> opened_;        ///< each of them, split
  std::vector<std::uint32_t> order_;  ///< in which they are split
  std::size_t long_count_ = 0, next_ = 0;
  std::optional<LongOpening> opening_;  ///< of the long run `next_`
  std::vector<Run> parts_;
  std::size_t next_part_ = 0;
};

AreaTreeBuilder::AreaTreeBuilder(View<AreaItem> items, const AreaOptions& options, AreaTree* tree)
    : steps_(std::make_unique<Steps>(items, options, tree)) {}
AreaTreeBuilder::~AreaTreeBuilder() = default;
AreaTreeBuilder::AreaTreeBuilder(AreaTreeBuilder&&) noexcept = default;
AreaTreeBuilder& AreaTreeBuilder::operator=(AreaTreeBuilder&&) noexcept = default;

void AreaTreeBuilder::advance(const Executor& executor, Visits* visits) {
  steps_->advance(executor, visits);
}
bool AreaTreeBuilder::is_complete() const {
  return steps_->is_complete();
}
std::size_t AreaTreeBuilder::memory_bytes() const {
  return sizeof(Steps) + steps_->memory_bytes();
}

std::size_t AreaTree::memory_bytes() const {
  std::size_t bytes = top.capacity() * sizeof(AreaNode) + parts.capacity() * sizeof(AreaPart);
  for (const AreaPart& part : parts) bytes += part.nodes.capacity() * sizeof(AreaNode);
  return bytes;
}

void build_area_tree(const Executor& executor, View<AreaItem> items, const AreaOptions& options,
                     AreaTree* tree) {
  if (items.empty()) {
    tree->top.clear();
    tree->part_count = 0;
    return;
  }
  Visits all{kAllVisits};
  AreaTreeBuilder(items, options, tree).advance(executor, &all);
}

}  // namespace raysheaf
