// One scene in one mode: the best way of each peer is found, then all sides alternate.
#pragma once

#include <memory>
#include <vector>

#include "compare/compare.h"
#include "compare/frames.h"
#include "raysheaf/context.h"

namespace raysheaf::app {

struct CompareSetting {
  Context context;
  std::vector<PeerDevice*> peers;  ///< at least one
  std::uint32_t runs = 9;
};

class CompareBench {
 public:
  /// Tries the ways of each peer for each of `kinds`. Everything referred to must outlive this.
  CompareBench(const CompareSetting& setting, const CompareFrames& frames, CompareMode mode,
               const std::vector<CompareKind>& kinds);
  ~CompareBench();
  CompareBench(const CompareBench&) = delete;
  CompareBench& operator=(const CompareBench&) = delete;

  /// One of the kinds. Fills everything except the scene's name and the size of its picture.
  [[nodiscard]] CompareCase measure(CompareKind kind);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Compares hits that answer the same rays; `slack` is a length that may be off whatever the
/// distance is.
[[nodiscard]] HitCheck compare_hits(std::span<const Ray> rays, std::span<const Hit> ours,
                                    std::span<const Hit> theirs, float slack);
[[nodiscard]] HitCheck compare_flags(std::span<const std::uint8_t> ours,
                                     std::span<const std::uint8_t> theirs);

/// Asks exact arithmetic about rays that differ: as many as twenty million tests allow.
void settle_hits(std::span<const MeshView> meshes, std::span<const Ray> rays,
                 std::span<const Hit> ours, std::span<const Hit> theirs, float slack,
                 HitCheck* check);
void settle_flags(std::span<const MeshView> meshes, std::span<const Ray> rays,
                  std::span<const std::uint8_t> ours, std::span<const std::uint8_t> theirs,
                  HitCheck* check);

}  // namespace raysheaf::app
