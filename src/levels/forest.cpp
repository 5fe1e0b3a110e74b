#include "levels/forest.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/vec.h"
#include "exec/radix_sort.h"

namespace raysheaf {
namespace {

/// A tree that has become this much worse is built again.
constexpr float kMostTopCost = 1.5f;
/// Worlds of at most so many instances are cut at medians: two levels of nodes.
constexpr std::uint32_t kFew = kBvhWidth * kBvhWidth;
/// Worlds a task.
constexpr std::size_t kWorldGrain = 64;
/// Rays are grouped if more than one in so many is in another world than the ray before.
constexpr std::size_t kGroupedRays = 8;

/// Runs of at most eight instances.
std::uint32_t runs_of(std::uint32_t instances) {
  return (instances + kBvhWidth - 1) / kBvhWidth;
}
/// A node for each run, and one above them.
std::uint32_t nodes_of(std::uint32_t instances) {
  return instances <= kBvhWidth ? 1 : 1 + runs_of(instances);
}

Box united(const Box& a, const Box& b) {
  return {min(a.min, b.min), max(a.max, b.max)};
}

/// Sets the children that there are; returns the box of all.
template <class BoxOf, class FirstOf>
Box fill(BvhNode* node, std::uint32_t children, std::uint8_t count, const BoxOf& box_of,
         const FirstOf& first_of) {
  Box bounds;
  node->children = children;
  for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
    const bool is = c < children;
    const Box box = is ? box_of(c) : Box();
    bounds = united(bounds, box);
    node->set_box(c, box);
    node->first[c] = is ? first_of(c) : 0;
    node->count[c] = is ? count : 0;
  }
  return bounds;
}

/// The tree of a world of few instances.
class FewInstances {
 public:
  FewInstances(View<const Box> boxes, View<std::uint32_t> members, BvhNode* nodes,
               std::uint32_t first)
      : members_(members), nodes_(nodes), first_(first) {
    for (std::size_t i = 0; i < members.size; ++i) items_[i] = {boxes[members[i]], members[i]};
  }

  /// Returns the box of all.
  Box build() {
    const auto size = static_cast<std::uint32_t>(members_.size);
    if (size <= kBvhWidth) return fill_leaves(0, size, nodes_);
    const std::uint32_t runs = runs_of(size);
    cut(0, size, 0, runs);
    return fill(
        nodes_, runs, 0, [&](std::uint32_t c) { return of_run_[c]; },
        [&](std::uint32_t c) { return first_ + 1 + c; });
  }

 private:
  struct Item {
    Box box;
    std::uint32_t instance = 0;
  };

  Box fill_leaves(std::uint32_t begin, std::uint32_t end, BvhNode* node) {
    return fill(
        node, end - begin, 1, [&](std::uint32_t c) { return items_[begin + c].box; },
        [&](std::uint32_t c) { return items_[begin + c].instance; });
  }

  /// Makes so many runs of the items, at medians along the longest axis of their centres.
  void cut(std::uint32_t begin, std::uint32_t end, std::uint32_t first_run, std::uint32_t runs) {
    if (runs == 1) {
      of_run_[first_run] = fill_leaves(begin, end, nodes_ + 1 + first_run);
      return;
    }
    const auto centre = [](const Item& item) { return item.box.min + item.box.max; };
    Box centres;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Vec3 at = centre(items_[i]);
      centres = united(centres, {at, at});
    }
    const Vec3 size = centres.max - centres.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    // No run gets more than eight: of 8 r items, at most 8 h go to h of r runs.
    const std::uint32_t half = runs / 2, middle = begin + (end - begin) * half / runs;
    std::nth_element(items_ + begin, items_ + middle, items_ + end,
                     [&](const Item& a, const Item& b) {
                       return component(centre(a), axis) < component(centre(b), axis);
                     });
    cut(begin, middle, first_run, half);
    cut(middle, end, first_run + half, runs - half);
  }

  View<std::uint32_t> members_;
  BvhNode* nodes_;
  std::uint32_t first_;  ///< the number of nodes_[0]
  Item items_[kFew];
  Box of_run_[kBvhWidth];
};

}  // namespace

void TopTree::update(const Executor& executor, View<const Box> boxes,
                     View<const std::uint32_t> members, bool is_same) {
  // Lost if memory runs out or the caller cancels, so that no half a tree is refitted later.
  ObjectTree tree = std::exchange(tree_, {});
  const bool follows = is_same && !tree.empty();
  if (follows) refit_top_tree(executor, boxes, &tree);
  if (!follows || tree.surface_area_cost > kMostTopCost * cost_when_built_) {
    build_top_tree(executor, boxes, &tree, members);
    cost_when_built_ = tree.surface_area_cost;
  }
  tree_ = std::move(tree);
}

