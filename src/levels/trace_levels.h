// Rays through a scene of two levels: one by one, interleaved, or coherent ones together.
//
//   ray ─► instances whose boxes it meets, near ones first ─► enters one: the ray in the mesh's
//          space ─► down the mesh's tree ─► where it may hit, corners are placed and tested
//
// A ray enters an instance as one from far away enters a scene (methods/dual/far_ray.h): in
// binary64, with its origin moved to the box of the mesh, and with a pad for what the inverse of
// the transform and the placing round. The answer is that of the flat scene, bit for bit.
#pragma once

#include <optional>
#include <vector>

#include "intersect/hit_filter.h"
#include "levels/level_scene.h"
#include "methods/dual/dual.h"

namespace raysheaf {

/// All hits of the rays of one task.
struct LevelRowList {
  struct Row {
    std::uint32_t ray;
    std::size_t end;  ///< of its hits, which begin where those of the row before end
  };
  std::vector<Row> rows;  ///< in no order
  std::vector<Hit> hits;  ///< those of a row in the order of `is_before`
};

/// All hits of a batch.
struct LevelRows {
  std::vector<LevelRowList> lists;  ///< in no order

  /// Calls `body(ray, hits)` for every ray, in any order and from several threads.
  template <class Body>
  void for_each(const Executor& executor, const Body& body) const {
    executor.for_each(lists.size(), 1, [&](std::size_t number) {
      std::size_t begin = 0;
      for (const LevelRowList::Row& row : lists[number].rows) {
        body(row.ray, View<const Hit>(lists[number].hits.data() + begin, row.end - begin));
        begin = row.end;
      }
    });
  }
};

/// Where the results of a batch go, in the caller's order. Exactly one of the first four is given.
struct LevelResults {
  View<Hit> hits = {};                  ///< the closest
  View<std::uint8_t> occluded = {};     ///< 1: the ray has a hit
  View<std::uint32_t> hit_counts = {};  ///< the number of hits
  LevelRows* rows = nullptr;            ///< all hits
  /// The results are given for other instances, and go on from there. All hits are given here: ray
  /// i's begin at offsets[i] of `begun`, and end at offsets[i + 1].
  bool go_on = false;
  const std::uint64_t* offsets = nullptr;
  const Hit* begun = nullptr;
};

/// How rays go. Answers are the same.
struct LevelWay {
  /// Together, which closest and any hits may without worlds and times; none: one by one.
  std::optional<Bundle> bundle = {};
  std::size_t row = 0;  ///< as in `order_rays`
};

/// The rays must have been validated. Adds to `counts`, which may be null; tests of rays with boxes
/// of instances count as those of other boxes.
void trace_levels(const Executor& executor, const LevelScene& scene, View<const Ray> rays,
                  const HitChoice& choice, const LevelResults& results, DualCounts* counts,
                  const LevelWay& way = {});

/// What trace_levels_simd.cpp works on.
struct LevelJob {
  const Executor* executor;  ///< checked for cancellation
  const LevelScene* scene;
  const Ray* rays;
  HitChoice choice;
  LevelResults results;
  const std::uint32_t* order;  ///< of the rays; null: that in which they are given
};

}  // namespace raysheaf
