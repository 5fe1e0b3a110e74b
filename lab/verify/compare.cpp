#include "lab/verify/compare.h"

#include <algorithm>
#include <limits>

#include "exec/progress_meter.h"
#include "intersect/exact.h"
#include "lab/verify/fault.h"
#include "lab/verify/simd_target.h"
#include "render/frame/trace.h"

namespace raysheaf::checks {

Hit Problem::hit_of(std::uint32_t triangle, float t, float u, float v) const {
  if (triangle == kInvalidId) return {};
  std::uint32_t mesh = 0;
  for (; triangle >= soup.meshes[mesh].size() / 3; ++mesh)
    triangle -= static_cast<std::uint32_t>(soup.meshes[mesh].size() / 3);
  return {t, u, v, triangle, mesh, mesh};
}

void Comparison::closest(const std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < problem_.rays.size(); ++i)
    if (!same(hits[i], problem_.closest(i))) return fail("closest_hit", i, hits[i]);
}

void Comparison::any(const std::vector<std::uint8_t>& occluded) {
  for (std::size_t i = 0; i < problem_.rays.size(); ++i)
    if (occluded[i] != (problem_.rows[i].empty() ? 0 : 1))
      return fail("any_hit", i, std::to_string(occluded[i]), text(problem_.closest(i)));
}

void Comparison::all(const HitRows& rows, const char* question, std::size_t most) {
  for (std::size_t i = 0; i < problem_.rays.size(); ++i) {
    const std::span<const Hit> row = rows[i];
    const std::span<const Hit> right =
        std::span(problem_.rows[i]).first(std::min(most, problem_.rows[i].size()));
    const auto [got, expected] =
        std::mismatch(row.begin(), row.end(), right.begin(), right.end(), same);
    if (got == row.end() && expected == right.end()) continue;
    const std::string place = " as number " + std::to_string(got - row.begin() + 1) + " of ";
    return fail(
        question, i, text(got == row.end() ? Hit{} : *got) + place + std::to_string(row.size()),
        text(expected == right.end() ? Hit{} : *expected) + place + std::to_string(right.size()));
  }
}

void Comparison::counts(const std::vector<std::uint32_t>& counts) {
  for (std::size_t i = 0; i < problem_.rays.size(); ++i)
    if (counts[i] != problem_.rows[i].size())
      return fail("hit_counts", i, std::to_string(counts[i]),
                  std::to_string(problem_.rows[i].size()) + " hits");
}

void Comparison::closest(const std::vector<RayHit>& hits) {
  for (std::size_t i = 0; i < problem_.rays.size(); ++i) {
    const Hit right = problem_.closest(i);
    const Hit hit = problem_.hit_of(hits[i].triangle, hits[i].t, right.u, right.v);
    if (!same(hit, right)) return fail("closest hits", i, hit);
  }
}

std::string Comparison::text(const Hit& hit) const {
  if (hit.prim_id == kInvalidId) return text_of(hit);
  const std::vector<std::vector<Vec3>>& meshes = problem_.soup.meshes;
  if (hit.geom_id >= meshes.size() || hit.prim_id >= meshes[hit.geom_id].size() / 3)
    return text_of(hit) + ", which does not exist";
  const Vec3* const p = &meshes[hit.geom_id][std::size_t{3} * hit.prim_id];
  return text_of(hit) + " [" + text_of(p[0]) + ", " + text_of(p[1]) + ", " + text_of(p[2]) + "]";
}

void Comparison::fail(const char* question, std::size_t ray, const Hit& got) {
  fail(question, ray, text(got), text(problem_.closest(ray)));
}

void Comparison::fail(const char* question, std::size_t ray, const std::string& got,
                      const std::string& expected) {
  tally_->fail(way_ + ", " + question + ": " + problem_.soup.text() + ", ray " +
               std::to_string(ray) + " of " + std::to_string(problem_.rays.size()) + ", a " +
               text_of(problem_.rays[ray]) + ": expected " + expected + ", got " + got +
               (note_ ? note_(ray) : std::string()));
}

std::string way(const std::string& method, std::int64_t target, std::uint32_t threads) {
  return method + " on " + name_of(target) + ", " + std::to_string(threads) +
         (threads == 1 ? " thread" : " threads");
}

