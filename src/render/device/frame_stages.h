// The stages of a frame, on whichever machine its fragments lie: what render/frame/frame.h loops
// over.
//
//   see ─► glow ─► add_lights ─► deposit ─► follow ─► glow ─► ...      a set of fragments a bounce
//
// render/frame/cpu_stages.h has them on the CPU, whatever the method and wherever the triangles
// are; `DeviceStages` on a device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "device/device_queries.h"
#include "exec/progress_meter.h"
#include "methods/packets/packet_tracer.h"
#include "methods/ray_hierarchy/pair_tracer.h"
#include "rays/camera_body.h"
#include "raysheaf/distributed.h"
#include "raysheaf/render.h"
#include "render/raster/slot_picture.h"
#include "render/shade/shade.h"
#include "scene/flat_scene.h"
#include "scene/flat_update.h"
#include "surface/environment_body.h"
#include "surface/texture.h"

namespace raysheaf {

class Rasterizer;

/// What the stages of a frame count, and how long they take.
class FrameTally {
 public:
  explicit FrameTally(std::uint64_t triangles) : triangles_(triangles) {}
  /// One of the same scene that has counted nothing.
  [[nodiscard]] FrameTally fresh() const { return FrameTally(triangles_); }

  /// Of all rays of a kind at a bounce; made where there are none yet. By bounces, then by kinds.
  [[nodiscard]] BatchStatistics& batch(RayKind kind, std::uint32_t bounce);
  /// Groups of the frame's first hits have numbers, from the first sample's on. Of each batch stays
  /// what the first with such rays says of its plan; after each group.
  void keep_plans(std::size_t group);
  /// Whether what the group says would stay.
  [[nodiscard]] bool wants_plan(RayKind kind, std::uint32_t bounce, std::size_t group) const;
  /// A sentence about all batches: the first says it.
  void tell_first(std::string sentence);
  /// Adds what another has, and leaves it nothing; of times `time_part`, where threads took them
  /// side by side.
  void take(FrameTally* other, double time_part);

  FrameStatistics statistics;

 private:
  struct KeptPlan {
    std::size_t sentences = 0;  ///< 0: nothing is said yet
    std::size_t group = static_cast<std::size_t>(-1);
  };
  [[nodiscard]] std::size_t place_of(RayKind kind, std::uint32_t bounce) const;

  std::uint64_t triangles_;
  std::vector<KeptPlan> kept_plans_;  ///< of each batch
};

/// Tests of a batch as a row of numbers, which stand at the same places in every process.
[[nodiscard]] std::vector<std::uint64_t> numbers_of(const BatchStatistics& batch);
void set_numbers(const std::uint64_t* numbers, BatchStatistics* batch);
[[nodiscard]] std::size_t number_count();

/// Where rays ended, and the light that leaves there: sorted by pixel.
class FragmentSet {
 public:
  FragmentSet() = default;
  FragmentSet(const FragmentSet&) = delete;
  FragmentSet& operator=(const FragmentSet&) = delete;
  virtual ~FragmentSet() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
};

/// What the samples of a frame add up to, a pixel each: `result` without what only the whole frame
/// knows, and the lights that the first hits face and those of them that arrive.
struct FilmSums {
  RenderResult result;
  std::vector<std::uint32_t> faced, arrived;
};

struct GlowInput {
  Vec3 sky;
  TracedParts traced;
  bool last = false;  ///< nothing goes on from here
};

/// What follows the paths of one frame; its sets are its own. Times and counts go to a
/// `FrameTally`. Not for use by two threads at once.
class PathStages {
 public:
  using Set = std::unique_ptr<FragmentSet>;

  PathStages() = default;
  PathStages(const PathStages&) = delete;
  PathStages& operator=(const PathStages&) = delete;
  virtual ~PathStages() = default;

