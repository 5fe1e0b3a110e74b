// Puts together the rows of all hits of rays.
#pragma once

#include <algorithm>

#include "exec/executor.h"
#include "raysheaf/query.h"

namespace raysheaf {

/// The lengths of rows, of which `most` hits are kept.
struct MeasureRow {
  std::uint64_t* lengths;
  std::size_t most;

  template <class Hits>
  void operator()(std::size_t ray, const Hits& hits) const {
    lengths[ray] = std::min(hits.size, most);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(lengths + ray, 1); }
};

/// Writes the hits of rows, with ids, to the rows' places.
template <class Name>
struct NameRow {
  const Name& name;
  const std::uint64_t* begins;
  Hit* out;
  std::size_t most;

  template <class Hits>
  void operator()(std::size_t ray, const Hits& hits) const {
    name(hits.slice(0, std::min(hits.size, most)), out + begins[ray]);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(out + begins[ray], 1); }
};

/// `found` has a `for_each` like `FoundRows`, of hits that `name(hits, out)` writes as `Hit`;
/// `rows->offsets` has its length, and is zero.
template <class Rows, class Name>
void name_rows(const Executor& executor, const Rows& found, std::size_t most, const Name& name,
               HitRows* rows) {
  std::uint64_t* const ends = rows->offsets.data() + 1;
  found.for_each(executor, MeasureRow{ends, most});
  for (std::size_t i = 2; i < rows->offsets.size(); ++i) rows->offsets[i] += rows->offsets[i - 1];
  rows->hits.resize(rows->offsets.back());
  found.for_each(executor, NameRow<Name>{name, rows->offsets.data(), rows->hits.data(), most});
}

}  // namespace raysheaf
