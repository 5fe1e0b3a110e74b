#include "lab/commands/compare/case.h"

#include <algorithm>
#include <ctime>
#include <limits>
#include <map>

#include "apps/support/median.h"
#include "apps/support/timer.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"

namespace raysheaf::app {
namespace {

constexpr std::uint64_t kManyTriangles = 2'000'000;
constexpr std::size_t kManyRays = 1'500'000;

/// The library with the interface of `PeerScene`. It reads the arrays of the caller in place, as
/// the peer does, and neither of them validates the rays.
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

/// One way of querying a `PeerScene`.
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
  double cpu = 0;  ///< of all threads
};

/// Milliseconds of processor time that all threads of this process have used.
double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The way of a peer that was fastest for a kind of rays.
struct Best {
  PeerBuild build;
  PeerCall call;
  double total = std::numeric_limits<double>::infinity();
};

/// One version of the peer.
struct Peer {
  explicit Peer(PeerDevice& its_device) : device(&its_device) {}

  PeerDevice* device;
  std::map<CompareKind, Best> best;
  std::unique_ptr<PeerScene> scene;  ///< in the fastest build
  std::uint32_t build = 0;
};

/// The measurements of one version over all rounds.
struct PeerRounds {
  std::vector<PeerTimes> ms;
  std::vector<double> ratios, cpu_ratios;
  Answers answers;
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
    for (PeerDevice* device : setting.peers) {
      Peer& peer = peers_.emplace_back(*device);
      for (const PeerBuild& build : peer_builds(mode)) try_build(peer, build, kinds);
    }
    ours_.emplace(setting.context);
    ours_->set_meshes(views_[0]);
    if (mode == CompareMode::kStatic) settle(kinds);
  }

  CompareCase measure(CompareKind kind) {
    CompareCase result;
    result.kind = kind;
    result.mode = mode_;
    result.triangles = frames_.triangle_count();
    result.rays = frames_.rays(0, kind).size();
    for (Peer& peer : peers_) make_scene(peer, peer.best.at(kind).build);
    run_rounds(kind, result);
    if (mode_ != CompareMode::kRebuild) result.worst_frame = worst_frame(kind);
    result.peer = *std::max_element(
        result.peers.begin(), result.peers.end(),
        [](const PeerResult& a, const PeerResult& b) { return a.ratio < b.ratio; });
    result.our_bytes = ours_->scene().memory_bytes();
    return result;
  }

 private:
  /// Queries until the plan has built the tree that it keeps for static triangles: the peer's build
  /// of high quality is not timed either.
  void settle(const std::vector<CompareKind>& kinds) {
    constexpr int kMostQueries = 200;
    const auto has_rays = [&](CompareKind kind) { return !frames_.rays(0, kind).empty(); };
    auto kind = std::find_if(kinds.begin(), kinds.end(), [&](CompareKind each) {
      return has_rays(each) && !asks_for_any_hit(each);
    });
    if (kind == kinds.end()) kind = std::find_if(kinds.begin(), kinds.end(), has_rays);
    if (kind == kinds.end()) return;
    Answers answers;
    for (int i = 0; i < kMostQueries; ++i) {
      trace(*ours_, 0, *kind, answers);
      if (short_plan(ours_->statistics().plan).find("built finely") != std::string::npos) return;
    }
  }

