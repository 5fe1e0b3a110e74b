#include "render/device/shared_groups.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace raysheaf {
namespace {

/// A process takes 1 / kPartOfShare of its share of the remaining groups.
constexpr std::size_t kPartOfShare = 2;
/// A device is fastest with many rays at once.
constexpr std::size_t kPartsARank = 4;

/// For each batch: whether it exists, its rays, its hits, and its tests.
constexpr std::size_t kTests = 3;
std::size_t place_of(std::uint32_t bounce, RayKind kind) {
  return (bounce * kRayKindCount + static_cast<std::size_t>(kind)) * (kTests + number_count());
}

}  // namespace

std::unique_ptr<SharedGroups> SharedGroups::among(Communicator* ranks,
                                                  const RenderOptions& options) {
  if (ranks == nullptr || ranks->size() == 1) return nullptr;
  return std::unique_ptr<SharedGroups>(new SharedGroups(*ranks, options));
}

bool SharedGroups::take(std::uint32_t threads, std::size_t count,
                        std::vector<std::size_t>* taken) const {
  const std::size_t next = own_groups_.empty() ? 0 : own_groups_.back() + 1;
  const std::size_t share = (count - next) / (kPartOfShare * ranks_.size());
  const std::size_t wanted = std::max<std::size_t>(threads, share);
  taken->clear();
  while (taken->size() < wanted) {
    const auto group = ranks_.take(count);
    if (!group) return false;
    taken->push_back(*group);
  }
  return true;
}

void SharedGroups::for_each(const Executor& executor, std::size_t count, const Follow& follow,
                            const Follow& skip) {
  if (count_ != 0) {
    executor.for_each(own_groups_.size(), 1, [&](std::size_t i) { follow(own_groups_[i]); });
    return skip(count - own_groups_.size());
  }
  std::size_t passed = 0;
  std::vector<std::size_t> taken;
  for (bool more = true; more;) {
    more = take(executor.threads(), count, &taken);
    if (taken.empty()) break;
    own_groups_.insert(own_groups_.end(), taken.begin(), taken.end());
    executor.for_each(taken.size(), 1, [&](std::size_t i) { follow(taken[i]); });
    const std::size_t others = taken.back() + 1 - own_groups_.size();
    skip(others - passed);
    passed = others;
  }
  skip(count - own_groups_.size() - passed);
  count_ = count;
}

void SharedGroups::note(View<const Fragment> first_hits) {
  for (const Fragment& f : first_hits) own_pixels_[f.pixel] = 1;
}

std::size_t SharedGroups::parts() const {
  return std::min<std::size_t>(kPartsARank * ranks_.size(), own_pixels_.size());
}

std::pair<std::size_t, std::size_t> SharedGroups::take_pixels(std::size_t part) {
  const std::size_t pixels = own_pixels_.size();
  const std::size_t begin = pixels * part / parts(), end = pixels * (part + 1) / parts();
  std::fill(own_pixels_.begin() + static_cast<std::ptrdiff_t>(begin),
            own_pixels_.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
  return {begin, end};
}

void SharedGroups::follow_parts(std::uint32_t sample, const Follow& follow, FrameTally* tally) {
  FrameTally before = std::exchange(*tally, tally->fresh());
  for_each(Executor::serial(), parts(), follow, [](std::size_t) {});
  add_up(tally);
  before.take(tally, 1);
  *tally = std::move(before);
  tally->keep_plans(sample * parts());
  if (sample == 0) tally->tell_first(sentence());
}

void SharedGroups::add_up(FrameTally* tally) const {
  std::vector<std::uint64_t> numbers(place_of(bounces_ + 1, RayKind::kPrimary));
  for (const BatchStatistics& batch : tally->statistics.batches) {
    std::uint64_t* const at = &numbers[place_of(batch.bounce, batch.kind)];
    at[0] = 1;
    at[1] = batch.rays;
    at[2] = batch.hits;
    const std::vector<std::uint64_t> tests = numbers_of(batch);
    std::copy(tests.begin(), tests.end(), at + kTests);
  }
  add(ranks_, std::span(numbers));
  for (std::uint32_t bounce = 0; bounce <= bounces_; ++bounce) {
    for (std::size_t kind = 0; kind < kRayKindCount; ++kind) {
      const std::uint64_t* const at = &numbers[place_of(bounce, static_cast<RayKind>(kind))];
      if (at[0] == 0) continue;
      BatchStatistics& batch = tally->batch(static_cast<RayKind>(kind), bounce);
      batch.rays = at[1];
      batch.hits = at[2];
      set_numbers(at + kTests, &batch);
    }
  }
}

void SharedGroups::unite(FilmSums* film) const {
  const auto take_all = [&](auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    if (values.empty()) return;  // nothing is counted
    for (std::size_t i = 0; i < values.size(); ++i)
      if (own_pixels_[i] == 0) std::memset(static_cast<void*>(&values[i]), 0, sizeof(T));
    raysheaf::unite(ranks_, std::span(values));
  };
  RenderResult& sums = film->result;
  take_all(sums.beauty);
  take_all(sums.position);
  take_all(sums.normal);
  take_all(sums.albedo);
  take_all(sums.specular);
  take_all(sums.ids);
  take_all(sums.tests);
  take_all(film->faced);
  take_all(film->arrived);
}

std::string SharedGroups::sentence() const {
  return std::to_string(own_groups_.size()) + " of " + std::to_string(count_) +
         " groups of primary hits were followed here, on rank " + std::to_string(ranks_.rank()) +
         " of " + std::to_string(ranks_.size());
}

}  // namespace raysheaf
