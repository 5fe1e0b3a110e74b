// Some of many rays, points or answers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "lab/verify/random.h"
#include "raysheaf/query.h"

namespace raysheaf::checks {

/// So many of `count`, ascending.
inline std::vector<std::uint32_t> some_of(std::size_t count, std::size_t wanted, Random* random) {
  std::vector<std::uint32_t> chosen;
  if (count <= wanted) {
    chosen.resize(count);
    std::iota(chosen.begin(), chosen.end(), 0u);
    return chosen;
  }
  for (std::size_t i = 0; i < wanted; ++i)
    chosen.push_back(random->below(static_cast<std::uint32_t>(count)));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

template <class T>
std::vector<T> pick(std::span<const T> all, std::span<const std::uint32_t> chosen) {
  std::vector<T> picked;
  if (all.empty()) return picked;
  for (const std::uint32_t i : chosen) picked.push_back(all[i]);
  return picked;
}
template <class T>
std::vector<T> pick(const std::vector<T>& all, std::span<const std::uint32_t> chosen) {
  return pick(std::span<const T>(all), chosen);
}

inline HitRows pick(const HitRows& all, std::span<const std::uint32_t> chosen) {
  HitRows picked;
  picked.offsets.push_back(0);
  for (const std::uint32_t i : chosen) {
    for (const Hit& hit : all[i]) picked.hits.push_back(hit);
    picked.offsets.push_back(picked.hits.size());
  }
  return picked;
}

}  // namespace raysheaf::checks
