// The data that the checks share: the ways of answering on this machine, and the count of cases.
//
// A check is a function of a subject, a seed and a tally: one round, which depends only on the
// seed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "exec/executor.h"
#include "intersect/triangle_body.h"
#include "raysheaf/hit_points.h"
#include "raysheaf/points.h"
#include "raysheaf/query.h"
#include "raysheaf/verify.h"

namespace raysheaf::checks {

/// The functions to check, and the SIMD targets and threads on which they run. Tests replace the
/// functions by wrong ones.
struct Subject {
  /// `most_threads` = 0: all cores; never more.
  explicit Subject(std::uint32_t most_threads);

  std::function<std::vector<Hit>(const Scene&, std::span<const Ray>, const QueryOptions&)>
      closest_hit;
  std::function<std::vector<std::uint8_t>(const Scene&, std::span<const Ray>, const QueryOptions&)>
      any_hit;
  std::function<HitRows(const Scene&, std::span<const Ray>, const QueryOptions&)> all_hits;
  std::function<HitRows(const Scene&, std::span<const Ray>, std::uint32_t, const QueryOptions&)>
      first_hits;
  std::function<std::vector<std::uint32_t>(const Scene&, std::span<const Ray>, const QueryOptions&)>
      hit_counts;
  std::function<std::vector<HitPoint>(const Scene&, std::span<const Ray>, std::span<const Hit>,
                                      std::span<const float>)>
      hit_points;
  /// `closest_point` if only one is asked for.
  std::function<std::vector<ClosestPoint>(const Scene&, const PointParts&, std::size_t,
                                          const PointOptions&)>
      nearest;
  std::function<std::vector<double>(const Scene&, const PointParts&, const PointOptions&)>
      signed_distance;
  std::function<std::vector<std::uint8_t>(const Scene&, const PointParts&, const PointOptions&)>
      contains;
  std::function<bool(const RaySetup&, Vec3, Vec3, Vec3, TriangleHit*)> intersect;

  std::vector<std::int64_t> targets;
  struct Threads {
    std::uint32_t count;
    Context context;
    std::shared_ptr<const Executor> executor;
  };
  std::vector<Threads> threads;  ///< ascending: 1, 2, the most
  /// The CPU as an emulated device.
  std::shared_ptr<const Context> device;

  [[nodiscard]] const Threads& most() const { return threads.back(); }
};

class Tally {
 public:
  explicit Tally(PromiseReport* report) : report_(report) {}
  void begin_round(std::uint64_t seed) {
    seed_ = seed;
    ++report_->rounds;
  }
  void tried(std::uint64_t cases) { report_->cases += cases; }
  void fail(std::string what);
  /// For failures found by several threads: counts them, and keeps the first.
  void fail(std::uint64_t count, std::string first);

 private:
  PromiseReport* report_;
  std::uint64_t seed_ = 0;
};

void check_brute_force(const Subject& subject, std::uint64_t seed, Tally* tally);
void check_determinism(const Subject& subject, std::uint64_t seed, Tally* tally);
void check_watertight(const Subject& subject, std::uint64_t seed, Tally* tally);
void check_bounds(const Subject& subject, std::uint64_t seed, Tally* tally);
void check_instances(const Subject& subject, std::uint64_t seed, Tally* tally);
void check_history(const Subject& subject, std::uint64_t seed, Tally* tally);
/// `errors`: t, u and v of ordinary pairs, then of adversarial ones.
void check_exact(const Subject& subject, std::uint64_t seed, Tally* tally,
                 std::vector<ErrorHistogram>* errors);
[[nodiscard]] std::vector<ErrorHistogram> empty_histograms();

/// Checks the promises of `options` with `subject`; `verify` does so with the library itself.
[[nodiscard]] VerifyReport verify_subject(const Subject& subject, const VerifyOptions& options);

/// Bit for bit.
[[nodiscard]] bool same(const Hit& a, const Hit& b);
/// For messages; nine digits identify a float, seventeen a double.
[[nodiscard]] std::string text_of(const Hit& hit);
[[nodiscard]] std::string text_of(const Ray& ray);
[[nodiscard]] std::string text_of(Vec3 v);
[[nodiscard]] std::string text_of(const ClosestPoint& found);
[[nodiscard]] std::string text_of(double x);

}  // namespace raysheaf::checks
