// One scene in one mode: finds the best way of each peer, then alternates between all sides.
#pragma once

#include <memory>
#include <vector>

#include "lab/commands/compare/compare.h"
#include "lab/commands/compare/frames.h"
#include "raysheaf/context.h"

namespace raysheaf::app {

struct CompareSetting {
  Context context;
  std::vector<PeerDevice*> peers;  ///< at least one
  std::uint32_t runs = 9;
};

class CompareBench {
 public:
  /// Tries the ways of each peer for each of `kinds`. All referenced objects must outlive this one.
  CompareBench(const CompareSetting& setting, const CompareFrames& frames, CompareMode mode,
               const std::vector<CompareKind>& kinds);
  ~CompareBench();
  CompareBench(const CompareBench&) = delete;
  CompareBench& operator=(const CompareBench&) = delete;

  /// Measures one of the kinds. Fills everything except the scene's name and the size of its image.
  [[nodiscard]] CompareCase measure(CompareKind kind);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Compares hits for the same rays; `slack` is an allowed difference in length, whatever the
/// distance is.
[[nodiscard]] HitCheck compare_hits(std::span<const Ray> rays, std::span<const Hit> ours,
                                    std::span<const Hit> theirs, float slack);
[[nodiscard]] HitCheck compare_flags(std::span<const std::uint8_t> ours,
                                     std::span<const std::uint8_t> theirs);

/// Decides rays that differ by exact arithmetic, as many as twenty million tests allow.
void settle_hits(std::span<const MeshView> meshes, std::span<const Ray> rays,
                 std::span<const Hit> ours, std::span<const Hit> theirs, float slack,
                 HitCheck* check);
void settle_flags(std::span<const MeshView> meshes, std::span<const Ray> rays,
                  std::span<const std::uint8_t> ours, std::span<const std::uint8_t> theirs,
                  HitCheck* check);

}  // namespace raysheaf::app