  /// The fragments of a group, one a pixel, and into the film. Each once.
  [[nodiscard]] virtual Set see(std::size_t group) = 0;
  /// The set's light begins: emission and the sky's.
  virtual void glow(FragmentSet& set, const GlowInput& input) = 0;
  /// Shadow rays to as many of the scene's lights from `first` on as are looked at together, and
  /// what arrives; returns how many.
  [[nodiscard]] virtual std::uint32_t add_lights(FragmentSet& set, std::uint32_t bounce,
                                                 std::uint32_t first) = 0;
  /// The same of the environment, where there is one.
  virtual void add_environment(FragmentSet& set, std::uint32_t bounce) = 0;
  /// The set's light, into the pixels.
  virtual void deposit(const FragmentSet& set) = 0;
  /// What the reflections or the refractions of a set meet; null where it sends none.
  [[nodiscard]] virtual Set follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) = 0;
  /// Both, the first's before the second's of the same pixel.
  [[nodiscard]] virtual Set merged(Set a, Set b) = 0;
  /// Takes all from number `first` on out of the set. Before its light begins.
  [[nodiscard]] virtual Set split_off(FragmentSet& set, std::size_t first) = 0;
};

/// Follows the paths of a group of first hits to their ends.
using FollowGroup = std::function<void(PathStages& paths, ProgressMeter& meter, std::size_t group)>;

/// Of one frame. Not for use by two threads at once.
class FrameStages {
 public:
  FrameStages() = default;
  FrameStages(const FrameStages&) = delete;
  FrameStages& operator=(const FrameStages&) = delete;
  virtual ~FrameStages() = default;

  /// Primary visibility of a sample; returns in how many groups, rows from the top, its fragments
  /// are followed.
  [[nodiscard]] virtual std::size_t look(const CameraFrame& frame) = 0;
  /// `sky_of_parts` (render/shade/shade.h) of the sample, which has lights. Before the first is
  /// seen.
  [[nodiscard]] virtual Vec3 find_sky() = 0;
  /// Calls `follow` once for each of the sample's groups; from several threads at once where the
  /// stages are so made, each time with stages and a meter that nobody else uses meanwhile.
  virtual void follow_groups(std::size_t count, const FollowGroup& follow) = 0;
  /// `taken`: nothing is added any more.
  [[nodiscard]] virtual FilmSums film(bool taken) = 0;
};

/// The triangle that each pixel sees by OpenGL, rows from the top, silhouettes not resolved yet;
/// nothing where `device` took it (render/raster/rasterizer.h).
using Rasterize =
    std::function<std::vector<std::uint32_t>(const CameraFrame& frame, SlotDevice* device)>;

/// What a device's frame is made of; all outlive it.
struct DeviceFrameInput {
  const Executor& executor;  ///< of the host
  const RenderOptions& options;
  View<const PlacedLight> lights;
  FrameTally& tally;
  ProgressMeter& meter;
  Rasterize rasterize;              ///< none: the first hits are found by rays
  PairTracer* pairs = nullptr;      ///< of this scene, of `rah` and `crsh`; null: another method
  PacketTracer* packets = nullptr;  ///< the same of `gl10`
  PairQuery pair_query;
  bool by_key = false;            ///< either sorts the rays
  bool blends = false;            ///< there are several samples a pixel
  Communicator* ranks = nullptr;  ///< who else makes the frame; null: nobody
};

/// Of a scene is copied what was forgotten; fragments, rays, hits and light stay on the device
/// until `film`.
class DeviceStages : public FrameStages, public PathStages {
 public:
  /// The scene has changed so.
  virtual void forget_scene(const FlatUpdate& update) = 0;
  /// Until the next call; `scene` is read by `film`, too.
  virtual void set_scene(const Executor& executor, const FlatScene& scene,
                         const TextureSet& textures, const EnvironmentView& environment) = 0;
  [[nodiscard]] virtual bool has_scene() const = 0;
  /// The scene's, in the device's memory.
  [[nodiscard]] virtual TriangleList triangles() const = 0;
  virtual void begin(const DeviceFrameInput& input) = 0;
};

/// The names of a triangle, or none.
[[nodiscard]] PixelIds ids_of(const FlatScene& scene, std::uint32_t triangle);

/// Adds what an engine did for a batch, or for `part` of its rays, as its plan then says; 0: for
/// all of them.
void add_engine_report(const QueryReport& report, std::size_t part, BatchStatistics* statistics);

/// Adds the tests of a hierarchy of rays; not their times.
void add_counts(const TraverseCounts& counts, BatchStatistics* statistics);
/// The same of packets.
void add_counts(const PacketCounts& counts, BatchStatistics* statistics);

}  // namespace raysheaf