namespace {

std::uint64_t compare_queries(const Subject& subject, const Problem& problem,
                              const Subject::Threads& threads, std::int64_t target, Tally* tally) {
  Scene scene(threads.context);
  problem.soup.add_to(&scene);
  std::uint64_t answers = 0;
  for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute}) {
    const bool brute = method == QueryMethod::kBrute;
    if (brute && target != subject.targets.front()) continue;  // it has no SIMD
    Comparison comparison(problem, way(brute ? "brute" : "dual", target, threads.count), tally);
    const QueryOptions options{.method = method};
    comparison.closest(subject.closest_hit(scene, problem.rays, options));
    comparison.any(subject.any_hit(scene, problem.rays, options));
    comparison.all(subject.all_hits(scene, problem.rays, options));
    answers += 3 * problem.rays.size();
  }
  return answers;
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

/// Compares the renderer's methods, on its flat scene.
std::uint64_t compare_renderer(const Problem& problem, const Subject::Threads& threads,
                               std::int64_t target, Random* random, Tally* tally) {
  const Executor& executor = *threads.executor;
  const SceneDescription description = problem.soup.description();
  const FlatScene flat = flatten(executor, description, mesh_bounds(executor, description));
  const RayBatch batch = batch_of(problem.rays, random);
  std::uint64_t answers = 0;
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
    Comparison(problem, way(name, target, threads.count), tally).closest(hits);
    answers += hits.size();
  }
  return answers;
}

/// The ray-triangle test, and its error.
struct Tested {
  const Subject& subject;
  std::uint64_t faults = 0;
  std::string first_fault;

  TriangleHit hit(Ray ray, const std::array<Vec3, 3>& t, const ExactAnswer& exact) {
    ray.t_min = 0, ray.t_max = std::numeric_limits<float>::infinity();
    TriangleHit hit{};
    const bool met = subject.intersect(make_ray_setup(ray), t[0], t[1], t[2], &hit);
    if (std::string fault = fault_of(ray, t, exact, met, hit); !fault.empty() && faults++ == 0)
      first_fault = std::move(fault);
    if (met) return hit;
    return {static_cast<float>(exact.t), static_cast<float>(exact.u), static_cast<float>(exact.v),
            exact.front};
  }
};

std::vector<Hit> exact_row(const Soup& soup, const Ray& ray, Tested* test) {
  std::vector<Hit> row;
  for (std::uint32_t mesh = 0; mesh < soup.meshes.size(); ++mesh)
    for (std::uint32_t i = 0; 3 * i < soup.meshes[mesh].size(); ++i) {
      const Vec3* const p = &soup.meshes[mesh][std::size_t{3} * i];
      if (!meets_exactly(ray, p[0], p[1], p[2])) continue;
      const ExactAnswer exact = exact_answer(ray, p[0], p[1], p[2]);
      if (!is_hit(exact)) continue;
      const TriangleHit hit = test->hit(ray, {p[0], p[1], p[2]}, exact);
      if (hit.t >= ray.t_min && hit.t <= ray.t_max)
        row.push_back({hit.t, hit.u, hit.v, i, mesh, mesh});
    }
  std::stable_sort(row.begin(), row.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
  return row;
}

}  // namespace

void solve_by_brute_force(const Context& context, Problem* problem) {
  Scene scene(context);
  problem->soup.add_to(&scene);
  problem->rows = all_hits(scene, problem->rays, {.method = QueryMethod::kBrute});
}

void solve_exactly(const Subject& subject, Problem* problem, Tally* tally) {
  problem->rows.offsets.assign(1, 0);
  problem->rows.hits.clear();
  Tested test{subject, 0, {}};
  for (const Ray& ray : problem->rays) {
    for (const Hit& hit : exact_row(problem->soup, ray, &test)) problem->rows.hits.push_back(hit);
    problem->rows.offsets.push_back(problem->rows.hits.size());
  }
  if (test.faults > 0) tally->fail(test.faults, "the ray-triangle test: " + test.first_fault);
}

std::uint64_t compare_every_way(const Subject& subject, const Problem& problem, ThreadCounts counts,
                                Random* random, Tally* tally) {
  std::uint64_t answers = 0;
  for (const std::int64_t target : subject.targets) {
    const OnSimdTarget on(target);
    for (const Subject::Threads& threads : subject.threads) {
      if (counts == ThreadCounts::kMost && &threads != &subject.most()) continue;
      answers += compare_queries(subject, problem, threads, target, tally);
      answers += compare_renderer(problem, threads, target, random, tally);
    }
  }
  return answers;
}

}  // namespace raysheaf::checks
