#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/bits.h"
#include "base/buffer.h"
#include "base/vec.h"
#include "object_tree/area_tree.h"
#include "object_tree/fine_build.h"
#include "object_tree/object_tree.h"
#include "object_tree/tree_emission.h"
#include "object_tree/triangle_reader.h"

namespace raysheaf {
namespace {

std::vector<AreaItem> items_of(const TriangleSource& source, View<const std::uint32_t> numbers) {
  std::vector<AreaItem> items;
  items.reserve(numbers.size);
  for (const std::uint32_t number : numbers) {
    const TriangleRun& run = source.runs[source.run_of(number)];
    const std::array<Vec3, 3> c = run.corners(number - run.first);
    items.push_back({min(min(c[0], c[1]), c[2]), number, max(max(c[0], c[1]), c[2]), 1});
  }
  return items;
}

AreaItem item_of(const TriangleQuad& quad, std::uint32_t lane) {
  Box box;
  for (const auto& corner : quad.vertex) {
    const Vec3 p{corner[0][lane], corner[1][lane], corner[2][lane]};
    box = {min(box.min, p), max(box.max, p)};
  }
  return {box.min, quad.id[lane], box.max, 1};
}

/// Calls `body(child, box)` for each child of nodes that is a run of items.
template <class Body>
void for_each_leaf(std::vector<AreaNode>& nodes, const Body& body) {
  for (AreaNode& node : nodes)
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.child[c].kind == AreaChild::kItems) body(node.child[c], node.box[c]);
}

/// Gives each leaf of an area tree a quad with the numbers of its triangles, and writes the nodes.
/// Corners are left to the caller. The arrays and trees must outlive it.
class Emission {
 public:
  Emission(AreaTree& area, View<const AreaItem> items, ObjectTree* tree)
      : area_(area), items_(items), tree_(*tree), first_(area.part_count + 2) {}

  /// Continues with as many regions as there are visits left for; returns whether it is complete.
  bool advance(const Executor& executor, Visits* visits) {
    for (; stage_ != kDone; next_ = 0, stage_ = static_cast<Stage>(stage_ + 1)) {
      const std::size_t begin = next_;
      while (next_ < region_count() && visits->take(1, visits_of(next_)) == 1) ++next_;
      executor.for_each(next_ - begin, 1, [&](std::size_t i) { take_region(begin + i); });
      if (next_ < region_count()) return false;
      finish_stage();
    }
    return true;
  }

 private:
  enum Stage { kCount, kLeaves, kNodes, kDone };

  [[nodiscard]] std::size_t region_count() const { return area_.part_count + 1; }
  [[nodiscard]] std::vector<AreaNode>& nodes_of(std::size_t region) const {
    return region == 0 ? area_.top : area_.parts[region - 1].nodes;
  }
  [[nodiscard]] std::uint64_t visits_of(std::size_t region) const {
    constexpr std::uint64_t kOfItem[] = {1, 6, 3};
    const std::uint64_t items =
        region == 0 ? kBvhWidth * area_.top.size() : area_.parts[region - 1].count;
    return kOfItem[stage_] * items;
  }

  void take_region(std::size_t region) {
    if (stage_ == kCount) {
      for_each_leaf(nodes_of(region), [&](const AreaChild&, const Box&) { ++first_[region + 1]; });
    } else if (stage_ == kLeaves) {
      write_leaves(region);
      nodes_->count(region);
    } else {
      nodes_->write(region);
    }
  }
  void finish_stage() {
    if (stage_ == kCount) make_room();
    if (stage_ == kLeaves) nodes_->place();
    if (stage_ == kNodes) nodes_->finish();
  }

  void make_room() {
    for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
    TreeScratch& scratch = tree_.scratch;
    tree_.quads.resize_uninitialized(first_.back());
    scratch.leaves.resize_uninitialized(first_.back());
    scratch.clusters.resize_uninitialized(first_.back());
    nodes_.emplace(area_, View<const AreaItem>(scratch.clusters.data(), scratch.clusters.size()),
                   View<const AreaItem>(scratch.leaves.data(), scratch.leaves.size()), &tree_);
  }
  void write_leaves(std::size_t region) {
    std::uint32_t leaf = first_[region];
    for_each_leaf(nodes_of(region), [&](AreaChild& child, const Box& box) {
      for (std::uint32_t lane = 0; lane < kQuadTriangles; ++lane)
        tree_.quads[leaf].id[lane] = items_[child.first + (lane < child.count ? lane : 0)].ref;
      tree_.scratch.leaves[leaf] = {box.min, leaf, box.max, child.count};
      tree_.scratch.clusters[leaf] = {box.min, leaf, box.max, 1};
      child.first = leaf++;
    });
  }

