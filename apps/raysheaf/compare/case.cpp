#include "compare/case.h"

#include <algorithm>
#include <limits>
#include <map>

#include "median.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "timer.h"

namespace raysheaf::app {
namespace {

constexpr std::uint64_t kManyTriangles = 2'000'000;

/// The library with the verbs of `PeerScene`. It reads the caller's arrays where they lie, as the
/// peer does, and neither looks the rays over.
class OurScene {
 public:
  explicit OurScene(const Context& context) : scene_(context) {}

  void set_meshes(std::span<const MeshView> meshes) {
    MeshOptions shared;
    shared.storage = Storage::kShare;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (i < ids_.size())
        scene_.replace(ids_[i], meshes[i].positions, meshes[i].triangles);
      else
        ids_.push_back(scene_.add(meshes[i].positions, meshes[i].triangles, shared));
    }
    scene_.commit();
  }

  void move_meshes(std::span<const MeshView> meshes) {
    for (std::size_t i = 0; i < meshes.size(); ++i) scene_.update(ids_[i], meshes[i].positions);
    scene_.commit();
  }

  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits) {
    raysheaf::closest_hit(scene_, rays, hits, options());
  }

  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded) {
    raysheaf::any_hit(scene_, rays, occluded, options());
  }

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const QueryStatistics& statistics() const { return statistics_; }

 private:
  QueryOptions options() {
    QueryOptions options;
    options.check = false;
    options.statistics = &statistics_;
    return options;
  }

  Scene scene_;
  std::vector<MeshId> ids_;
  QueryStatistics statistics_;
};

/// `PeerScene` asked in one way.
struct PeerSide {
  PeerScene& scene;
  PeerCall call;

  void set_meshes(std::span<const MeshView> meshes) { scene.set_meshes(meshes); }
  void move_meshes(std::span<const MeshView> meshes) { scene.move_meshes(meshes); }
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits) {
    scene.closest_hit(rays, hits, call);
  }
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded) {
    scene.any_hit(rays, occluded, call);
  }
};

struct Answers {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> occluded;
};

struct Lap {
  double update = 0, trace = 0, total = 0;
};

/// The way of the peer that was the fastest for a kind of rays.
struct Best {
  PeerBuild build;
  PeerCall call;
  double total = std::numeric_limits<double>::infinity();
  std::vector<PeerTrial> trials;
};

}  // namespace

class CompareBench::Impl {
 public:
  Impl(const CompareSetting& setting, const CompareFrames& frames, CompareMode mode,
       const std::vector<CompareKind>& kinds)
      : setting_(setting),
        frames_(frames),
        mode_(mode),
        frame_count_(mode == CompareMode::kStatic ? 1 : frames.frame_count()) {
    for (std::size_t i = 0; i < frame_count_; ++i)
      views_.push_back(frames.meshes(i, mode == CompareMode::kRefit));
    for (const PeerBuild& build : peer_builds(mode)) try_build(build, kinds);
    ours_.emplace(setting.context);
    ours_->set_meshes(views_[0]);
  }

  CompareCase measure(CompareKind kind) {
    const Best& best = best_.at(kind);
    PeerSide peer{peer_scene(best.build), best.call};
    CompareCase result;
    result.kind = kind;
    result.mode = mode_;
    result.triangles = frames_.triangle_count();
    result.rays = frames_.rays(0, kind).size();
    result.threads = setting_.context.threads();
    result.peer = "embree " + best.build.name + ", " + best.call.name;
    result.trials = best.trials;
    run_pairs(kind, peer, result);
    result.plan = ours_->statistics().plan;
    result.our_bytes = ours_->scene().memory_bytes();
    result.peer_bytes = setting_.peer->memory_bytes();
    return result;
  }

 private:
  /// What changes from frame to frame, timed.
  template <class Side>
  double update(Side& side, std::size_t frame) {
    Timer clock;
    if (mode_ == CompareMode::kRebuild) side.set_meshes(views_[frame]);
    if (mode_ == CompareMode::kRefit) side.move_meshes(views_[frame]);
    return clock.lap_ms();
  }

