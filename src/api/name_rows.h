// Turns all hits of rays, by number of the triangle, into rows of named hits.
#pragma once

#include <algorithm>

#include "api/scene/scene_view.h"
#include "raysheaf/query.h"

namespace raysheaf {

/// The lengths of rows, of which `most` hits are kept.
struct MeasureRow {
  std::uint64_t* lengths;
  std::size_t most;

  void operator()(std::size_t ray, View<const IndexedHit> hits) const {
    lengths[ray] = std::min(hits.size, most);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(lengths + ray, 1); }
};

/// Writes the hits of rows, with ids, to the rows' places.
struct NameRow {
  const SceneView& view;
  const std::uint64_t* begins;
  Hit* out;
  std::size_t most;

  void operator()(std::size_t ray, View<const IndexedHit> hits) const {
    view.name_hits({hits.data, std::min(hits.size, most)}, out + begins[ray]);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(out + begins[ray], 1); }
};

/// `found` has a `for_each` like `FoundRows`; `out->offsets` has its length, and is zero.
template <class Rows>
void name_rows(const Executor& executor, const SceneView& view, const Rows& found, std::size_t most,
               HitRows* out) {
  std::uint64_t* const ends = out->offsets.data() + 1;
  found.for_each(executor, MeasureRow{ends, most});
  for (std::size_t i = 2; i < out->offsets.size(); ++i) out->offsets[i] += out->offsets[i - 1];
  out->hits.resize(out->offsets.back());
  found.for_each(executor, NameRow{view, out->offsets.data(), out->hits.data(), most});
}

}  // namespace raysheaf
