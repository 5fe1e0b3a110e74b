// Groups of first hits that several processes follow to their ends, each some of them: nobody makes
// rays or light of another's, and until all is done not a word goes between them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "ranks/share.h"
#include "rays/fragment.h"
#include "render/device/frame_stages.h"

namespace raysheaf {

/// Of one frame. All processes call the same functions in the same order.
class SharedGroups {
 public:
  /// Null where this process is the only one. `ranks` outlives it.
  [[nodiscard]] static std::unique_ptr<SharedGroups> among(Communicator* ranks,
                                                           const RenderOptions& options);

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

  /// Where groups are parts of a picture, runs of pixels, that a device takes one by one: how many
  /// there are.
  [[nodiscard]] std::size_t parts() const;
  /// The pixels [first, second) of a part, which this process follows.
  [[nodiscard]] std::pair<std::size_t, std::size_t> take_pixels(std::size_t part);
  /// Calls `follow(part)`, which adds to the tally, for this process's; the tally takes what all
  /// have counted.
  void follow_parts(std::uint32_t sample, const Follow& follow, FrameTally* tally);

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
  SharedGroups(Communicator& ranks, const RenderOptions& options)
      : ranks_(ranks),
        bounces_(options.bounces + 1),
        own_pixels_(std::size_t{options.width} * options.height, 0) {}

  /// Takes the next groups, as many as are worth it. False: there are no more after them.
  [[nodiscard]] bool take(std::uint32_t threads, std::size_t count,
                          std::vector<std::size_t>* taken) const;

  Communicator& ranks_;
  const std::uint32_t bounces_;  ///< that rays are counted of
  std::vector<std::uint8_t> own_pixels_;
  std::vector<std::size_t> own_groups_;
  std::size_t count_ = 0;  ///< of all groups; 0: none was taken yet
};

}  // namespace raysheaf