  template <class Side>
  double trace(Side& side, std::size_t frame, CompareKind kind, Answers& answers) {
    const std::vector<Ray>& rays = frames_.rays(frame, kind);
    answers.hits.resize(asks_for_any_hit(kind) ? 0 : rays.size());
    answers.occluded.resize(asks_for_any_hit(kind) ? rays.size() : 0);
    Timer clock;
    if (asks_for_any_hit(kind))
      side.any_hit(rays, answers.occluded);
    else
      side.closest_hit(rays, answers.hits);
    return clock.lap_ms();
  }

  template <class Side>
  Lap lap(Side& side, std::size_t frame, CompareKind kind, Answers& answers) {
    Lap result;
    result.update = update(side, frame);
    result.trace = trace(side, frame, kind, answers);
    result.total = result.update + result.trace;
    return result;
  }

  /// Of each way. The least time counts: what disturbs a short trial only ever adds to it.
  [[nodiscard]] int trials() const { return frames_.triangle_count() > kManyTriangles ? 2 : 5; }

  void try_build(const PeerBuild& build, const std::vector<CompareKind>& kinds) {
    PeerScene scene(*setting_.peer, build);
    PeerSide any_way{scene, {}};
    scene.set_meshes(views_[0]);
    double build_ms = std::numeric_limits<double>::infinity();
    for (int i = 0; i < trials(); ++i)
      build_ms =
          std::min(build_ms, update(any_way, (static_cast<std::size_t>(i) + 1) % frame_count_));
    const std::size_t frame = static_cast<std::size_t>(trials()) % frame_count_;
    for (const CompareKind kind : kinds) {
      if (frames_.rays(0, kind).empty()) continue;
      for (const PeerCall& call : peer_calls(asks_for_any_hit(kind)))
        try_call(build, call, scene, kind, frame, build_ms);
    }
  }

  void try_call(const PeerBuild& build, const PeerCall& call, PeerScene& scene, CompareKind kind,
                std::size_t frame, double build_ms) {
    PeerSide side{scene, call};
    Answers answers;
    double trace_ms = std::numeric_limits<double>::infinity();
    for (int i = 0; i < trials(); ++i)
      trace_ms = std::min(trace_ms, trace(side, frame, kind, answers));
    const double total = build_ms + trace_ms;
    Best& best = best_[kind];
    best.trials.push_back({build.name + ", " + call.name, {build_ms, trace_ms, total}});
    if (total >= best.total) return;
    best.build = build;
    best.call = call;
    best.total = total;
  }

  /// The peer's scene in a build that has won; one at a time, for the largest ones fill a machine.
  PeerScene& peer_scene(const PeerBuild& build) {
    if (peer_ && peer_build_ == build.index) return *peer_;
    peer_.reset();
    peer_ = std::make_unique<PeerScene>(*setting_.peer, build);
    peer_build_ = build.index;
    peer_->set_meshes(views_[0]);
    return *peer_;
  }

  /// Both orders and both frames come equally often, in all four combinations.
  void run_pairs(CompareKind kind, PeerSide& peer, CompareCase& result) {
    std::vector<OurTimes> ours;
    std::vector<PeerTimes> theirs;
    std::vector<double> ratios;
    constexpr std::size_t kWarmUp = 2;
    Answers our_answers, their_answers;
    std::size_t frame = 0;
    for (std::size_t i = 0; i < setting_.runs + kWarmUp; ++i) {
      frame = (i + 1) % frame_count_;
      Lap our_lap, their_lap;
      const bool we_begin = (i / frame_count_) % 2 == 0;
      if (we_begin) our_lap = lap(*ours_, frame, kind, our_answers);
      their_lap = lap(peer, frame, kind, their_answers);
      if (!we_begin) our_lap = lap(*ours_, frame, kind, our_answers);
      check(kind, frame, our_answers, their_answers, &result.hits);
      if (i < kWarmUp) continue;
      const QueryStatistics& s = ours_->statistics();
      ours.push_back({our_lap.update, s.order_ms, s.hierarchy_ms, s.trace_ms, our_lap.total});
      theirs.push_back({their_lap.update, their_lap.trace, their_lap.total});
      ratios.push_back(our_lap.total / their_lap.total);
    }
    sample(kind, frame, our_answers, result.hits);
    result.ours_ms = medians(ours);
    result.peer_ms = medians(theirs);
    result.ratio = median(ratios);
  }