  /// The changes from frame to frame, timed.
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
    const double start = cpu_ms();
    result.update = update(side, frame);
    result.trace = trace(side, frame, kind, answers);
    result.total = result.update + result.trace;
    result.cpu = cpu_ms() - start;
    return result;
  }

  /// Times of each way. The shortest one counts, because a disturbance can only lengthen a short
  /// trial.
  [[nodiscard]] int trials(std::size_t rays) const {
    return frames_.triangle_count() > kManyTriangles || rays > kManyRays ? 2 : 5;
  }

  void try_build(Peer& peer, const PeerBuild& build, const std::vector<CompareKind>& kinds) {
    PeerScene scene(*peer.device, build);
    PeerSide any_way{scene, {}};
    scene.set_meshes(views_[0]);
    double build_ms = std::numeric_limits<double>::infinity();
    const int count = trials(0);
    for (int i = 0; i < count; ++i)
      build_ms =
          std::min(build_ms, update(any_way, (static_cast<std::size_t>(i) + 1) % frame_count_));
    const std::size_t frame = static_cast<std::size_t>(count) % frame_count_;
    for (const CompareKind kind : kinds) {
      if (frames_.rays(0, kind).empty()) continue;
      for (const PeerCall& call : peer.device->calls(asks_for_any_hit(kind)))
        try_call(peer, {build, call}, scene, kind, frame, build_ms);
    }
  }

  /// A way whose first trial takes twice as long as the best one is not tried again.
  void try_call(Peer& peer, const Best& way, PeerScene& scene, CompareKind kind, std::size_t frame,
                double build_ms) {
    PeerSide side{scene, way.call};
    Answers answers;
    Best& best = peer.best[kind];
    double trace_ms = std::numeric_limits<double>::infinity();
    const int count = trials(frames_.rays(frame, kind).size());
    for (int i = 0; i < count; ++i) {
      trace_ms = std::min(trace_ms, trace(side, frame, kind, answers));
      if (build_ms + trace_ms > 2 * best.total) break;
    }
    const double total = build_ms + trace_ms;
    if (total >= best.total) return;
    best = way;
    best.total = total;
  }

  static std::string way_name(const Best& way) { return way.build.name + ", " + way.call.name; }

  /// Keeps the scene of only one peer at a time, because the largest scenes fill the memory of a
  /// machine.
  void make_scene(Peer& peer, const PeerBuild& build) {
    if (peer.scene && peer.build == build.index) return;
    peer.scene.reset();
    peer.scene = std::make_unique<PeerScene>(*peer.device, build);
    peer.build = build.index;
    peer.scene->set_meshes(views_[0]);
  }

  /// The side that runs at position `place` of a round: each side begins equally often, and the
  /// sides follow one another in both directions.
  static std::size_t side_at(std::size_t place, std::size_t round, std::size_t sides) {
    const bool backwards = (round / sides) % 2 == 1;
    return (round + (backwards ? sides - place : place)) % sides;
  }

  /// The choices that most rounds used.
  static std::string usual_plan(const std::vector<std::string>& plans) {
    const auto rounds = [&](const std::string& plan) {
      return std::count(plans.begin(), plans.end(), plan);
    };
    return *std::max_element(
        plans.begin(), plans.end(),
        [&](const std::string& a, const std::string& b) { return rounds(a) < rounds(b); });
  }

  /// Every order is combined with both frames equally often. Side 0 is the library.
  void run_rounds(CompareKind kind, CompareCase& result) {
    constexpr std::size_t kWarmUp = 2;
    std::vector<OurTimes> ours;
    std::vector<std::string> plans;
    std::vector<PeerRounds> theirs(peers_.size());
    Answers our_answers;
    result.peers.resize(peers_.size());
    std::size_t frame = 0;
    for (std::size_t i = 0; i < setting_.runs + kWarmUp; ++i) {
      frame = (i + 1) % frame_count_;
      std::vector<Lap> laps(1 + peers_.size());
      for (std::size_t place = 0; place < laps.size(); ++place) {
        const std::size_t side = side_at(place, i / frame_count_, laps.size());
        if (side == 0) {
          laps[0] = lap(*ours_, frame, kind, our_answers);
        } else {
          PeerSide peer{*peers_[side - 1].scene, peers_[side - 1].best.at(kind).call};
          laps[side] = lap(peer, frame, kind, theirs[side - 1].answers);
        }
      }
      for (std::size_t p = 0; p < peers_.size(); ++p)
        check(kind, frame, our_answers, theirs[p].answers, &result.peers[p].hits);
      if (i < kWarmUp) continue;
      const QueryStatistics& s = ours_->statistics();
      plans.push_back(short_plan(s.plan));
      ours.push_back({laps[0].update, s.order_ms, s.hierarchy_ms, s.trace_ms, laps[0].total});
      for (std::size_t p = 0; p < peers_.size(); ++p) {
        const Lap& lap = laps[p + 1];
        theirs[p].ms.push_back({lap.update, lap.trace, lap.total});
        theirs[p].ratios.push_back(laps[0].total / lap.total);
        theirs[p].cpu_ratios.push_back(laps[0].cpu / lap.cpu);
      }
    }
    result.ours_ms = medians(ours);
    result.plan = usual_plan(plans);
    HitCheck sampled;
    sample(kind, frame, our_answers, sampled);
    for (std::size_t p = 0; p < peers_.size(); ++p) {
      PeerResult& peer = result.peers[p];
      peer.version = peers_[p].device->version();
      peer.way = way_name(peers_[p].best.at(kind));
      peer.ms = medians(theirs[p].ms);
      peer.ratio = median(theirs[p].ratios);
      peer.cpu_ratio = median(theirs[p].cpu_ratios);
      peer.bytes = peers_[p].device->memory_bytes();
      peer.hits.sampled = sampled.sampled;
      peer.hits.sample_mismatches = sampled.sample_mismatches;
    }
  }

  /// A tree that the plan builds in one of the frames lengthens that frame.
  double worst_frame(CompareKind kind) {
    constexpr std::size_t kFrames = 60;
    OurScene scene(setting_.context);
    Answers answers;
    scene.set_meshes(views_[0]);
    trace(scene, 0, kind, answers);
    std::vector<double> frames;
    for (std::size_t i = 1; i <= kFrames; ++i)
      frames.push_back(lap(scene, i % frame_count_, kind, answers).cpu);
    const double worst = *std::max_element(frames.begin(), frames.end());
    return worst / std::max(median(std::move(frames)), std::numeric_limits<double>::min());
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

  /// Checks the library's answers to a whole batch against brute force, for rays spread over the
  /// batch.
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
  std::vector<Peer> peers_;
  std::optional<OurScene> ours_;
};

CompareBench::CompareBench(const CompareSetting& setting, const CompareFrames& frames,
                           CompareMode mode, const std::vector<CompareKind>& kinds)
    : impl_(std::make_unique<Impl>(setting, frames, mode, kinds)) {}

CompareBench::~CompareBench() = default;

CompareCase CompareBench::measure(CompareKind kind) {
  return impl_->measure(kind);
}

}  // namespace raysheaf::app
