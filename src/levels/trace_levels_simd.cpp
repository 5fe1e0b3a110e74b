// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is fused
// in what reaches an answer.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <mutex>
#include <utility>
#include <vector>

#include <hwy/cache_control.h>

#include "base/float.h"
#include "base/mirrors_body.h"
#include "geom/rounding.h"
#include "intersect/facing_body.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "levels/forest.h"
#include "levels/moving_mesh.h"
#include "levels/time_slices.h"
#include "levels/trace_levels.h"
#include "methods/dual/ray_stream.h"
#include "scene/motion.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "levels/trace_levels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "intersect/edges-inl.h"
#include "intersect/values-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What methods/dual/trace_simd.cpp includes too, in the same order.
#include "methods/dual/bundle16-inl.h"

#include "methods/dual/triangle-inl.h"

#include "methods/dual/single-inl.h"

#include "methods/dual/from_origin-inl.h"

#include "methods/dual/stream_walk-inl.h"

#include "levels/entered_ray-inl.h"

namespace {

/// A ray of a stream that goes on by itself.
struct PendingWalk {
  std::uint32_t ray, first, count;  ///< where it continues, as in BvhNode
  const LevelInstance* instance;    ///< in the mesh of this one; null: in the tree over instances
  const QuarterAxes* axes;
  StreamRay record;
};

template <class Mode>
class LevelWalk {
 public:
  /// `rows`: for all hits, if they are not only counted.
  LevelWalk(const LevelJob& job, LevelRowList* rows)
      : job_(job), rows_(rows), instances_(job.scene->instances.data) {
    if (job.scene->times != nullptr) met_.resize(kMetInstances);
  }

  /// Traces rays [begin, end), as they are ordered.
  void run(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t next = begin;
    walk_singles<!Mode::kAll>(
        *this, &walks_, SingleWalks::kMost,
        [&](std::uint32_t i) {
          if (begin_root(i)) return true;
          finish(&slots_[i]);
          for (; next != end; finish(&slots_[i])) {
            const std::uint32_t place = next++;
            if (begin_ray(i, job_.order != nullptr ? job_.order[place] : place)) return true;
            finish(&slots_[i]);
          }
          return false;
        },
        [](std::uint32_t, std::uint32_t, Interval, bool) {},
        [&](std::uint32_t i, std::uint32_t place) { settle(i, place); }, &counts_);
  }
  /// Traces rays of a stream.
  template <class Hits>
  void run(View<const PendingWalk> all, const RayStream& stream, Hits* hits) {
    const PendingWalk* next = all.begin();
    const PendingWalk* on_way[SingleWalks::kMost] = {};
    walk_singles<true>(
        *this, &walks_, SingleWalks::kMost,
        [&](std::uint32_t i) {
          if (on_way[i] != nullptr && slots_[i].found != 0)
            hits->take(on_way[i]->ray, slots_[i].best);
          while (next != all.end()) {
            const PendingWalk& walk = *next++;
            if (!begin_within(i, walk, stream, *hits)) continue;
            on_way[i] = &walk;
            return true;
          }
          on_way[i] = nullptr;
          return false;
        },
        [](std::uint32_t, std::uint32_t, Interval, bool) {},
        [&](std::uint32_t i, std::uint32_t place) { settle(i, place); }, &counts_);
  }
  [[nodiscard]] DualCounts take_counts() { return std::exchange(counts_, {}); }

