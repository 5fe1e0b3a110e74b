// Sorts more items than fit into memory: sorted runs are written to a file and merged in one pass.
#pragma once

#include <algorithm>
#include <type_traits>

#include "io/outer_array.h"

namespace raysheaf::io {

/// Keeps `held` items in memory. `Less` must order any two items strictly.
template <class T, class Less>
class OuterSort {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  OuterSort(const std::string& beside, std::size_t held)
      : file_(beside), held_(std::max<std::size_t>(held, 1)) {}

  void add(const T& item) {
    some_.push_back(item);
    if (some_.size() == held_) end_run();
  }

  /// Calls `body(item)` for each item in ascending order. Call it only once.
  template <class Body>
  void for_each(const Body& body) {
    end_run();
    some_ = {};
    std::vector<Run> runs = begun();
    const auto is_later = [](const Run& a, const Run& b) { return Less{}(b.item(), a.item()); };
    std::make_heap(runs.begin(), runs.end(), is_later);
    while (!runs.empty()) {
      std::pop_heap(runs.begin(), runs.end(), is_later);
      Run& least = runs.back();
      body(least.item());
      if (step(&least))
        std::push_heap(runs.begin(), runs.end(), is_later);
      else
        runs.pop_back();
    }
  }

 private:
  struct Run {
    std::uint64_t next = 0, end = 0;  ///< the part that is still in the file
    std::size_t at = 0;
    std::vector<T> some;
    [[nodiscard]] const T& item() const { return some[at]; }
  };

  void end_run() {
    if (some_.empty()) return;
    std::sort(some_.begin(), some_.end(), Less{});
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(some_.data());
    file_.write(ends_.empty() ? 0 : ends_.back() * sizeof(T), {bytes, some_.size() * sizeof(T)});
    ends_.push_back((ends_.empty() ? 0 : ends_.back()) + some_.size());
    some_.clear();
  }

  [[nodiscard]] std::vector<Run> begun() {
    std::vector<Run> runs;
    runs.reserve(ends_.size());
    for (const std::uint64_t end : ends_) {
      Run& run = runs.emplace_back();
      run.next = runs.size() == 1 ? 0 : ends_[runs.size() - 2];
      run.end = end;
      fill(&run);
    }
    return runs;
  }

  /// Whether there is another item.
  bool step(Run* run) {
    if (++run->at < run->some.size()) return true;
    return fill(run);
  }
  bool fill(Run* run) {
    const std::uint64_t share = std::max<std::size_t>(held_ / ends_.size(), 1);
    run->at = 0;
    run->some.resize(std::min(share, run->end - run->next));
    auto* bytes = reinterpret_cast<std::uint8_t*>(run->some.data());
    file_.read(run->next * sizeof(T), {bytes, run->some.size() * sizeof(T)});
    run->next += run->some.size();
    return !run->some.empty();
  }

  OuterFile file_;
  std::size_t held_;
  std::vector<T> some_;
  std::vector<std::uint64_t> ends_;  // where each run ends
};

}  // namespace raysheaf::io