  AreaTree& area_;
  View<const AreaItem> items_;
  ObjectTree& tree_;
  std::vector<std::uint32_t> first_;  ///< the first leaf of each region, and the end
  std::optional<NodeEmission> nodes_;
  Stage stage_ = kCount;
  std::size_t next_ = 0;  ///< region of the stage
};

/// More visits than any build needs.
constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 50;

}  // namespace

class FineBuild::State {
 public:
  explicit State(const ObjectTree& tree) {
    items_.resize_uninitialized(tree.triangles);
    built_.triangles = tree.triangles;
  }

  void triangles_moved() { has_moved_ = true; }
  [[nodiscard]] bool is_complete() const {
    return stage_ == kCorners && (has_moved_ || next_quad_ == built_.quads.size());
  }

  void advance(const Executor& executor, const TriangleSource& source, const ObjectTree& former,
               Visits* visits) {
    for (; stage_ != kCorners; stage_ = static_cast<Stage>(stage_ + 1))
      if (!advance_stage(executor, former, visits)) return;
    if (!has_moved_) read_corners(executor, source, visits);
  }

  bool finish(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
    built_.left_out = std::move(tree->left_out);
    std::swap(*tree, built_);
    return !has_moved_ || refit_object_tree(executor, source, MovedTriangles::everything(), tree);
  }

  [[nodiscard]] std::size_t memory_bytes() const {
    return items_.capacity_bytes() + area_.memory_bytes() + built_.memory_bytes() +
           (builder_.has_value() ? builder_->memory_bytes() : 0);
  }

 private:
  enum Stage { kBoxes, kCuts, kEmission, kCorners };

  /// Returns whether the stage is complete.
  bool advance_stage(const Executor& executor, const ObjectTree& former, Visits* visits) {
    if (stage_ == kBoxes) {
      constexpr AreaOptions kFine{kQuadTriangles, true, true, 8192};
      if (!gather(executor, former, visits)) return false;
      builder_.emplace(View<AreaItem>(items_.data(), items_.size()), kFine, &area_);
    } else if (stage_ == kCuts) {
      builder_->advance(executor, visits);
      if (!builder_->is_complete()) return false;
      builder_.reset();
      emission_.emplace(area_, View<const AreaItem>(items_.data(), items_.size()), &built_);
    } else {
      if (!emission_->advance(executor, visits)) return false;
      emission_.reset();
      items_ = {};
      area_ = {};
    }
    return true;
  }

  /// Appends the boxes of triangles below the next nodes; returns whether these were the last.
  bool gather(const Executor& executor, const ObjectTree& tree, Visits* visits) {
    constexpr std::uint32_t kBlockNodes = 64, kBlockVisits = kBlockNodes * kBvhWidth * 4;
    const auto nodes = static_cast<std::uint32_t>(tree.nodes.size());
    const auto blocks = static_cast<std::uint32_t>(
        visits->take(div_ceil(nodes - next_node_, kBlockNodes), kBlockVisits));
    const auto for_each_node = [&](std::size_t block, const auto& body) {
      const std::uint32_t begin = next_node_ + static_cast<std::uint32_t>(block) * kBlockNodes;
      for (std::uint32_t n = begin; n < std::min(nodes, begin + kBlockNodes); ++n)
        body(tree.nodes[n]);
    };
    std::vector<std::uint32_t> first(blocks + 1);
    executor.for_each(blocks, 1, [&](std::size_t b) {
      for_each_node(b, [&](const BvhNode& node) {
        for (const std::uint8_t count : node.count) first[b + 1] += count;
      });
    });
    first[0] = gathered_;
    for (std::uint32_t b = 0; b < blocks; ++b) first[b + 1] += first[b];
    executor.for_each(blocks, 1, [&](std::size_t b) {
      AreaItem* item = items_.data() + first[b];
      for_each_node(b, [&](const BvhNode& node) {
        for (std::uint32_t c = 0; c < node.children; ++c)
          for (std::uint32_t i = 0; i < node.count[c]; ++i)
            *item++ = item_of(tree.quads[node.first[c] + i / kQuadTriangles], i % kQuadTriangles);
      });
    });
    next_node_ = std::min(nodes, next_node_ + blocks * kBlockNodes);
    gathered_ = first[blocks];
    return next_node_ == nodes;
  }

