// What raysheaf promises, checked on the machine that it runs on (docs/verify.md).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/render.h"

namespace raysheaf {

enum class Promise : std::uint8_t {
  kBruteForce,   ///< every method answers as brute force does, bit for bit
  kDeterminism,  ///< repeated, reordered, split, on changed scenes: the same bits
  kWatertight,   ///< no ray leaves a closed mesh through an edge or a vertex
  kBounds,       ///< no bound of rays or triangles loses a hit
  kExact,        ///< hit or miss is what exact arithmetic on the floats says; t within 2 ulp
};
inline constexpr std::array kPromises{Promise::kBruteForce, Promise::kDeterminism,
                                      Promise::kWatertight, Promise::kBounds, Promise::kExact};

/// "brute-force", "determinism", "watertight", "bounds", "exact".
[[nodiscard]] const char* to_string(Promise promise);
/// What is promised, as one sentence without a full stop.
[[nodiscard]] const char* sentence_of(Promise promise);
/// Throws `Error` (kInvalidArgument) naming the ones there are.
[[nodiscard]] Promise promise_from_string(std::string_view name);

struct VerifyOptions {
  std::vector<Promise> promises;  ///< empty: all
  /// Checks come in rounds. All that happens in one follows from its seed; the first has this one,
  /// each later one a seed larger by one.
  std::uint64_t seed = 1;
  std::uint64_t rounds = 0;      ///< of each promise; 0: as many as take a minute or two in all
  std::uint64_t edge_rays = 0;   ///< where not 0: of kWatertight, rounds until so many rays
  std::uint64_t exact_rays = 0;  ///< where not 0: of kExact, rounds until so many rays
  std::uint32_t threads = 0;     ///< the most that are used, never more than cores; 0 is all
  /// Called between rounds; false asks to stop (`Error` kCancelled).
  std::function<bool(const Progress&)> progress;
};

struct VerifyFailure {
  std::uint64_t seed = 0;  ///< of the round: verify with it and `rounds` = 1 shows it again
  std::string what;        ///< who answered, what it was asked, and the two answers
};

struct PromiseReport {
  Promise promise = Promise::kBruteForce;
  std::string unit;  ///< what `cases` counts: "answers", "rays", "hits"
  std::uint64_t rounds = 0, cases = 0, failures = 0;
  std::vector<VerifyFailure> first_failures;  ///< 10 at most
  double seconds = 0;
};

/// How far a number is from what exact arithmetic gives.
struct ErrorHistogram {
  static constexpr std::size_t kBins = 26;
  std::string what;  ///< "t, ordinary", ...
  std::string unit;  ///< of the errors
  /// [0]: at most half a unit. [i]: more than the one before, and at most 2^(i - 1) units. The last
  /// one holds all that are larger.
  std::array<std::uint64_t, kBins> counts{};
  double largest = 0;

  void add(double error);
  [[nodiscard]] std::uint64_t total() const;
};

struct VerifyReport {
  std::uint64_t seed = 0;
  std::vector<std::string> methods, simd_targets;
  std::vector<std::uint32_t> threads;
  std::vector<PromiseReport> promises;  ///< those that were asked for
  std::vector<ErrorHistogram> errors;   ///< of kExact
  [[nodiscard]] bool kept() const;      ///< whether nothing failed
};

/// Checks promises on this machine. Cases and failures depend on the options and on the machine's
/// SIMD and cores alone. Meanwhile the whole process runs on one SIMD target after another: nothing
/// else may query in it. Throws `Error`: kCancelled; kInvalidArgument for `threads` above 1024.
[[nodiscard]] VerifyReport verify(const VerifyOptions& options = {});

}  // namespace raysheaf
