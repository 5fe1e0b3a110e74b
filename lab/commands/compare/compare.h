// Compares the library with its peers: all run in one process, alternating, with the same number of
// threads, and all their hits are compared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "lab/commands/compare/peer.h"

namespace raysheaf::app {

/// Milliseconds. `total` is measured around everything, so it is not the sum of the others.
struct OurTimes {
  double update = 0, order = 0, hierarchy = 0, trace = 0, total = 0;
};
struct PeerTimes {
  double build = 0, trace = 0, total = 0;
};

/// How the hits of one side differ from those of the other.
struct HitCheck {
  std::uint64_t compared = 0;
  std::uint64_t mismatches = 0;       ///< a different distance, or a hit on only one side
  std::uint64_t other_triangles = 0;  ///< the same distance on a different triangle: edges
  /// the library against brute force, bit for bit
  std::uint64_t sampled = 0, sample_mismatches = 0;
  std::vector<std::size_t> differing;  ///< indices of the first mismatching rays
  /// How many of the differing rays exact arithmetic decided, and for which side.
  std::uint64_t settled = 0, ours_right = 0, peer_right = 0;

  /// Embree is not watertight as the library is, and it rounds differently: one ray in 10 000 may
  /// differ. No difference from brute force is allowed.
  [[nodiscard]] bool equal() const {
    return mismatches * 10'000 <= compared && sample_mismatches == 0;
  }
};

/// The time of one version of the peer, in its fastest way.
struct PeerResult {
  std::string version;  ///< "4.4.0"
  std::string way;      ///< "LOW, intersect16 coherent"
  PeerTimes ms;
  double ratio = 0;      ///< median over the rounds of library time / peer time
  double cpu_ratio = 0;  ///< the same for the processor time of all threads
  HitCheck hits;
  std::uint64_t bytes = 0;
};

/// One kind of rays in one scene and mode. Times are medians.
struct CompareCase {
  std::string scene;
  ImageSize size;                         ///< of the image that the rays come from
  bool one_of_sizes = false;              ///< several sizes were compared
  std::uint64_t triangles = 0, rays = 0;  ///< `rays` are those of the first frame
  CompareKind kind = CompareKind::kShadow;
  CompareMode mode = CompareMode::kRebuild;
  OurTimes ours_ms;
  PeerResult peer;                ///< the fastest version, with the largest ratio
  std::vector<PeerResult> peers;  ///< every version
  /// The library's longest of sixty frames, in processor time as a multiple of their median; they
  /// follow the first frame of a new scene. 0 in mode rebuild, where it is not measured.
  double worst_frame = 0;
  std::string plan;  ///< the choices of the library in most rounds, as `short_plan` writes them
  std::uint64_t our_bytes = 0;
};

/// "2048x2048"
[[nodiscard]] std::string size_text(const ImageSize& size);

/// The scene, with the size of its image if several sizes were compared.
[[nodiscard]] std::string label_of(const CompareCase& c);

/// The choices of a plan, without the reasons: "tree built, streams, tiles".
[[nodiscard]] std::string short_plan(const std::vector<std::string>& plan);

/// One measurement of the growth.
struct GrowthCase {
  std::string along;  ///< "rays" or "triangles"
  CompareCase measured;
};

struct CompareReport {
  BenchCompareCommand command;
  std::string peer;  ///< "Embree 4.4.0 and Embree 3.13.5"
  std::uint32_t threads = 0;
  std::vector<CompareCase> cases;
  std::vector<GrowthCase> growth;
  std::vector<std::string> notes;  ///< sentences about scenes that were omitted
  std::uint64_t peak_bytes = 0;    ///< of the process: both sides, the scene and its preparation
};

/// As CSV, a line for each case (docs/bench.md).
[[nodiscard]] std::string compare_csv(const CompareReport& report);
/// A table for a terminal.
[[nodiscard]] std::string compare_text(const CompareReport& report);

/// Throws `Error` as `open_peers` does.
[[nodiscard]] CompareReport measure_compare(const BenchCompareCommand& command, const Tell& tell);

}  // namespace raysheaf::app