  // For `walk_singles`. Trees over instances are above those of meshes.
  static constexpr bool kTwoLevels = true;
  [[nodiscard]] HWY_INLINE const BvhNode& node(std::uint32_t i, std::uint32_t number) {
    if (HWY_UNLIKELY((mixing_ >> i & 1) != 0)) return slots_[i].mesh.nodes.at(number, &node_room_);
    return trees_[i]->nodes[number];
  }
  [[nodiscard]] HWY_INLINE const TriangleQuad& quad(std::uint32_t i, std::uint32_t number) {
    if (HWY_UNLIKELY((mixing_ >> i & 1) != 0))
      return slots_[i].mesh.quads.at(number, &quad_room_[i]);
    return trees_[i]->quads[number];
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes(std::uint32_t i) const { return *axes_[i]; }
  [[nodiscard]] HWY_INLINE const Subtrees& subtrees(std::uint32_t i) const { return subtrees_[i]; }
  [[nodiscard]] static HWY_INLINE bool are_far() { return true; }
  [[nodiscard]] HWY_INLINE std::uint32_t above() const { return above_; }

  HWY_INLINE bool enter(std::uint32_t i) {
    Slot& slot = slots_[i];
    const std::uint32_t number = walks_.first[i];
    const LevelInstance& instance = instances_[number];
    if ((instance.mask & slot.mask) == 0) return false;
    slot.instance = &instance;
    slot.placing = &instance.placing;
    slot.mirrored = instance.mirrored;
    if (job_.scene->times != nullptr) {
      find_in_time(&slot, number);
      if (!slot.placing->may_enter) return pass_through(i);
    }
    if (std::exchange(boxed_, instance.tree) != instance.tree)
      box_ = EnteredBox(instance.tree->bounds);
    slot.world_slabs = walks_.slabs[i];
    AxesRay ray(slot.ray, slot.from, *slot.placing);
    ray.error += double{slot.mesh.error};
    if (!slot.entered.enter(ray, slot.ray.t_min, slot.limit, box_, &walks_.slabs[i])) return false;
    // Slabs of infinite width hold even the children that a node does not have.
    const SingleSlabs& slabs = walks_.slabs[i];
    if (!std::isfinite(slabs.x_near + slabs.y_near + slabs.z_near)) {
      walks_.slabs[i] = slot.world_slabs;
      return pass_through(i);
    }
    slot.found_before = slot.found;
    walks_.descend(i);
    go_on(i, slot.entered, *instance.tree, Subtrees(*instance.tree));
    if (slot.mesh.error != 0) {
      mixing_ |= 1u << i;
      subtrees_[i] = Subtrees(slot.mesh.nodes.before, slot.mesh.quads.before);
    }
    above_ &= ~(1u << i);
    return true;
  }
  HWY_INLINE void leave(std::uint32_t i) {
    const Slot& slot = slots_[i];
    walks_.base[i] = 0;
    mixing_ &= ~(1u << i);
    if (slot.found != slot.found_before) walks_.drop_beyond(i, slot.world.record.s_far);
    walks_.slabs[i] = slot.world_slabs;
    go_on(i, slot.world, *slot.top, Subtrees(slot.top->nodes.data(), instances_));
    above_ |= 1u << i;
  }

 private:
  struct Slot {
    std::uint32_t number = kInvalidId;  ///< of the ray; kInvalidId: none
    std::uint32_t mask = 0;             ///< by which it sees instances
    Ray ray;
    float from = 0;  ///< the largest coordinate of its origin
    TopRoots roots;
    std::uint32_t next_root = 2;
    const ObjectTree* top = nullptr;  ///< of the root where it is
    const LevelInstance* instance = nullptr;
    const Placing* placing = nullptr;  ///< of the instance, when the ray meets it
    bool mirrored = false;             ///< then
    Placing moved;                     ///< `placing`, of an instance that moves
    MeshInstant mesh;                  ///< its mesh then, if that moves; otherwise without an error
    EnteredRay world, entered;
    SingleSlabs world_slabs;         ///< while it is in an instance
    float limit = 0;                 ///< the t of the best hit, or t_max
    Hit best;                        ///< for any hit: one
    std::uint32_t found = 0;         ///< hits
    std::uint32_t found_before = 0;  ///< when the ray entered the instance
    std::vector<Hit> row;            ///< of them
  };

  HWY_INLINE void go_on(std::uint32_t i, const EnteredRay& ray, const ObjectTree& tree,
                        const Subtrees& subtrees) {
    walks_.ray[i] = &ray.record;
    trees_[i] = &tree;
    axes_[i] = ray.axes;
    subtrees_[i] = subtrees;
  }

  /// An instance at a time, which rays that follow each other often share.
  struct MetInstance {
    std::uint32_t number = kInvalidId;
    float time = 0;
    bool mirrored = false;
    Placing placing;
  };
  static constexpr std::uint32_t kMetInstances = 64;

  /// Sets where an instance is at the ray's time, and its mesh.
  void find_in_time(Slot* slot, std::uint32_t number) {
    const View<const Affine> motion = job_.scene->motions[number];
    const float time = job_.scene->times[slot->number];
    const MovingMesh* const moving = slot->instance->moving;
    if (moving != nullptr)
      slot->mesh = moving->at(time);
    else
      slot->mesh.error = 0;
    if (motion.empty()) return;
    MetInstance& met = met_[number % kMetInstances];
    if (met.number != number || met.time != time) {
      const Affine map = affine_at(motion, time);
      met = {number, time, mirrors(map), make_placing(map, slot->instance->tree->bounds)};
    }
    slot->moved = met.placing;  // other walks may meet it at another time before this one has left
    slot->placing = &slot->moved;
    slot->mirrored = met.mirrored;
  }

  /// Meets the triangles of an instance that the ray cannot enter, in boxes of its mesh that are
  /// placed one by one. Returns that the ray stays in the world.
  HWY_NOINLINE bool pass_through(std::uint32_t i) {
    Slot& slot = slots_[i];
    const Mix<BvhNode> mesh =
        slot.mesh.error != 0 ? slot.mesh.nodes : Mix<BvhNode>(slot.instance->tree->nodes.data());
    const Vec3 by{slot.mesh.error, slot.mesh.error, slot.mesh.error};
    const std::uint32_t found_before = slot.found;
    SingleSlabs slabs;  // not needed
    std::vector<std::uint32_t> nodes{0};
    while (!nodes.empty()) {
      BvhNode room;
      const BvhNode& node = mesh.at(nodes.back(), &room);
      nodes.pop_back();
      counts_.ray_box_tests += node.children;
      for (std::uint32_t c = 0; c < node.children; ++c) {
        const Box own = node.box(c);
        const EnteredBox box(placed_box(*slot.placing, {own.min - by, own.max + by}));
        if (!slot.entered.enter({slot.ray, slot.from, box.size}, slot.ray.t_min, slot.limit, box,
                                &slabs))
          continue;
        if (!node.is_leaf(c)) {
          nodes.push_back(node.first[c]);
          continue;
        }
        counts_.triangle_tests += node.count[c];
        for (std::uint32_t k = 0; k < node.count[c]; ++k)
          settle(i, kQuadTriangles * node.first[c] + k);
      }
    }
    if (slot.found != found_before) walks_.drop_beyond(i, slot.world.record.s_far);
    return false;
  }

  /// Goes on from the next root; returns whether there is one that the ray may reach.
  bool begin_root(std::uint32_t i) {
    Slot& slot = slots_[i];
    while (slot.next_root < std::size(slot.roots.of)) {
      const TopRoot root = slot.roots.of[slot.next_root++];
      if (root.tree == nullptr || !(slot.world.record.s_far >= 0)) continue;
      slot.top = root.tree;
      walks_.start(i, root.node, 0);
      go_on(i, slot.world, *slot.top, Subtrees(slot.top->nodes.data(), instances_));
      above_ |= 1u << i;
      return true;
    }
    return false;
  }

  /// Returns whether the ray meets the box of what it sees.
  bool begin_ray(std::uint32_t i, std::uint32_t number) {
    job_.executor->check();
    Slot& slot = slots_[i];
    const Ray& ray = job_.rays[number];
    slot.number = number;
    slot.ray = ray;
    slot.mask = job_.choice.mask_of(number);
    slot.row.clear();
    slot.best = Hit();
    slot.limit = ray.t_max;
    slot.found = 0;
    slot.next_root = static_cast<std::uint32_t>(std::size(slot.roots.of));
    if (job_.results.go_on && !go_on_from(&slot)) return false;
    const WorldId world = job_.choice.worlds[number];
    if (!has_world_ || world != world_) {
      roots_ = roots_of(*job_.scene, world);
      world_box_ = EnteredBox(roots_.bounds);
      world_ = world, has_world_ = true;
    }
    slot.from = max_component(abs(ray.origin));
    if (!(world_box_.low[0] <= world_box_.high[0]) ||
        !slot.world.enter({ray, slot.from, world_box_.size}, ray.t_min, slot.limit, world_box_,
                          &walks_.slabs[i]))
      return false;
    slot.roots = roots_;
    slot.next_root = 0;
    return begin_root(i);
  }

  /// Takes over the results of other instances; returns whether there may be more.
  [[nodiscard]] bool go_on_from(Slot* slot) const {
    const std::uint32_t number = slot->number;
    if constexpr (Mode::kAll) {
      if (rows_ != nullptr) {
        const std::uint64_t* const ends = job_.results.offsets + number;
        slot->row.assign(job_.results.begun + ends[0], job_.results.begun + ends[1]);
      } else {
        slot->found = job_.results.hit_counts[number];
      }
    } else if constexpr (Mode::kAny) {
      slot->found = job_.results.occluded[number];
      return slot->found == 0;
    } else {
      slot->best = job_.results.hits[number];
      slot->limit = std::min(slot->limit, slot->best.t);
    }
    return true;
  }

  /// Goes on with a ray of a stream; returns whether it may still meet something.
  template <class Hits>
  HWY_INLINE bool begin_within(std::uint32_t i, const PendingWalk& walk, const RayStream& stream,
                               const Hits& hits) {
    job_.executor->check();
    Slot& slot = slots_[i];
    slot.number = hits.number_of(walk.ray);
    slot.ray = job_.rays[slot.number];
    slot.from = max_component(abs(slot.ray.origin));
    slot.mask = job_.choice.mask_of(slot.number);
    slot.best = hits.best_of(walk.ray);
    slot.limit = hits.limit_of(walk.ray);
    slot.found = slot.found_before = 0;
    slot.next_root = static_cast<std::uint32_t>(std::size(slot.roots.of));
    slot.top = job_.scene->top;
    const bool above = walk.instance == nullptr;
    EnteredRay& ray = above ? slot.world : slot.entered;
    ray.record = walk.record;
    ray.axes = walk.axes;
    ray.shorten(slot.limit);
    if (!(ray.record.s_near <= ray.record.s_far)) return false;
    walks_.start(i, walk.first, walk.count);
    if (above) {
      walks_.slabs[i] = SingleSlabs(ray.record, stream);
      go_on(i, ray, *slot.top, Subtrees(slot.top->nodes.data(), instances_));
      above_ |= 1u << i;
      return true;
    }
    slot.instance = walk.instance;
    slot.placing = &walk.instance->placing;
    slot.mirrored = walk.instance->mirrored;
    const ObjectTree& tree = *walk.instance->tree;
    Growth growth(tree.bounds);
    growth.include(ray.record.along);
    walks_.slabs[i] = SingleSlabs(ray.record, *ray.axes, growth, ray.record.t_min);
    go_on(i, ray, tree, Subtrees(tree));
    above_ &= ~(1u << i);
    return true;
  }

  void finish(Slot* slot) {
    if (slot->number == kInvalidId) return;
    if constexpr (Mode::kAll) {
      if (rows_ != nullptr)
        add_row(slot);
      else
        job_.results.hit_counts[slot->number] = slot->found;
    } else if constexpr (Mode::kAny)
      job_.results.occluded[slot->number] = slot->found != 0 ? 1 : 0;
    else
      job_.results.hits[slot->number] = slot->best;
    slot->number = kInvalidId;
  }

  void add_row(Slot* slot) {
    std::sort(slot->row.begin(), slot->row.end(), is_before);
    rows_->hits.insert(rows_->hits.end(), slot->row.begin(), slot->row.end());
    rows_->rows.push_back({slot->number, rows_->hits.size()});
  }

  /// Tests a ray with the triangle at a place in its instance.
  HWY_NOINLINE void settle(std::uint32_t i, std::uint32_t place) {
    Slot& slot = slots_[i];
    const LevelInstance& instance = *slot.instance;
    PlacedCorners p(*instance.tree, place);
    if (slot.mesh.error != 0) {
      p = {slot.mesh.quads.before, place};
      const PlacedCorners after(slot.mesh.quads.after, place);
      const auto mixed = [&](Vec3 a, Vec3 b) { return slot.mesh.instant.mixed(a, b); };
      p.a = mixed(p.a, after.a), p.b = mixed(p.b, after.b), p.c = mixed(p.c, after.c);
    }
    if (!slot.placing->is_identity) {
      const auto placed = [&](Vec3 corner) { return transform_point(slot.placing->map, corner); };
      p.a = placed(p.a), p.b = placed(p.b), p.c = placed(p.c);
    }
    TriangleHit hit;
    if (!intersect_triangle(make_ray_setup(slot.ray), p.a, p.b, p.c, &hit) || hit.t > slot.limit)
      return;
    const std::uint32_t prim = id_at(*instance.tree, place);
    const Hit one{hit.t, hit.u, hit.v, prim, instance.geom_id, instance.inst_id};
    if (!Mode::kAll && is_before(slot.best, one)) return;
    if (!job_.choice.takes(slot.number, {instance.inst_id, prim}, slot.mirrored, hit.front)) return;
    if (instance.flags != nullptr) {
      const unsigned mirrored = slot.mirrored ? kMirrored : 0;
      const auto flags = static_cast<std::uint8_t>(instance.flags[prim] | mirrored);
      if (!shows(job_.choice.facing, flags, hit.front)) return;
    }
    ++slot.found;
    if constexpr (Mode::kAll) {
      if (rows_ != nullptr) slot.row.push_back(one);
      return;
    }
    slot.best = one;
    slot.limit = Mode::kAny ? -1 : hit.t;
    slot.entered.shorten(slot.limit);
    slot.world.shorten(slot.limit);
  }

  const LevelJob& job_;
  LevelRowList* rows_;
  const LevelInstance* const instances_;
  SingleWalks walks_;
  Slot slots_[SingleWalks::kMost];
  const ObjectTree* trees_[SingleWalks::kMost];
  BvhNode node_room_;
  TriangleQuad quad_room_[SingleWalks::kMost];
  const QuarterAxes* axes_[SingleWalks::kMost];
  Subtrees subtrees_[SingleWalks::kMost];
  bool has_world_ = false;
  WorldId world_ = kAllWorlds;  ///< of the last ray
  TopRoots roots_;              ///< and where it looks
  EnteredBox world_box_;        ///< their box
  const ObjectTree* boxed_ = nullptr;
  EnteredBox box_;                ///< of that tree
  std::uint32_t above_ = 0;       ///< bits of the walks that are in the tree over instances,
  std::uint32_t mixing_ = 0;      ///< and in a mesh that moves
  std::vector<MetInstance> met_;  ///< by the last bits of their numbers; only of rays with times
  DualCounts counts_;
};

}  // namespace

#include "levels/level_stream-inl.h"

namespace {

template <class Mode>
DualCounts trace_stream(const StreamJob& job, const LevelJob& levels, const TraceTask& task) {
  const Subtrees subtrees(levels.scene->top->nodes.data(), levels.scene->instances.data);
  return StreamWalk<Mode, LevelHits<Mode>, LevelSingles<Mode>>(job, subtrees, levels).run(task);
}

template <class Mode>
DualCounts trace_some(const LevelJob& job, LevelRowList* rows, std::uint32_t begin,
                      std::uint32_t end) {
  LevelWalk<Mode> walk(job, rows);
  walk.run(begin, end);
  return walk.take_counts();
}

}  // namespace

DualCounts TraceLevels(const LevelJob& job, LevelRowList* rows, std::uint32_t begin,
                       std::uint32_t end) {
  if (job.results.hits.data != nullptr) return trace_some<ClosestMode>(job, rows, begin, end);
  if (job.results.occluded.data != nullptr) return trace_some<AnyMode>(job, rows, begin, end);
  return trace_some<AllMode>(job, rows, begin, end);
}

DualCounts TraceLevelStreams(const StreamJob& job, const LevelJob& levels, const TraceTask& task) {
  return levels.results.hits.data != nullptr ? trace_stream<ClosestMode>(job, levels, task)
                                             : trace_stream<AnyMode>(job, levels, task);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {
namespace {

HWY_EXPORT(TraceLevels);
HWY_EXPORT(TraceLevelStreams);

/// Rays that one task traces.
constexpr std::size_t kRaysATask = 512;

/// Traces coherent rays together.
void trace_together(const LevelJob& levels, std::size_t rays, const LevelWay& way,
                    DualCounts* counts) {
  const Executor& executor = *levels.executor;
  RayOrder order;
  order_rays(executor, {levels.rays, rays}, &order, way.row);
  RayStreamPool streams;
  DualScene scene;
  scene.tree = levels.scene->top;
  scene.bundle = *way.bundle;
  StreamJob job{{executor, scene, levels.rays, {}}, order, &streams};
  const std::vector<std::size_t> starts = cut_into_tasks(&job);
  if (!levels.results.go_on) {
    std::fill(levels.results.hits.begin(), levels.results.hits.end(), Hit());
    std::fill(levels.results.occluded.begin(), levels.results.occluded.end(), std::uint8_t{0});
  }
  std::mutex mutex;
  executor.for_each(starts.size() - 1, 1, [&](std::size_t n) {
    const DualCounts found =
        HWY_DYNAMIC_DISPATCH(TraceLevelStreams)(job, levels, {n, starts[n], starts[n + 1]});
    const std::lock_guard lock(mutex);
    if (counts != nullptr) counts->add(found);
  });
}

}  // namespace

void trace_levels(const Executor& executor, const LevelScene& scene, View<const Ray> rays,
                  const HitChoice& choice, const LevelResults& results, DualCounts* counts,
                  const LevelWay& way) {
  const bool together = results.hits.data != nullptr || results.occluded.data != nullptr;
  if (way.bundle && together && scene.times == nullptr && !choice.worlds.are_given() &&
      scene.top != nullptr && !scene.top->empty())
    return trace_together({&executor, &scene, rays.data, choice, results, nullptr}, rays.size, way,
                          counts);
  TimeSlices slices;
  if (scene.times != nullptr && (scene.forest == nullptr || !choice.worlds.are_given()))
    slices = slice_by_time(executor, scene, rays.size, kRaysATask);
  const std::vector<std::uint32_t> order = slices.tops.empty()
                                               ? order_by_world(executor, choice.worlds, rays.size)
                                               : std::move(slices.order);
  std::mutex mutex;
  const auto trace = [&](const LevelScene& levels, std::size_t begin, std::size_t end) {
    const LevelJob job{&executor, &levels, rays.data,
                       choice,    results, order.empty() ? nullptr : order.data()};
    LevelRowList rows;
    const DualCounts own = HWY_DYNAMIC_DISPATCH(TraceLevels)(
        job, results.rows != nullptr ? &rows : nullptr, static_cast<std::uint32_t>(begin),
        static_cast<std::uint32_t>(end));
    const std::lock_guard lock(mutex);
    if (counts != nullptr) counts->add(own);
    if (results.rows != nullptr) results.rows->lists.push_back(std::move(rows));
  };
  if (slices.tops.empty()) {
    executor.for_each_block(rays.size, kRaysATask,
                            [&](std::size_t begin, std::size_t end) { trace(scene, begin, end); });
    return;
  }
  executor.for_each((rays.size + kRaysATask - 1) / kRaysATask, 1, [&](std::size_t task) {
    const std::size_t begin = task * kRaysATask;
    LevelScene of_slice = scene;
    of_slice.top = &slices.tops[begin / slices.rays_each];
    trace(of_slice, begin, std::min(rays.size, begin + kRaysATask));
  });
}

}  // namespace raysheaf
#endif  // HWY_ONCE
