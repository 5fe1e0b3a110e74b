// Implements the public checks: selects promises and rounds, and makes the report.
#include "raysheaf/verify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "lab/verify/promise.h"
#include "lab/verify/round.h"
#include "lab/verify/simd_target.h"
#include "raysheaf/error.h"
#include "raysheaf/paper.h"

namespace raysheaf {

void ErrorHistogram::add(double error) {
  largest = std::max(largest, error);
  std::size_t bin = 0;
  double limit = 0.5;
  while (bin + 1 < kBins && !(error <= limit)) limit *= 2, ++bin;
  ++counts[bin];
}

std::uint64_t ErrorHistogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

bool VerifyReport::kept() const {
  return std::all_of(promises.begin(), promises.end(),
                     [](const PromiseReport& promise) { return promise.failures == 0; });
}

VerifyReport verify(const VerifyOptions& options) {
  if (options.threads > 1024)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 0 to 1024, not " + std::to_string(options.threads), "threads");
  if (!(options.seconds >= 0 && options.seconds <= 1e9))
    throw Error(ErrorCode::kInvalidArgument, "must be from 0 to 1e9", "seconds");
  use_paper_methods();
  return checks::verify_subject(checks::Subject(options.threads), options);
}

namespace checks {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::uint64_t milliseconds(double seconds) {
  return static_cast<std::uint64_t>(seconds * 1000);
}

class Run {
 public:
  Run(const Subject& subject, const VerifyOptions& options)
      : subject_(subject), options_(options), errors_(empty_histograms()) {}

  PromiseReport check(Promise promise) {
    PromiseReport report;
    report.promise = promise;
    report.unit = words_of(promise).unit;
    Tally tally(&report);
    start_ = Clock::now();
    while (!is_done(report)) {
      tell(report);
      const std::uint64_t seed = options_.seed + report.rounds;
      tally.begin_round(seed);
      round(promise, seed, &tally);
    }
    tell(report);
    report.seconds = seconds_since(start_);
    return report;
  }

  std::vector<ErrorHistogram> errors() && { return std::move(errors_); }

 private:
  /// If not 0, rays are counted instead of rounds.
  [[nodiscard]] std::uint64_t least_rays(Promise promise) const {
    if (promise == Promise::kWatertight) return options_.edge_rays;
    return promise == Promise::kExact ? options_.exact_rays : 0;
  }
  [[nodiscard]] std::uint64_t rounds_of(Promise promise) const {
    return options_.rounds != 0 ? options_.rounds : words_of(promise).rounds;
  }
  [[nodiscard]] bool is_done(const PromiseReport& report) const {
    const auto [done, total] = progress_of(report);
    return done >= total;
  }

  struct Part {
    std::uint64_t done, total;
  };
  /// In rays, milliseconds or rounds. At least one round is run.
  [[nodiscard]] Part progress_of(const PromiseReport& report) const {
    if (const std::uint64_t rays = least_rays(report.promise); rays != 0)
      return {report.cases, rays};
    if (options_.seconds == 0) return {report.rounds, rounds_of(report.promise)};
    const auto total = std::max(std::uint64_t{1}, milliseconds(options_.seconds));
    const std::uint64_t done = report.rounds == 0 ? 0 : milliseconds(seconds_since(start_));
    return {std::min(done, total), total};
  }

  void tell(const PromiseReport& report) const {
    if (!options_.progress) return;
    const auto [done, total] = progress_of(report);
    Progress progress;
    progress.stage = to_string(report.promise);
    progress.done = done;
    progress.total = total;
    if (!options_.progress(progress)) throw Error(ErrorCode::kCancelled, "stopped by the caller");
  }

  void round(Promise promise, std::uint64_t seed, Tally* tally) {
    switch (promise) {
      case Promise::kBruteForce:
        return check_brute_force(subject_, seed, tally);
      case Promise::kDeterminism:
        return check_determinism(subject_, seed, tally);
      case Promise::kWatertight:
        return check_watertight(subject_, seed, tally);
      case Promise::kBounds:
        return check_bounds(subject_, seed, tally);
      case Promise::kExact:
        return check_exact(subject_, seed, tally, &errors_);
      case Promise::kInstances:
        return check_instances(subject_, seed, tally);
      case Promise::kHistory:
        return check_history(subject_, seed, tally);
    }
  }

  const Subject& subject_;
  const VerifyOptions& options_;
  std::vector<ErrorHistogram> errors_;
  Clock::time_point start_;  ///< of the promise
};

}  // namespace

VerifyReport verify_subject(const Subject& subject, const VerifyOptions& options) {
  VerifyReport report;
  report.seed = options.seed;
  for (const Method method :
       {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual})
    report.methods.emplace_back(to_string(method));
  for (const std::int64_t target : subject.targets) report.simd_targets.push_back(name_of(target));
  for (const Subject::Threads& threads : subject.threads) report.threads.push_back(threads.count);
  Run run(subject, options);
  for (const Promise promise : kPromises) {
    const std::vector<Promise>& asked = options.promises;
    if (asked.empty() || std::find(asked.begin(), asked.end(), promise) != asked.end())
      report.promises.push_back(run.check(promise));
  }
  const auto has_errors =
      std::any_of(report.promises.begin(), report.promises.end(),
                  [](const PromiseReport& p) { return p.promise == Promise::kExact; });
  if (has_errors) report.errors = std::move(run).errors();
  return report;
}

}  // namespace checks
}  // namespace raysheaf
