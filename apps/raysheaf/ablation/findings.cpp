#include "ablation/findings.h"

#include <algorithm>
#include <cmath>

namespace raysheaf::app {
namespace {

bool same(const MethodSettings& a, const MethodSettings& b) {
  return a.key == b.key && a.key_bits == b.key_bits && a.bound == b.bound;
}

/// The pairings of the first scene that has such rays; the caller looks them up in the other
/// scenes.
std::vector<Pairing> candidates(const AblationReport& report, LabRays rays) {
  std::vector<Pairing> all;
  for (const AblationRow& row : report.rows) {
    if (row.rays != rays) continue;
    bool known = false;
    for (const Pairing& p : all) known = known || same(p.settings, row.settings);
    if (!known) all.push_back({rays, row.settings, 0, 0});
  }
  return all;
}

/// Geometric means of the smallest figures of the pairing.
void average(const AblationReport& report, Pairing* pairing) {
  double log_percent = 0, log_ms = 0;
  int scenes = 0;
  for (const std::string& scene : report.scenes) {
    const RowTest here = [&](const AblationRow& row) {
      return row.scene == scene && row.rays == pairing->rays &&
             same(row.settings, pairing->settings) && row.counts.total_tests() > 0;
    };
    const AblationRow* fewest = fewest_tests(report, here);
    if (fewest == nullptr) continue;
    log_percent += std::log(fewest->percent());
    log_ms += std::log(std::max(least_time(report, here)->total_ms(), 1e-3));
    ++scenes;
  }
  if (scenes == 0) return;
  pairing->percent = std::exp(log_percent / scenes);
  pairing->ms = std::exp(log_ms / scenes);
}

}  // namespace

std::vector<Pairing> pairings(const AblationReport& report, LabRays rays) {
  std::vector<Pairing> all = candidates(report, rays);
  for (Pairing& p : all) average(report, &p);
  std::erase_if(all, [](const Pairing& p) { return !(p.percent > 0); });
  return all;
}

const Pairing* least(const std::vector<Pairing>& all, double Pairing::*figure,
                     const std::function<bool(const Pairing&)>& passes) {
  const Pairing* best = nullptr;
  for (const Pairing& p : all)
    if (passes(p) && (best == nullptr || p.*figure < best->*figure)) best = &p;
  return best;
}

const Pairing* crsh_pairing(const std::vector<Pairing>& all) {
  return least(all, &Pairing::percent, [](const Pairing& p) {
    return p.settings.key == RayKey::kCrsh && p.settings.bound == BundleBound::kSphereCone;
  });
}

double against_sphere_cone(const std::vector<Pairing>& all, BundleBound bound,
                           double Pairing::*figure) {
  double sum = 0;
  int keys = 0;
  for (const Pairing& p : all) {
    if (p.settings.bound != bound) continue;
    for (const Pairing& q : all) {
      if (q.settings.bound != BundleBound::kSphereCone || q.settings.key != p.settings.key ||
          q.settings.key_bits != p.settings.key_bits)
        continue;
      sum += std::log(p.*figure / q.*figure);
      ++keys;
    }
  }
  return keys > 0 ? std::exp(sum / keys) : 0;
}

std::string reason(RayKey key) {
  return words_of(key).reason;
}

std::string reason(BundleBound bound) {
  switch (bound) {
    case BundleBound::kSphereCone:
      return "a sphere and a cone are the cheapest to test";
    case BundleBound::kFiniteCone:
      return "the cone ends where its rays end";
    case BundleBound::kShaft:
      return "the hull of two boxes is as wide as the rays, from their origins to their ends";
    case BundleBound::kFrustum:
      return "four planes follow the spread of the rays in two directions separately, while a cone "
             "takes the "
             "larger spread";
    case BundleBound::kShaftAndCone:
      break;
  }
  return "the cone cuts the corners off the shaft, and the shaft cuts the flat sides off the cone";
}

}  // namespace raysheaf::app
