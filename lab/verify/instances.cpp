// Checks queries of instances in worlds and in time by exact arithmetic on the corners where the
// transforms of the ray's time place them.
#include <optional>
#include <string>
#include <vector>

#include "lab/verify/compare.h"
#include "lab/verify/fault.h"
#include "lab/verify/placed_pairs.h"
#include "lab/verify/simd_target.h"
#include "raysheaf/level_choice.h"

namespace raysheaf::checks {
namespace {

constexpr std::size_t kPairs = 1000;

/// Each pair is in a world of its own, so that its ray meets only its triangle.
class PairsInWorlds {
 public:
  PairsInWorlds(const Context& context, bool moves, Random* random) : scene_(context) {
    for (WorldId world = 0; world < kPairs; ++world) {
      const PlacedPair& pair = pairs_.emplace_back(make_placed_pair(moves, random));
      const MeshId mesh = scene_.add_soup(pair.mesh, {.place = false});
      const InstanceId one = scene_.instance(mesh, Affine(), 0xffffffff, world);
      scene_.set_transforms({&one, 1}, pair.transforms, pair.transforms.size());
      rays_.push_back(pair.seen.ray);
      if (moves) times_.push_back(pair.time);
      exact_.push_back(exact_answer(pair.seen.ray, pair.seen.corners[0], pair.seen.corners[1],
                                    pair.seen.corners[2]));
    }
    scene_.commit();
  }

  void ask(const Subject& subject, QueryMethod method, const std::string& how, Tally* tally) const {
    QueryOptions options;
    options.method = method;
    options.rays_per_world = 1;
    options.ray_times = times_;
    const std::vector<Hit> hits = subject.closest_hit(scene_, rays_, options);
    const std::vector<std::uint8_t> any = subject.any_hit(scene_, rays_, options);
    const std::vector<HitPoint> points = subject.hit_points(scene_, rays_, hits, times_);
    for (std::size_t i = 0; i < kPairs; ++i) {
      const PlacedPair& pair = pairs_[i];
      const Hit& hit = hits[i];
      const bool met = hit.prim_id != kInvalidId;
      const TriangleHit found{hit.t, hit.u, hit.v, met && points[i].front != pair.mirrored};
      std::string fault = fault_of(pair.seen.ray, pair.seen.corners, exact_[i], met, found);
      if (fault.empty() && met && (hit.prim_id != 0 || hit.inst_id != i || hit.geom_id != i))
        fault = "the hit is said to be on " + text_of(hit) + ", which is in another world";
      if (fault.empty() && (any[i] != 0) != met)
        fault = "any_hit and closest_hit differ: " + text_of(pair.seen.ray, pair.seen.corners);
      if (fault.empty()) continue;
      std::string where = how + ", a triangle of '" + pair.family + "' under ";
      where += std::to_string(pair.transforms.size());
      where += " transforms at time ";
      where += text_of(pair.time);
      where += ": ";
      where += fault;
      tally->fail(where);
    }
    tally->tried(2 * kPairs);
  }

  void enter(std::optional<bool> choice) const { choose_levels(scene_, choice); }

 private:
  Scene scene_;
  std::vector<PlacedPair> pairs_;
  std::vector<Ray> rays_;
  std::vector<float> times_;  ///< empty if nothing moves
  std::vector<ExactAnswer> exact_;
};

}  // namespace

void check_instances(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  const bool moves = !random.one_in(4);
  const PairsInWorlds pairs(subject.most().context, moves, &random);
  for (const std::int64_t target : subject.targets) {
    const OnSimdTarget on(target);
    for (const bool enters : {true, false}) {
      if (moves && !enters) continue;  // is never placed
      pairs.enter(enters);
      pairs.ask(subject, QueryMethod::kDual,
                std::string(enters ? "entered" : "placed") + " on " + name_of(target), tally);
    }
  }
  pairs.ask(subject, QueryMethod::kBrute, "brute force", tally);
}

}  // namespace raysheaf::checks
