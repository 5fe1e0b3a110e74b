// Groups of first hits that several processes follow to their ends, each some of them: nobody makes
// rays or light of another's, and until all is done not a word goes between them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/view.h"
#include "engine/frame_stages.h"
#include "exec/executor.h"
#include "ranks/share.h"
#include "raygen/fragment.h"

namespace raysheaf {

/// Of one frame. All processes call the same functions in the same order.
class SharedGroups {
 public:
  /// `ranks` outlives it. `bounces`: that rays are counted of, at most.
  SharedGroups(Communicator& ranks, std::uint32_t bounces, std::size_t pixels)
      : ranks_(ranks), bounces_(bounces), own_pixels_(pixels, 0) {}

  using Follow = std::function<void(std::size_t group)>;
  /// Calls `follow(group)` for this process's of `count` groups, side by side. The first time,
  /// whoever is free takes the next ones, many at first and few at the end (C. Polychronopoulos,
  /// D. Kuck, "Guided Self-Scheduling", 1987); they stay its own from then on, since the samples of
  /// a pixel are added one after the other. `skip(groups)` hears of others' ones that were passed.
  /// `add_up` must follow.
  void for_each(const Executor& executor, std::size_t count, const Follow& follow,
                const Follow& skip);

  /// This process follows what these pixels see. For several threads at once.
  void note(View<const Fragment> first_hits);

  /// What each process counted becomes what all did; times stay its own.
  void add_up(FrameTally* tally) const;
  /// Of arrays that are zero where another process's are not: everyone's.
  template <class T>
  void unite(std::vector<T>* parts) const {
    raysheaf::unite(ranks_, std::span(*parts));
  }
  /// Every pixel becomes that of who follows it.
  void unite(FilmSums* film) const;

  /// How much of the work was done here, a sentence of a plan.
  [[nodiscard]] std::string sentence() const;

 private:
  /// Takes the next groups, as many as are worth it. False: there are no more after them.
  [[nodiscard]] bool take(std::uint32_t threads, std::size_t count,
                          std::vector<std::size_t>* taken) const;

  Communicator& ranks_;
  const std::uint32_t bounces_;
  std::vector<std::uint8_t> own_pixels_;
  std::vector<std::size_t> own_groups_;
  std::size_t count_ = 0;  ///< of all groups; 0: none was taken yet
};

}  // namespace raysheaf
