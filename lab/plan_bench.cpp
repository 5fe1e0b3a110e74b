#include "raysheaf/plan_bench.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <utility>

#include "exec/stopwatch.h"
#include "queries/planned_queries.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// The work on the tree when triangles have changed.
enum class TreeHabit : std::uint8_t {
  kPlanned,
  kRebuilt,
  kRebuiltCoarsely,
  kRefitted,
  kRefittedCoarsely,
  kRefittedFinely
};

struct Way {
  std::string name;
  GivenChoices given;
  TreeHabit habit = TreeHabit::kPlanned;
};

/// The meshes of a frame as numbered triangles.
struct Triangles {
  std::vector<TriangleRun> runs;
  std::uint32_t count = 0;

  explicit Triangles(const std::vector<PlanMesh>& meshes) {
    for (const PlanMesh& mesh : meshes) {
      const auto size = static_cast<std::uint32_t>(mesh.triangles.size());
      if (size == 0) continue;
      runs.push_back({mesh.positions.data(), mesh.triangles.data(), count, size});
      count += size;
    }
  }
  [[nodiscard]] TriangleSource source() const {
    return {View<const TriangleRun>(runs), count, nullptr};
  }
};

/// A way with an engine of its own, so that it has a history of its own.
class Side {
 public:
  Side(Way way, PlanMode mode) : way_(std::move(way)), mode_(mode) {}

  [[nodiscard]] const std::string& name() const { return way_.name; }
  [[nodiscard]] const std::vector<std::string>& plan() const { return plan_; }
  [[nodiscard]] bool has_built_finely() const { return has_built_finely_; }
  std::vector<IndexedHit> hits;
  std::vector<std::uint8_t> occluded;
  std::vector<double> ms;

  /// Answers one frame; returns the milliseconds.
  double ask(const Executor& executor, const TriangleSource& triangles, std::span<const Ray> rays,
             bool any) {
    hits.resize(any ? 0 : rays.size());
    occluded.resize(any ? rays.size() : 0);
    QueryReport report;
    const Stopwatch watch;
    const bool changed = mode_ != PlanMode::kStatic || !began_;
    if (changed) engine_.set_triangles(triangles, mode_ == PlanMode::kRefit && began_);
    PlannedOptions options;
    options.given = way_.given;
    if (way_.habit != TreeHabit::kPlanned) options.given.tree = tree_work(changed);
    began_ = true;
    if (any) {
      engine_.any_hit(executor, RaysInPlace({rays.data(), rays.size()}), options, occluded,
                      &report);
    } else {
      const auto take = [this](std::size_t begin, View<const IndexedHit> found) {
        std::copy(found.begin(), found.end(), hits.begin() + static_cast<std::ptrdiff_t>(begin));
      };
      engine_.closest_hit(executor, RaysInPlace({rays.data(), rays.size()}), options, take,
                          &report);
    }
    const double time = watch.ms();
    plan_ = std::move(report.plan);
    has_built_finely_ |= report.tree == TreeWork::kRebuildFinely;
    return time;
  }

 private:
  [[nodiscard]] TreeWork tree_work(bool changed) const {
    const TreeHabit habit = way_.habit;
    if (began_ && !changed) return TreeWork::kKeep;
    if (habit == TreeHabit::kRebuilt) return TreeWork::kRebuild;
    if (habit == TreeHabit::kRebuiltCoarsely) return TreeWork::kRebuildCoarsely;
    if (began_) return TreeWork::kRefit;
    return habit == TreeHabit::kRefittedFinely     ? TreeWork::kRebuildFinely
           : habit == TreeHabit::kRefittedCoarsely ? TreeWork::kRebuildCoarsely
                                                   : TreeWork::kRebuild;
  }

  const Way way_;
  const PlanMode mode_;
  PlannedQueries engine_;
  std::vector<std::string> plan_;
  bool began_ = false, has_built_finely_ = false;
};

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

