// Compares every method on every SIMD target and with every number of threads with brute force.
#include "lab/verify/compare.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kBruteTriangles = 1200;
constexpr std::size_t kBruteRays = 1500;

}  // namespace

void check_brute_force(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  Problem problem;
  problem.soup = make_soup(kBruteTriangles, {}, &random);
  const bool fan = random.one_in(4);
  const std::size_t count = 1 + random.below(kBruteRays);
  problem.rays =
      fan ? make_fan(problem.soup, count, &random) : make_rays(problem.soup, count, &random);
  solve_by_brute_force(subject.most().context, &problem);
  tally->tried(compare_every_way(subject, problem, ThreadCounts::kAll, &random, tally));
}

}  // namespace raysheaf::checks
