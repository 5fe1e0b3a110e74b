#include <nlohmann/json.hpp>

#include "raysheaf/version.h"
#include "verify/report.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json promise_json(const PromiseReport& promise) {
  Json failures = Json::array();
  for (const VerifyFailure& failure : promise.first_failures)
    failures.push_back({{"seed", failure.seed}, {"what", failure.what}});
  return {{"promise", to_string(promise.promise)},
          {"what", sentence_of(promise.promise)},
          {"unit", promise.unit},
          {"rounds", promise.rounds},
          {"tried", promise.cases},
          {"failed", promise.failures},
          {"first_failures", std::move(failures)},
          {"seconds", promise.seconds}};
}

/// `limits`: the largest error of each count except the last.
Json histogram_json(const ErrorHistogram& histogram) {
  Json limits = Json::array();
  double limit = 0.5;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin) {
    limits.push_back(limit);
    limit *= 2;
  }
  return {{"what", histogram.what},
          {"unit", histogram.unit},
          {"limits", std::move(limits)},
          {"counts", histogram.counts},
          {"largest", histogram.largest}};
}

}  // namespace

std::string verify_json(const VerifyReport& report) {
  Json promises = Json::array(), errors = Json::array();
  for (const PromiseReport& promise : report.promises) promises.push_back(promise_json(promise));
  for (const ErrorHistogram& histogram : report.errors) errors.push_back(histogram_json(histogram));
  const Json all = {{"version", RAYSHEAF_VERSION},
                    {"kept", report.kept()},
                    {"seed", report.seed},
                    {"methods", report.methods},
                    {"simd_targets", report.simd_targets},
                    {"threads", report.threads},
                    {"promises", std::move(promises)},
                    {"errors", std::move(errors)}};
  return all.dump(2) + "\n";
}

}  // namespace raysheaf::app