  template <class Times>
  static double median_of(const std::vector<Times>& all, double Times::*field) {
    std::vector<double> values;
    for (const Times& times : all) values.push_back(times.*field);
    return median(std::move(values));
  }

  static OurTimes medians(const std::vector<OurTimes>& all) {
    return {median_of(all, &OurTimes::update), median_of(all, &OurTimes::order),
            median_of(all, &OurTimes::hierarchy), median_of(all, &OurTimes::trace),
            median_of(all, &OurTimes::total)};
  }

  static PeerTimes medians(const std::vector<PeerTimes>& all) {
    return {median_of(all, &PeerTimes::build), median_of(all, &PeerTimes::trace),
            median_of(all, &PeerTimes::total)};
  }

  /// Keeps the worst check of all frames.
  void check(CompareKind kind, std::size_t frame, const Answers& ours, const Answers& theirs,
             HitCheck* worst) const {
    const std::vector<Ray>& rays = frames_.rays(frame, kind);
    const float slack = 0x1p-20f * frames_.diagonal();
    const bool any = asks_for_any_hit(kind);
    HitCheck found = any ? compare_flags(ours.occluded, theirs.occluded)
                         : compare_hits(rays, ours.hits, theirs.hits, slack);
    if (worst->compared != 0 && found.mismatches <= worst->mismatches) return;
    if (any)
      settle_flags(views_[frame], rays, ours.occluded, theirs.occluded, &found);
    else
      settle_hits(views_[frame], rays, ours.hits, theirs.hits, slack, &found);
    *worst = std::move(found);
  }

  /// Our answers to a whole batch against brute force, on rays spread over it.
  void sample(CompareKind kind, std::size_t frame, const Answers& ours, HitCheck& hits) const {
    const std::vector<Ray>& all = frames_.rays(frame, kind);
    const std::size_t count =
        std::min<std::size_t>(all.size(), frames_.triangle_count() > kManyTriangles ? 64 : 256);
    const auto place = [&](std::size_t i) { return i * all.size() / count; };
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) rays.push_back(all[place(i)]);
    QueryOptions brute;
    brute.method = QueryMethod::kBrute;
    hits.sampled = count;
    if (asks_for_any_hit(kind)) {
      const auto expected = raysheaf::any_hit(ours_->scene(), rays, brute);
      for (std::size_t i = 0; i < count; ++i)
        hits.sample_mismatches += ours.occluded[place(i)] == expected[i] ? 0 : 1;
    } else {
      const auto expected = raysheaf::closest_hit(ours_->scene(), rays, brute);
      for (std::size_t i = 0; i < count; ++i)
        hits.sample_mismatches += same_bits(ours.hits[place(i)], expected[i]) ? 0 : 1;
    }
  }

  static bool same_bits(const Hit& a, const Hit& b) {
    return a.t == b.t && a.u == b.u && a.v == b.v && a.prim_id == b.prim_id &&
           a.geom_id == b.geom_id && a.inst_id == b.inst_id;
  }

  const CompareSetting& setting_;
  const CompareFrames& frames_;
  const CompareMode mode_;
  const std::size_t frame_count_;
  std::vector<std::vector<MeshView>> views_;
  std::map<CompareKind, Best> best_;
  std::optional<OurScene> ours_;
  std::unique_ptr<PeerScene> peer_;
  std::uint32_t peer_build_ = 0;
};

CompareBench::CompareBench(const CompareSetting& setting, const CompareFrames& frames,
                           CompareMode mode, const std::vector<CompareKind>& kinds)
    : impl_(std::make_unique<Impl>(setting, frames, mode, kinds)) {}

CompareBench::~CompareBench() = default;

CompareCase CompareBench::measure(CompareKind kind) {
  return impl_->measure(kind);
}

}  // namespace raysheaf::app
