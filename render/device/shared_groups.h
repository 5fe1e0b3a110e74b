// Groups of primary hits that several processes share: each process follows some of them to their
// ends. No process computes rays or light of another's groups, and the processes do not communicate
// until all are done.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "ranks/share.h"
#include "render/device/frame_stages.h"
#include "render/rays/fragment.h"

namespace raysheaf {

/// For one frame. All processes call the same functions in the same order.
class SharedGroups {
 public:
  /// Null if this process is the only one. `ranks` must outlive it.
  [[nodiscard]] static std::unique_ptr<SharedGroups> among(Communicator* ranks,
                                                           const RenderOptions& options);

  using Follow = std::function<void(std::size_t group)>;
  /// Calls `follow(group)` in parallel for this process's share of `count` groups. In the first
  /// sample, the next idle process takes the next groups, many at first and few at the end (C.
  /// Polychronopoulos, D. Kuck, "Guided Self-Scheduling", 1987). A process keeps its groups in
  /// later samples, because the samples of a pixel are added in order. `skip(groups)` is called
  /// with the number of other processes' groups that were passed. Call `add_up` afterwards.
  void for_each(const Executor& executor, std::size_t count, const Follow& follow,
                const Follow& skip);

  /// Records that this process follows these pixels. Thread-safe.
  void note(View<const Fragment> first_hits);

  /// For devices, whose groups are parts of an image (runs of pixels) processed one by one: the
  /// number of parts.
  [[nodiscard]] std::size_t parts() const;
  /// The pixels [first, second) of a part, which this process will follow.
  [[nodiscard]] std::pair<std::size_t, std::size_t> take_pixels(std::size_t part);
  /// Calls `follow(part)`, which adds to the tally, for this process's parts; the tally receives
  /// the counts of all processes.
  void follow_parts(std::uint32_t sample, const Follow& follow, FrameTally* tally);

  /// Replaces each process's counts by the sum over all processes; times stay its own.
  void add_up(FrameTally* tally) const;
  /// Combines arrays of which each process has a part and zeros elsewhere.
  template <class T>
  void unite(std::vector<T>* parts) const {
    raysheaf::unite(ranks_, std::span(*parts));
  }
  /// Replaces every pixel by that of the process that followed it.
  void unite(FilmSums* film) const;

  /// A sentence of a plan that states this process's share of the work.
  [[nodiscard]] std::string sentence() const;

 private:
  SharedGroups(Communicator& ranks, const RenderOptions& options)
      : ranks_(ranks),
        bounces_(options.bounces + 1),
        own_pixels_(std::size_t{options.width} * options.height, 0) {}

  /// Takes the next groups, as many as are efficient. Returns false if none are left after them.
  [[nodiscard]] bool take(std::uint32_t threads, std::size_t count,
                          std::vector<std::size_t>* taken) const;

  Communicator& ranks_;
  const std::uint32_t bounces_;  ///< number of bounces for which rays are counted
  std::vector<std::uint8_t> own_pixels_;
  std::vector<std::size_t> own_groups_;
  std::size_t count_ = 0;  ///< of all groups; 0: none was taken yet
};

}  // namespace raysheaf
