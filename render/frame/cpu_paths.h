// The stages of a frame that follow paths on the CPU, for every method and every storage of the
// triangles.
#pragma once

#include <memory>
#include <vector>

#include "exec/stopwatch.h"
#include "render/device/shared_groups.h"
#include "render/frame/frame.h"
#include "render/picture/film.h"
#include "render/rays/raygen.h"

namespace raysheaf {

/// Shared data of the objects that follow groups of one frame, possibly in parallel: each group has
/// pixels of its own.
struct CpuFrame {
  CpuFrame(const FrameInput& input, FrameTally* tally_of_all)
      : lights(input.lights),
        environment(input.environment),
        options(input.options),
        tally(*tally_of_all),
        film(options.width, options.height, options.count_pixel_tests) {
    if (input.geometry.is_shared()) sharing = SharedGroups::among(input.ranks, options);
  }

  const View<const PlacedLight> lights;
  const EnvironmentView* const environment;
  const RenderOptions& options;
  FrameTally& tally;
  Film film;
  SampleOf sample;
  std::vector<Fragments> kept;  ///< the primary hits of each of the sample's groups, or empty
  std::unique_ptr<SharedGroups> sharing;  ///< with other processes; null: this is the only one
};

class CpuPaths : public PathStages {
 public:
  /// All must outlive this object. `tally`: the frame's, or one that only this object uses
  /// meanwhile. `keys`: whether the method orders rays by keys.
  CpuPaths(const Executor& executor, PathGeometry& geometry, CpuFrame& frame, Keys keys,
           FrameTally* tally, ProgressMeter* meter)
      : executor_(executor),
        geometry_(geometry),
        frame_(frame),
        keys_(keys),
        tally_(*tally),
        meter_(*meter) {}

  Set see(std::size_t group) override;
  void glow(FragmentSet& set, const GlowInput& input) override;
  std::uint32_t add_lights(FragmentSet& set, std::uint32_t bounce, std::uint32_t first) override;
  void add_environment(FragmentSet& set, std::uint32_t bounce) override;
  void deposit(const FragmentSet& set) override;
  Set follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) override;
  Set merged(Set a, Set b) override;
  Set split_off(FragmentSet& set, std::size_t first) override;

  /// Writes a group's contributions to the automatic sky (render/shade/shade.h) to their places in
  /// the image's `parts`. `keep`: stores the group's primary hits.
  void find_sky(std::size_t group, bool keep, View<SkyPart> parts);

 private:
  /// For each slot of a batch of shadow rays.
  using Visibilities = std::vector<Visibility>;

  [[nodiscard]] Fragments first_hits(std::size_t group);
  [[nodiscard]] FrameStatistics& statistics() { return tally_.statistics; }
  /// Sets the fields of the batch that its geometry needs.
  void tell_of(std::uint32_t bounce, RayBatch* batch) const;
  /// `per_fragment`: number of slots of the batch per fragment.
  [[nodiscard]] Visibilities cast_shadows(const Fragments& fragments, std::uint32_t bounce,
                                          std::size_t per_fragment, RayBatch batch);
  /// Counts the lights that each pixel faces, and how many of those reach it.
  void tally_shadows(const Fragments& first_hits, std::uint32_t light_count,
                     const Visibilities& visibility);
  /// A count for each ray, if pixels' tests are requested.
  [[nodiscard]] std::vector<float> room_for_tests(const RayBatch& batch);
  void add_tests(const RayBatch& batch, const Fragments& fragments,
                 const std::vector<float>& tests);

  const Executor& executor_;
  PathGeometry& geometry_;
  CpuFrame& frame_;
  const Keys keys_;
  FrameTally& tally_;
  ProgressMeter& meter_;
  std::size_t group_ = 0;  ///< the last group of `see`
  Stopwatch watch_;
};

}  // namespace raysheaf
