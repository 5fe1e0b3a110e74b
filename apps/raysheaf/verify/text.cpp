#include <fmt/ranges.h>

#include "apps/support/table.h"
#include "verify/report.h"

namespace raysheaf::app {
namespace {

template <class Values>
std::string joined(const Values& values) {
  return fmt::format("{}", fmt::join(values, ", "));
}

std::string promises_text(const VerifyReport& report) {
  Table table({"promise", "what", "tried", "failed", "s"});
  for (const PromiseReport& p : report.promises)
    table.add({to_string(p.promise), sentence_of(p.promise),
               grouped(std::to_string(p.cases)) + " " + p.unit, grouped(std::to_string(p.failures)),
               fmt::format("{:.1f}", p.seconds)});
  return table.text();
}

/// The smallest limit of the histogram that contains a part of the errors.
std::string within(const ErrorHistogram& h, double part) {
  std::uint64_t seen = 0;
  const double wanted = part * static_cast<double>(h.total());
  double limit = 0.5;
  for (std::size_t bin = 0; bin + 1 < h.counts.size(); ++bin) {
    seen += h.counts[bin];
    if (static_cast<double>(seen) >= wanted) return fmt::format("{:g}", limit);
    limit *= 2;
  }
  return "more";
}

std::string errors_text(const VerifyReport& report) {
  Table table(
      {"error of", "unit", "numbers", "half within", "99 % within", "99.99 % within", "largest"});
  for (const ErrorHistogram& h : report.errors)
    table.add({h.what, h.unit, grouped(std::to_string(h.total())), within(h, 0.5), within(h, 0.99),
               within(h, 0.9999), fmt::format("{:.3g}", h.largest)});
  return table.text();
}

std::string failures_text(const PromiseReport& promise) {
  std::string text;
  for (const VerifyFailure& failure : promise.first_failures)
    text += fmt::format("{}: {}\n  reproduce: raysheaf verify --only {} --seed {} --rounds 1\n",
                        to_string(promise.promise), failure.what, to_string(promise.promise),
                        failure.seed);
  return text;
}

}  // namespace

std::string verify_text(const VerifyReport& report) {
  std::string text =
      fmt::format("SIMD {}; {} threads; methods {}; seed {}\n\n", joined(report.simd_targets),
                  joined(report.threads), joined(report.methods), report.seed);
  text += promises_text(report);
  if (!report.errors.empty()) text += "\n" + errors_text(report);
  for (const PromiseReport& promise : report.promises)
    if (promise.failures > 0) text += "\n" + failures_text(promise);
  return text + (report.kept() ? "\nEvery promise was kept.\n" : "\nNot every promise was kept.\n");
}

}  // namespace raysheaf::app