  void read_corners(const Executor& executor, const TriangleSource& source, Visits* visits) {
    constexpr std::size_t kBlockQuads = 256, kVisitsOfQuad = 12;
    const std::size_t first = next_quad_, quads = built_.quads.size();
    const std::size_t blocks =
        visits->take(div_ceil(quads - first, kBlockQuads), kBlockQuads * kVisitsOfQuad);
    next_quad_ = std::min(quads, first + blocks * kBlockQuads);
    executor.for_each(blocks, 1, [&](std::size_t b) {
      const std::size_t begin = first + b * kBlockQuads;
      refill_quads(source, begin, std::min(next_quad_, begin + kBlockQuads), built_);
    });
  }

  Stage stage_ = kBoxes;
  bool has_moved_ = false;
  Buffer<AreaItem> items_;       ///< boxes of the triangles, with their numbers
  std::uint32_t gathered_ = 0;   ///< of the items
  std::uint32_t next_node_ = 0;  ///< of the former tree
  AreaTree area_;
  std::optional<AreaTreeBuilder> builder_;  ///< over the items
  std::optional<Emission> emission_;
  ObjectTree built_;
  std::size_t next_quad_ = 0;  ///< whose corners are read next
};

FineBuild::FineBuild() = default;
FineBuild::~FineBuild() = default;
FineBuild::FineBuild(FineBuild&&) noexcept = default;
FineBuild& FineBuild::operator=(FineBuild&&) noexcept = default;

void FineBuild::begin(const ObjectTree& tree) {
  abandon();
  state_ = std::make_unique<State>(tree);
}

bool FineBuild::is_complete() const {
  return has_begun() && state_->is_complete();
}

void FineBuild::triangles_moved() {
  state_->triangles_moved();
}

double FineBuild::advance(const Executor& executor, const TriangleSource& source,
                          const ObjectTree& tree, double ns) {
  constexpr double kVisit = 8;
  const Visits given{ns < kVisit * kNoLimit ? static_cast<std::uint64_t>(ns / kVisit) : kNoLimit};
  Visits left = given;
  state_->advance(executor, source, tree, &left);
  return kVisit * static_cast<double>(given.left - left.left);
}

bool FineBuild::finish(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  const std::unique_ptr<State> built = std::move(state_);
  return built->finish(executor, source, tree);
}

std::size_t FineBuild::memory_bytes() const {
  return has_begun() ? state_->memory_bytes() : 0;
}

void build_fine_object_tree(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree) {
  build_object_tree(executor, source, tree);
  if (tree->empty()) return;
  FineBuild build;
  build.begin(*tree);
  build.advance(executor, source, *tree, std::numeric_limits<double>::infinity());
  static_cast<void>(build.finish(executor, source, tree));
  tree->scratch = {};
}

void build_object_tree_of(const Executor& executor, const TriangleSource& source,
                          View<const std::uint32_t> numbers, ObjectTree* tree) {
  tree->left_out.clear();
  std::vector<AreaItem> items = items_of(source, numbers);
  tree->triangles = static_cast<std::uint32_t>(items.size());
  AreaTree area;
  build_area_tree(executor, items, {kQuadTriangles, true, true}, &area);
  Visits all{kNoLimit};
  Emission(area, items, tree).advance(executor, &all);
  executor.for_each_block(tree->quads.size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
    TriangleReader reader(source);
    for (std::size_t q = begin; q < end; ++q) {
      TriangleQuad& quad = tree->quads[q];
      LoadedTriangle t[kQuadTriangles];
      for (std::uint32_t i = 0; i < kQuadTriangles; ++i)
        t[i] = load_corners(reader.corners(quad.id[i]));
      store_quad(t, &quad);
    }
  });
  tree->scratch = {};  // the next rebuild is far away
}

}  // namespace raysheaf
