// Every method on every SIMD target with every number of threads against brute force.
#include <algorithm>
#include <bit>

#include "exec/progress_meter.h"
#include "frame/trace.h"
#include "verify/round.h"
#include "verify/simd_target.h"
#include "verify/soup.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kBruteTriangles = 1200;
constexpr std::size_t kBruteRays = 1500;

struct Problem {
  Soup soup;
  std::vector<Ray> rays;
  HitRows rows;  ///< of brute force
  std::vector<Hit> closest;

  explicit Problem(Random* random)
      : soup(make_soup(kBruteTriangles, {}, random)),
        rays(random->one_in(4) ? make_fan(soup, 1 + random->below(kBruteRays), random)
                               : make_rays(soup, 1 + random->below(kBruteRays), random)) {}

  void solve(const Context& context) {
    Scene scene(context);
    soup.add_to(&scene);
    rows = raysheaf::all_hits(scene, rays, {.method = QueryMethod::kBrute});
    for (std::size_t i = 0; i < rays.size(); ++i)
      closest.push_back(rows[i].empty() ? Hit{} : rows[i].front());
  }
};

/// One way of answering one problem.
class Comparison {
 public:
  Comparison(const Problem& problem, std::string way, Tally* tally)
      : problem_(problem), way_(std::move(way)), tally_(tally) {}

  void closest(const std::vector<Hit>& hits) {
    each(
        "closest_hit", [&](std::size_t i) { return same(hits[i], problem_.closest[i]); },
        [&](std::size_t i) { return text_of(hits[i]); });
  }
  void any(const std::vector<std::uint8_t>& occluded) {
    each(
        "any_hit", [&](std::size_t i) { return occluded[i] == (problem_.rows[i].empty() ? 0 : 1); },
        [&](std::size_t i) { return std::to_string(occluded[i]); });
  }
  void all(const HitRows& rows) {
    const auto row_is_right = [&](std::size_t i) {
      return std::equal(rows[i].begin(), rows[i].end(), problem_.rows[i].begin(),
                        problem_.rows[i].end(), same);
    };
    each("all_hits", row_is_right,
         [&](std::size_t i) { return std::to_string(rows[i].size()) + " hits"; });
  }
  /// Of the renderer: `first[mesh]` is the number of a mesh's first triangle.
  void numbered(const std::vector<RayHit>& hits, const std::vector<std::uint32_t>& first) {
    const auto is_right = [&](std::size_t i) {
      const Hit& right = problem_.closest[i];
      if (right.prim_id == kInvalidId) return !hits[i].found();
      return std::bit_cast<std::uint32_t>(hits[i].t) == std::bit_cast<std::uint32_t>(right.t) &&
             hits[i].triangle == first[right.geom_id] + right.prim_id;
    };
    each("closest hits", is_right,
         [&](std::size_t i) { return hits[i].found() ? "another hit" : std::string("no hit"); });
  }

 private:
  template <class IsRight, class Text>
  void each(const char* question, const IsRight& is_right, const Text& text) {
    const std::size_t count = problem_.rays.size();
    tally_->tried(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_right(i)) continue;
      tally_->fail(way_ + ", " + question + ": " + problem_.soup.text() + ", ray " +
                   std::to_string(i) + " of " + std::to_string(count) + ", a " +
                   text_of(problem_.rays[i]) + ": " + text(i) + " instead of " +
                   text_of(problem_.closest[i]));
      return;  // one a batch is named
    }
  }

  const Problem& problem_;
  std::string way_;
  Tally* tally_;
};

std::string way(const std::string& method, std::int64_t target, std::uint32_t threads) {
  return method + " on " + name_of(target) + ", " + std::to_string(threads) +
         (threads == 1 ? " thread" : " threads");
}

void compare_queries(const Subject& subject, const Problem& problem,
                     const Subject::Threads& threads, std::int64_t target, Tally* tally) {
  Scene scene(threads.context);
  problem.soup.add_to(&scene);
  for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute}) {
    const bool brute = method == QueryMethod::kBrute;
    if (brute && target != subject.targets.front()) continue;  // it has no SIMD
    Comparison comparison(problem, way(brute ? "brute" : "dual", target, threads.count), tally);
    const QueryOptions options{.method = method};
    comparison.closest(subject.closest_hit(scene, problem.rays, options));
    comparison.any(subject.any_hit(scene, problem.rays, options));
    comparison.all(subject.all_hits(scene, problem.rays, options));
  }
}

RayBatch batch_of(const std::vector<Ray>& rays, Random* random) {
  RayBatch batch;
  batch.kind = RayKind::kReflection;
  batch.width = 64;
  batch.rays.assign(rays.begin(), rays.end());
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    batch.slots.push_back(i);
    batch.pixels.push_back(i);
    batch.keys.push_back(random->below(50));
  }
  return batch;
}

MethodSettings some_settings(Method method, Random* random) {
  MethodSettings settings = method_settings(method);
  if (method != Method::kRah && method != Method::kCrsh) return settings;
  constexpr BundleBound kBounds[] = {BundleBound::kSphereCone, BundleBound::kFiniteCone,
                                     BundleBound::kShaft, BundleBound::kFrustum,
                                     BundleBound::kShaftAndCone};
  settings.bound = kBounds[random->below(std::size(kBounds))];
  settings.levels = 1 + random->below(3);
  settings.branching = 2 + random->below(9);
  settings.mesh_culling = random->one_in(2);
  return settings;
}

/// The renderer's methods, on the flat scene that it makes.
void compare_renderer(const Problem& problem, const Subject::Threads& threads, std::int64_t target,
                      Random* random, Tally* tally) {
  const Executor& executor = *threads.executor;
  const SceneDescription description = problem.soup.description();
  const FlatScene flat = flatten(executor, description, mesh_bounds(executor, description));
  std::vector<std::uint32_t> first(1, 0);
  for (const std::vector<Vec3>& mesh : problem.soup.meshes)
    first.push_back(first.back() + static_cast<std::uint32_t>(mesh.size() / 3));
  const RayBatch batch = batch_of(problem.rays, random);
  for (const Method method :
       {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual}) {
    TraceOptions options;
    options.method = some_settings(method, random);
    BatchStatistics statistics;
    ProgressMeter meter;
    const std::vector<RayHit> hits = trace(executor, flat, batch, options, &statistics, {}, &meter);
    std::string name = std::string("the renderer's ") + to_string(method);
    if (method == Method::kRah || method == Method::kCrsh)
      name += std::string(" with ") + to_string(options.method.bound);
    Comparison(problem, way(name, target, threads.count), tally).numbered(hits, first);
  }
}

}  // namespace

void check_brute_force(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  Problem problem(&random);
  problem.solve(subject.most().context);
  for (const std::int64_t target : subject.targets) {
    const OnSimdTarget on(target);
    for (const Subject::Threads& threads : subject.threads) {
      compare_queries(subject, problem, threads, target, tally);
      compare_renderer(problem, threads, target, &random, tally);
    }
  }
}

}  // namespace raysheaf::checks