void Forest::list(View<const WorldId> worlds) {
  if (std::equal(worlds.begin(), worlds.end(), world_of_.begin(), world_of_.end())) return;
  world_of_.clear();  // until all is done: memory may run out
  members_.resize(worlds.size);
  std::iota(members_.begin(), members_.end(), 0u);
  std::stable_sort(members_.begin(), members_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return worlds[a] < worlds[b]; });
  names_.clear();
  worlds_.clear();
  shared_ = {};
  std::uint32_t nodes = 0, trees = 0;
  const auto size = static_cast<std::uint32_t>(members_.size());
  for (std::uint32_t begin = 0, end = 0; begin < size; begin = end) {
    const WorldId name = worlds[members_[begin]];
    while (end < size && worlds[members_[end]] == name) ++end;
    World world{begin, end, 0, {}};
    if (name == kAllWorlds) {
      world.place = trees++;
      shared_ = world;
      break;
    }
    world.place = world.size() <= kFew ? nodes : trees++;
    if (world.size() <= kFew) nodes += nodes_of(world.size());
    names_.push_back(name);
    worlds_.push_back(world);
  }
  few_.nodes.resize_uninitialized(nodes);
  many_.resize(trees);
  is_new_ = true;
  world_of_.assign(worlds.begin(), worlds.end());
}

void Forest::update(const Executor& executor, View<const Box> boxes, View<const WorldId> worlds) {
  list(worlds);
  executor.for_each(worlds_.size(), kWorldGrain, [&](std::size_t w) {
    World& world = worlds_[w];
    if (world.size() > kFew) return;
    FewInstances few(boxes, {members_.data() + world.begin, world.size()},
                     few_.nodes.data() + world.place, world.place);
    world.bounds = few.build();
  });
  const auto update_many = [&](World* world) {
    TopTree& tree = many_[world->place];
    tree.update(executor, boxes, {members_.data() + world->begin, world->size()}, !is_new_);
    world->bounds = tree.tree().bounds;
  };
  for (World& world : worlds_)
    if (world.size() > kFew) update_many(&world);
  if (shared_.size() != 0) update_many(&shared_);
  is_new_ = false;
}

TopRoots Forest::roots_of(WorldId world) const {
  TopRoots roots;
  if (shared_.size() != 0) roots = {{{&many_[shared_.place].tree(), 0}, {}}, shared_.bounds};
  // Mostly they are numbered without gaps.
  std::size_t w = world;
  if (w >= names_.size() || names_[w] != world) {
    const auto found = std::lower_bound(names_.begin(), names_.end(), world);
    if (found == names_.end() || *found != world) return roots;
    w = static_cast<std::size_t>(found - names_.begin());
  }
  const World& own = worlds_[w];
  roots.of[1] =
      own.size() <= kFew ? TopRoot{&few_, own.place} : TopRoot{&many_[own.place].tree(), 0};
  roots.bounds = united(roots.bounds, own.bounds);
  return roots;
}

Box Forest::bounds() const {
  Box all = shared_.bounds;
  for (const World& world : worlds_) all = united(all, world.bounds);
  return all;
}

std::size_t Forest::memory_bytes() const {
  std::size_t bytes = (world_of_.capacity() + members_.capacity() + names_.capacity()) * 4 +
                      worlds_.capacity() * sizeof(World) + few_.memory_bytes();
  for (const TopTree& tree : many_) bytes += sizeof(TopTree) + tree.tree().memory_bytes();
  return bytes;
}

TopRoots roots_of(const LevelScene& scene, WorldId world) {
  if (world == kAllWorlds || scene.forest == nullptr)
    return {{{scene.top, 0}, {}}, scene.top->bounds};
  return scene.forest->roots_of(world);
}

Box bounds_of(const LevelScene& scene) {
  return scene.top != nullptr ? scene.top->bounds : scene.forest->bounds();
}

std::vector<std::uint32_t> order_by_world(const Executor& executor, const ItemWorlds& worlds,
                                          std::size_t count) {
  if (worlds.each == nullptr) return {};
  std::size_t changes = 0;
  for (std::size_t i = 1; i < count; ++i) changes += worlds.each[i] != worlds.each[i - 1] ? 1 : 0;
  if (changes <= count / kGroupedRays) return {};
  std::vector<std::uint32_t> keys(worlds.each, worlds.each + count), order(count);
  std::iota(order.begin(), order.end(), 0u);
  radix_sort_pairs(executor, keys, order);
  return order;
}

}  // namespace raysheaf