std::vector<Way> ways_of(PlanMode mode) {
  std::vector<Way> ways{{"plan", {}, TreeHabit::kPlanned}};
  const auto add = [&](const char* name, Bundle bundle, bool tiles) {
    ways.push_back({name, {{}, bundle, tiles, {}}, TreeHabit::kPlanned});
  };
  add("streams, tiles", Bundle::kStream, true);
  add("streams, whole", Bundle::kStream, false);
  add("long streams", Bundle::kLongStream, false);
  const auto add_tree = [&](const char* name, TreeHabit habit) {
    ways.push_back({name, {}, habit});
  };
  if (mode != PlanMode::kStatic) {
    add_tree("tree rebuilt", TreeHabit::kRebuilt);
    add_tree("coarse tree rebuilt", TreeHabit::kRebuiltCoarsely);
  }
  if (mode == PlanMode::kRefit) add_tree("tree refitted", TreeHabit::kRefitted);
  if (mode == PlanMode::kRefit) add_tree("coarse tree refitted", TreeHabit::kRefittedCoarsely);
  if (mode == PlanMode::kRefit) add_tree("fine tree refitted", TreeHabit::kRefittedFinely);
  if (mode == PlanMode::kStatic) add_tree("tree kept", TreeHabit::kRefitted);
  if (mode == PlanMode::kStatic) add_tree("fine tree kept", TreeHabit::kRefittedFinely);
  return ways;
}

bool same_answers(const Side& a, const Side& b) {
  return a.occluded == b.occluded &&
         std::equal(a.hits.begin(), a.hits.end(), b.hits.begin(), b.hits.end(),
                    [](const IndexedHit& x, const IndexedHit& y) {
                      return std::memcmp(&x, &y, sizeof x) == 0;
                    });
}

}  // namespace

const PlanWay& PlanTrial::best() const {
  return *std::max_element(ways.begin(), ways.end(),
                           [](const PlanWay& a, const PlanWay& b) { return a.loss < b.loss; });
}

PlanTrial try_plans(std::span<const PlanFrame> frames, PlanMode mode, bool any,
                    std::uint32_t threads, std::uint32_t runs) {
  // The plan learns from the first queries whether triangles keep moving; static triangles get
  // their last tree.
  constexpr std::size_t kWarmUp = 12, kLongestWarmUp = 200;
  if (frames.empty() || frames.front().rays.empty())
    throw Error(ErrorCode::kInvalidArgument, "there is no frame, or it has no rays", "frames");
  if (runs == 0) throw Error(ErrorCode::kInvalidArgument, "must be at least 1", "runs");
  if (mode == PlanMode::kStatic) frames = frames.first(1);
  const Executor executor(threads);
  std::vector<Triangles> triangles;
  for (const PlanFrame& frame : frames) triangles.emplace_back(frame.meshes);
  std::vector<std::unique_ptr<Side>> sides;
  for (Way& way : ways_of(mode)) sides.push_back(std::make_unique<Side>(std::move(way), mode));
  std::vector<Side*> order;
  for (const auto& side : sides) order.push_back(side.get());
  std::mt19937 random(1);  // NOLINT: the same orders in every run
  std::size_t warm_up = kWarmUp;
  for (std::size_t round = 0; round < runs + warm_up; ++round) {
    const std::size_t frame = round % frames.size();
    // In any order, so that none always follows the same other one.
    std::shuffle(order.begin(), order.end(), random);
    for (Side* const each : order) {
      Side& side = *each;
      const double ms = side.ask(executor, triangles[frame].source(), frames[frame].rays, any);
      if (round >= warm_up) side.ms.push_back(ms);
    }
    const bool waits = mode == PlanMode::kStatic && !sides.front()->has_built_finely();
    if (round + 1 == warm_up && warm_up < kLongestWarmUp && waits) ++warm_up;
    for (const auto& side : sides)
      if (!same_answers(*side, *sides.front()))
        throw Error(ErrorCode::kInternal, "the answers of '" + side->name() + "' differ", "plan");
  }
  const Side& planned = *sides.front();
  PlanTrial trial{planned.plan(), median_of(planned.ms), {}};
  for (std::size_t i = 1; i < sides.size(); ++i) {
    std::vector<double> losses;
    for (std::size_t r = 0; r < runs; ++r) losses.push_back(planned.ms[r] / sides[i]->ms[r]);
    trial.ways.push_back({sides[i]->name(), median_of(sides[i]->ms), median_of(losses)});
  }
  return trial;
}

}  // namespace raysheaf
