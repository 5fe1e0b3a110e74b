// Checks raysheaf's promises on the current machine (docs/verify.md).
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
  kBounds,       ///< no bounding volume of rays or triangles loses a hit
  kExact,        ///< hits and misses are those of exact arithmetic on the floats; t within 2 ulp
  kInstances,    ///< rays meet instances where the transforms of their time place them, exactly
  kHistory,      ///< scenes of any past, asked in any way, answer as brute force and arithmetic do
};
inline constexpr std::array kPromises{
    Promise::kBruteForce, Promise::kDeterminism, Promise::kWatertight, Promise::kBounds,
    Promise::kExact,      Promise::kInstances,   Promise::kHistory};

/// "brute-force", "determinism", "watertight", "bounds", "exact", "instances", "history".
[[nodiscard]] const char* to_string(Promise promise);
/// The promise as one sentence without a full stop.
[[nodiscard]] const char* sentence_of(Promise promise);
/// Throws `Error` (kInvalidArgument) naming the valid names.
[[nodiscard]] Promise promise_from_string(std::string_view name);

struct VerifyOptions {
  std::vector<Promise> promises;  ///< empty: all
  /// Checks run in rounds. A round depends only on its seed; the first has this seed, each later
  /// one a seed larger by one.
  std::uint64_t seed = 1;
  std::uint64_t rounds = 0;      ///< of each promise; 0: as many as take a minute or two in total
  std::uint64_t edge_rays = 0;   ///< if not 0: kWatertight runs rounds until this many rays
  std::uint64_t exact_rays = 0;  ///< if not 0: kExact runs rounds until this many rays
  double seconds = 0;         ///< if not 0: each promise runs rounds until so much time has passed
  std::uint32_t threads = 0;  ///< the maximum used, never more than cores; 0: all cores
  /// Called between rounds; false requests to stop (`Error` kCancelled).
  std::function<bool(const Progress&)> progress;
};

struct VerifyFailure {
  std::uint64_t seed = 0;  ///< of the round: `verify` with this seed and `rounds` = 1 reproduces it
  std::string what;        ///< the configuration, the query, and the two answers
};

struct PromiseReport {
  Promise promise = Promise::kBruteForce;
  std::string unit;  ///< what `cases` counts: "answers", "rays", "hits"
  std::uint64_t rounds = 0, cases = 0, failures = 0;
  std::vector<VerifyFailure> first_failures;  ///< at most 10
  double seconds = 0;
};

/// Errors of a number compared with exact arithmetic.
struct ErrorHistogram {
  static constexpr std::size_t kBins = 26;
  std::string what;  ///< "t, ordinary", ...
  std::string unit;  ///< of the errors
  /// [0]: at most half a unit. [i]: more than the previous bin, and at most 2^(i - 1) units. The
  /// last bin holds all larger errors.
  std::array<std::uint64_t, kBins> counts{};
  double largest = 0;

  void add(double error);
  [[nodiscard]] std::uint64_t total() const;
};

struct VerifyReport {
  std::uint64_t seed = 0;
  std::vector<std::string> methods, simd_targets;
  std::vector<std::uint32_t> threads;
  std::vector<PromiseReport> promises;  ///< those that were requested
  std::vector<ErrorHistogram> errors;   ///< of kExact
  [[nodiscard]] bool kept() const;      ///< whether nothing failed
};

/// Checks promises on this machine. Without `seconds`, cases and failures depend only on the
/// options and on the machine's SIMD and cores. Meanwhile the whole process switches from one SIMD
/// target to the next, so nothing else in the process may run queries. Throws `Error`: kCancelled;
/// kInvalidArgument for `threads` above 1024.
[[nodiscard]] VerifyReport verify(const VerifyOptions& options = {});

}  // namespace raysheaf
