// Checks queries and the ray-triangle test by exact arithmetic (docs/verify.md).
#include <cmath>

#include "lab/verify/compare.h"
#include "lab/verify/fault.h"
#include "lab/verify/pairs.h"
#include "lab/verify/whole_meshes.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kPairsOfAFamily = 250;
constexpr std::uint32_t kOrdinaryPairs = 1000;
constexpr std::uint32_t kProblemTriangles = 200;
constexpr std::size_t kProblemRays = 1000;
constexpr const char* kHistograms[] = {"t, ordinary",    "u, ordinary",    "v, ordinary",
                                       "t, adversarial", "u, adversarial", "v, adversarial"};

class Judge {
 public:
  Judge(const Subject& subject, Tally* tally, std::vector<ErrorHistogram>* errors)
      : subject_(subject), tally_(tally), errors_(*errors) {}

  void look_at(const RayAndTriangle& pair, const PairFamily& family, bool ordinary) {
    tally_->tried(1);
    const auto& [a, b, c] = pair.corners;
    const ExactAnswer exact = exact_answer(pair.ray, a, b, c);
    TriangleHit hit{};
    const bool met = subject_.intersect(make_ray_setup(pair.ray), a, b, c, &hit);
    std::string fault = fault_of(pair.ray, pair.corners, exact, met, hit);
    if (fault.empty() && met) fault = fault_of_interval(pair, hit);
    if (!fault.empty())
      tally_->fail("the ray-triangle test, " + std::string(family.name) + ": " + fault);
    if (met && is_hit(exact)) measure(exact, hit, ordinary);
  }

 private:
  /// The reported t decides whether a hit is in the interval.
  [[nodiscard]] std::string fault_of_interval(const RayAndTriangle& pair,
                                              const TriangleHit& hit) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    const float before = std::nextafter(hit.t, -kFar), after = std::nextafter(hit.t, kFar);
    struct Interval {
      float t_min, t_max;
    };
    for (const auto [t_min, t_max] :
         {Interval{hit.t, hit.t}, Interval{after, kFar}, Interval{0, before}, Interval{0, hit.t}}) {
      if (!(t_min >= 0 && t_min <= t_max)) continue;
      Ray ray = pair.ray;
      ray.t_min = t_min, ray.t_max = t_max;
      TriangleHit again{};
      const bool inside = hit.t >= t_min && hit.t <= t_max;
      const bool met = subject_.intersect(make_ray_setup(ray), pair.corners[0], pair.corners[1],
                                          pair.corners[2], &again);
      if (met != inside || (met && again.t != hit.t))
        return "the reported t does not decide about the interval: " + text_of(ray, pair.corners) +
               ": expected " + (inside ? "a hit" : "a miss") + ", got " +
               (met ? "a hit" : "a miss");
    }
    return {};
  }

  void measure(const ExactAnswer& exact, const TriangleHit& hit, bool ordinary) {
    const std::size_t first = ordinary ? 0 : 3;
    errors_[first].add(error_in_ulps(hit.t, exact.t));
    errors_[first + 1].add(std::fabs(double{hit.u} - exact.u) * 0x1p24);
    errors_[first + 2].add(std::fabs(double{hit.v} - exact.v) * 0x1p24);
  }

  const Subject& subject_;
  Tally* tally_;
  std::vector<ErrorHistogram>& errors_;
};

}  // namespace

void make_exact_problem(std::uint32_t most_triangles, std::size_t rays, Random* random,
                        Problem* problem) {
  const bool whole = !random->one_in(4), one_origin = random->one_in(4);
  Soup& soup = problem->soup;
  soup = whole ? make_whole_meshes(most_triangles, random) : make_soup(most_triangles, {}, random);
  problem->rays = whole        ? make_whole_rays(soup, rays, one_origin, random)
                  : one_origin ? make_fan(soup, rays, random)
                               : make_rays(soup, rays, random);
}

std::vector<ErrorHistogram> empty_histograms() {
  std::vector<ErrorHistogram> all(std::size(kHistograms));
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].what = kHistograms[i];
    all[i].unit = i % 3 == 0 ? "ulp" : "2^-24";
  }
  return all;
}

void check_exact(const Subject& subject, std::uint64_t seed, Tally* tally,
                 std::vector<ErrorHistogram>* errors) {
  Random random(seed);
  Judge judge(subject, tally, errors);
  for (const PairFamily& family : pair_families()) {
    const bool ordinary = &family == &pair_families().front();
    const std::uint32_t count = ordinary ? kOrdinaryPairs : kPairsOfAFamily;
    for (std::uint32_t i = 0; i < count; ++i) judge.look_at(family.make(&random), family, ordinary);
  }
  Problem problem;
  make_exact_problem(kProblemTriangles, kProblemRays, &random, &problem);
  solve_exactly(subject, &problem, tally);
  compare_every_way(subject, problem, ThreadCounts::kMost, &random, tally);
  tally->tried(problem.rays.size());
}

}  // namespace raysheaf::checks
