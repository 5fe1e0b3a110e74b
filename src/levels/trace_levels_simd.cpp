// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is fused
// in what reaches an answer.
#include <algorithm>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include <hwy/cache_control.h>

#include "base/float.h"
#include "intersect/facing_body.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "levels/trace_levels.h"
#include "methods/dual/ray_stream.h"
#include "methods/dual/trace_job.h"

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

namespace {

/// A ray within a box, as tests with the boxes of a tree need it, and its way back to t.
struct EnteredRay {
  StreamRay record;
  QuarterAxes axes;

  /// Returns whether the ray meets the box.
  bool enter(const LongRay& ray, float t_min, float t_max, const Box& box) {
    const auto size = [&](int axis) { return std::fabs(ray.direction[axis]); };
    const auto against = [&](int axis) { return std::signbit(ray.direction[axis]) ? 1u : 0u; };
    const int widest = size(0) > size(1) ? 0 : 1, z = size(widest) > size(2) ? widest : 2;
    const int x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    const double along = size(z);
    const FarRay far = move_origin(ray, t_min, t_max, along, box);
    if (!(far.s_far >= 0)) return false;
    axes = QuarterAxes(static_cast<std::uint32_t>(8 * z) + 4 * against(z) + 2 * against(x) +
                       against(y));
    const Vec3 o = axes.along_axes(far.origin);
    const auto shear = [&](int axis) {
      return static_cast<float>(ray.direction[axis] / ray.direction[z]);
    };
    StreamRay& r = record;
    r.ox = o.x, r.oy = o.y, r.oz = o.z, r.t_limit = t_max;
    r.shear_x = shear(axes.axis_x), r.shear_y = shear(axes.axis_y);
    r.shear_z = static_cast<float>(1 / ray.direction[z]), r.t_min = far.pad;
    r.per_x = inverse_slope(axes.mirrored ? -r.shear_x : r.shear_x);
    r.per_y = inverse_slope(axes.mirrored ? -r.shear_y : r.shear_y);
    r.s_near = 0, r.s_far = far.s_far, r.start = far.start;
    r.along = rounded_up(along);
    return true;
  }
  [[nodiscard]] SingleSlabs slabs(const Box& box) const {
    Growth growth(box);
    growth.include(record.along);
    return {record, axes, growth, record.t_min};
  }
  /// Leaves out what is farther than a hit at t.
  void shorten(float t) {
    record.s_far = std::min(record.s_far, raysheaf::past(t, record.along) - record.start);
  }
};

/// An instance whose box a ray meets, from `near` on.
struct Entry {
  float near;
  std::uint32_t instance;
};

/// Finds the instances whose boxes a ray meets.
class InstanceFinder {
 public:
  explicit InstanceFinder(const LevelScene& scene)
      : instances_(scene.instances.data), top_(*scene.top) {}

  /// Replaces `found`, near ones first, by instances that have a bit of `mask`.
  void find(const Ray& ray, std::uint32_t mask, EnteredRay* world, std::vector<Entry>* found,
            DualCounts* counts) {
    found->clear();
    if (!world->enter(long_ray(ray, top_.bounds), ray.t_min, ray.t_max, top_.bounds)) return;
    walks_.ray[0] = &world->record;
    walks_.slabs[0] = world->slabs(top_.bounds);
    walks_.start(0, 0, 0);
    for (;;) {
      counts->ray_box_tests += open_for_ray<false>(top_, world->axes, &walks_, 0);
      std::uint32_t kept = 0;  // leaves leave the stack
      for (std::uint32_t k = 0; k < walks_.top[0]; ++k) {
        if (walks_.counts(0)[k] != 0) {
          const std::uint32_t instance = walks_.firsts(0)[k];
          if ((instances_[instance].mask & mask) != 0)
            found->push_back({walks_.nears(0)[k], instance});
        } else {
          walks_.nears(0)[kept] = walks_.nears(0)[k];
          walks_.firsts(0)[kept] = walks_.firsts(0)[k];
          walks_.counts(0)[kept++] = 0;
        }
      }
      walks_.top[0] = kept;
      if (kept == 0) break;
      walks_.pop(0);
    }
    std::sort(found->begin(), found->end(), [](const Entry& a, const Entry& b) {
      return a.near < b.near || (a.near == b.near && a.instance < b.instance);
    });
  }

 private:
  const LevelInstance* instances_;
  const ObjectTree& top_;
  SingleWalks walks_;
};

template <class Mode>
class LevelWalk {
 public:
  /// `rows`: for all hits, if they are not only counted.
  LevelWalk(const LevelJob& job, LevelRowList* rows)
      : job_(job), rows_(rows), finder_(*job.scene) {}

  /// Traces rays [begin, end).
  void run(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t next = begin;
    walk_singles<!Mode::kAll>(
        *this, &walks_, SingleWalks::kMost,
        [&](std::uint32_t i) {
          Slot& slot = slots_[i];
          for (;;) {
            while (slot.next < slot.entries.size()) {
              const Entry entry = slot.entries[slot.next++];
              if (entry.near > slot.world.record.s_far)
                slot.next = slot.entries.size();
              else if (enter(i, entry.instance))
                return true;
            }
            finish(&slot);
            if (next == end) return false;
            begin_ray(&slot, next++);
          }
        },
        [](std::uint32_t, std::uint32_t, Interval, bool) {},
        [&](std::uint32_t i, std::uint32_t place) { settle(i, place); }, &counts_);
  }
  [[nodiscard]] const DualCounts& counts() const { return counts_; }

  // For `walk_singles`.
  [[nodiscard]] HWY_INLINE const ObjectTree& tree(std::uint32_t i) const {
    return *slots_[i].instance->tree;
  }
  [[nodiscard]] HWY_INLINE const QuarterAxes& axes(std::uint32_t i) const {
    return slots_[i].entered.axes;
  }
  [[nodiscard]] HWY_INLINE Subtrees subtrees(std::uint32_t i) const { return Subtrees(tree(i)); }
  [[nodiscard]] static HWY_INLINE bool are_far() { return true; }

 private:
  struct Slot {
    std::uint32_t number = kInvalidId;  ///< of the ray; kInvalidId: none
    const LevelInstance* instance = nullptr;
    EnteredRay world, entered;
    std::vector<Entry> entries;
    std::size_t next = 0;     ///< of the entries
    float limit = 0;          ///< the t of the best hit, or t_max
    Hit best;                 ///< for any hit: one
    std::uint32_t found = 0;  ///< hits
    std::vector<Hit> row;     ///< of them
  };

  void begin_ray(Slot* slot, std::uint32_t number) {
    job_.executor->check();
    const Ray& ray = job_.rays[number];
    slot->number = number;
    slot->best = Hit();
    slot->limit = ray.t_max;
    slot->found = 0;
    slot->next = 0;
    slot->row.clear();
    finder_.find(ray, job_.choice.mask_of(number), &slot->world, &slot->entries, &counts_);
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

  bool enter(std::uint32_t i, std::uint32_t number) {
    Slot& slot = slots_[i];
    const LevelInstance& instance = job_.scene->instances[number];
    const Ray& ray = job_.rays[slot.number];
    const Box& box = instance.tree->bounds;
    if (!slot.entered.enter(in_mesh(instance.placing, ray), ray.t_min, slot.limit, box))
      return false;
    slot.instance = &instance;
    walks_.ray[i] = &slot.entered.record;
    walks_.slabs[i] = slot.entered.slabs(box);
    walks_.start(i, 0, 0);
    return true;
  }

  /// Tests a ray with the triangle at a place in its instance.
  HWY_NOINLINE void settle(std::uint32_t i, std::uint32_t place) {
    Slot& slot = slots_[i];
    const LevelInstance& instance = *slot.instance;
    const Ray& ray = job_.rays[slot.number];
    PlacedCorners p(*instance.tree, place);
    if (!instance.placing.is_identity) {
      const auto placed = [&](Vec3 corner) {
        return transform_point(instance.placing.map, corner);
      };
      p.a = placed(p.a), p.b = placed(p.b), p.c = placed(p.c);
    }
    TriangleHit hit;
    if (!intersect_triangle(make_ray_setup(ray), p.a, p.b, p.c, &hit) || hit.t > slot.limit) return;
    const std::uint32_t prim = id_at(*instance.tree, place);
    const Hit one{hit.t, hit.u, hit.v, prim, instance.geom_id, instance.inst_id};
    if (!Mode::kAll && is_before(slot.best, one)) return;
    if (!job_.choice.takes(slot.number, {instance.inst_id, prim}, instance.mirrored, hit.front))
      return;
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
  InstanceFinder finder_;
  SingleWalks walks_;
  Slot slots_[SingleWalks::kMost];
  DualCounts counts_;
};

template <class Mode>
DualCounts trace_some(const LevelJob& job, LevelRowList* rows, std::uint32_t begin,
                      std::uint32_t end) {
  LevelWalk<Mode> walk(job, rows);
  walk.run(begin, end);
  return walk.counts();
}

}  // namespace

DualCounts TraceLevels(const LevelJob& job, LevelRowList* rows, std::uint32_t begin,
                       std::uint32_t end) {
  if (job.results.hits.data != nullptr) return trace_some<ClosestMode>(job, rows, begin, end);
  if (job.results.occluded.data != nullptr) return trace_some<AnyMode>(job, rows, begin, end);
  return trace_some<AllMode>(job, rows, begin, end);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {
namespace {

HWY_EXPORT(TraceLevels);

/// Rays that one task traces.
constexpr std::size_t kRaysATask = 512;

}  // namespace

void trace_levels(const Executor& executor, const LevelScene& scene, View<const Ray> rays,
                  const HitChoice& choice, const LevelResults& results, DualCounts* counts) {
  const LevelJob job{&executor, &scene, rays.data, choice, results};
  std::mutex mutex;
  executor.for_each_block(rays.size, kRaysATask, [&](std::size_t begin, std::size_t end) {
    LevelRowList rows;
    const DualCounts own = HWY_DYNAMIC_DISPATCH(TraceLevels)(
        job, results.rows != nullptr ? &rows : nullptr, static_cast<std::uint32_t>(begin),
        static_cast<std::uint32_t>(end));
    const std::lock_guard lock(mutex);
    if (counts != nullptr) counts->add(own);
    if (results.rows != nullptr) results.rows->lists.push_back(std::move(rows));
  });
}

}  // namespace raysheaf
#endif  // HWY_ONCE
