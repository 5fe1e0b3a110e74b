// The stages of a frame, on the machine that holds its fragments: the operations that
// render/frame/frame.h calls.
//
//   see ─► glow ─► add_lights ─► deposit ─► follow ─► glow ─► ...
//
// Each bounce has one set of fragments.
//
// render/frame/cpu_stages.h implements them on the CPU, for every method and every storage of the
// triangles; `DeviceStages` implements them on a device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "exec/progress_meter.h"
#include "raysheaf/distributed.h"
#include "raysheaf/render.h"
#include "raysheaf/rig.h"
#include "render/device/device_batch_tracer.h"
#include "render/raster/slot_picture.h"
#include "render/rays/camera_body.h"
#include "render/rays/scatter_body.h"
#include "render/shade/shade.h"
#include "render/surface/environment_body.h"
#include "render/surface/texture.h"
#include "scene/flat_scene.h"
#include "scene/flat_update.h"

namespace raysheaf {

class Rasterizer;

/// Counts and times of a frame's stages.
class FrameTally {
 public:
  explicit FrameTally(std::uint64_t triangles) : triangles_(triangles) {}
  /// An empty tally for the same scene.
  [[nodiscard]] FrameTally fresh() const { return FrameTally(triangles_); }

  /// The statistics of all rays of a kind at a bounce; created on first use. Sorted by bounces,
  /// then by kinds.
  [[nodiscard]] BatchStatistics& batch(RayKind kind, std::uint32_t bounce);
  /// The groups of the frame's primary hits are numbered, starting with those of the first sample.
  /// For each batch, the plan of the first group with such rays is kept; call this after each
  /// group.
  void keep_plans(std::size_t group);
  /// Whether the plan of this group would be kept.
  [[nodiscard]] bool wants_plan(RayKind kind, std::uint32_t bounce, std::size_t group) const;
  /// Adds a sentence to the plan of the first batch, about all batches.
  void tell_first(std::string sentence);
  /// Adds another tally and clears it; adds its times multiplied by `time_part`, for tallies of
  /// parallel threads.
  void take(FrameTally* other, double time_part);

  FrameStatistics statistics;

 private:
  struct KeptPlan {
    std::size_t sentences = 0;  ///< 0: no plan yet
    std::size_t group = static_cast<std::size_t>(-1);
  };
  [[nodiscard]] std::size_t place_of(RayKind kind, std::uint32_t bounce) const;

  std::uint64_t triangles_;
  std::vector<KeptPlan> kept_plans_;  ///< for each batch
};

/// The counts of a batch as a row of numbers in a fixed order, the same in every process.
[[nodiscard]] std::vector<std::uint64_t> numbers_of(const BatchStatistics& batch);
void set_numbers(const std::uint64_t* numbers, BatchStatistics* batch);
[[nodiscard]] std::size_t number_count();

/// The points where rays ended, and the light that leaves there, sorted by pixel.
class FragmentSet {
 public:
  FragmentSet() = default;
  FragmentSet(const FragmentSet&) = delete;
  FragmentSet& operator=(const FragmentSet&) = delete;
  virtual ~FragmentSet() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
};

/// Sums over the samples of a frame, for each pixel: `result` without the values that depend on the
/// whole frame, the lights that the primary hits face, and how many of these reach them.
struct FilmSums {
  RenderResult result;
  std::vector<std::uint32_t> faced, arrived;
};

/// The kinds of rays that continue paths, as bits (`bit_of`).
[[nodiscard]] inline std::uint8_t kinds_to_trace(const RenderOptions& options) {
  if (options.bounces == 0) return 0;
  return static_cast<std::uint8_t>((options.reflections ? kReflects : 0) |
                                   (options.refractions ? kRefracts : 0));
}

struct GlowInput {
  Vec3 sky;
  StudioRoom room;          ///< in reflections and refractions, in place of the sky
  bool behind = false;      ///< as in `Surroundings` (render/shade/shade.h)
  std::uint8_t traced = 0;  ///< bits (`bit_of`) of the rays that will be traced
  bool last = false;        ///< no path continues from here
};

/// Follows the paths of one frame; its sets are its own. Times and counts go to a `FrameTally`. Not
/// for two threads at once.
class PathStages {
 public:
  using Set = std::unique_ptr<FragmentSet>;

  PathStages() = default;
  PathStages(const PathStages&) = delete;
  PathStages& operator=(const PathStages&) = delete;
  virtual ~PathStages() = default;

  /// The fragments of a group, one for each pixel, which are also added to the film. Call it once
  /// for each group.
  [[nodiscard]] virtual Set see(std::size_t group) = 0;
  /// Initializes the set's light: emission and the sky's.
  virtual void glow(FragmentSet& set, const GlowInput& input) = 0;
  /// Traces shadow rays to as many of the scene's lights, from `first` on, as are processed
  /// together, and adds their light; returns their number.
  [[nodiscard]] virtual std::uint32_t add_lights(FragmentSet& set, std::uint32_t bounce,
                                                 std::uint32_t first) = 0;
  /// The same for the environment, if there is one.
  virtual void add_environment(FragmentSet& set, std::uint32_t bounce) = 0;
  /// Adds the set's light to the pixels.
  virtual void deposit(const FragmentSet& set) = 0;
  /// The hits of the reflections or refractions of a set; null if there are none.
  [[nodiscard]] virtual Set follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) = 0;
  /// The union of both, with the first set's fragments before the second's in each pixel.
  [[nodiscard]] virtual Set merged(Set a, Set b) = 0;
  /// Removes all fragments from number `first` on from the set. Must be called before `glow`.
  [[nodiscard]] virtual Set split_off(FragmentSet& set, std::size_t first) = 0;
};

/// Follows the paths of a group of primary hits to their ends.
using FollowGroup = std::function<void(PathStages& paths, ProgressMeter& meter, std::size_t group)>;

/// The stages of one frame. Not for two threads at once.
class FrameStages {
 public:
  FrameStages() = default;
  FrameStages(const FrameStages&) = delete;
  FrameStages& operator=(const FrameStages&) = delete;
  virtual ~FrameStages() = default;

  /// Primary visibility of a sample; returns the number of groups, rows from the top, in which its
  /// fragments are followed.
  [[nodiscard]] virtual std::size_t look(const CameraFrame& frame) = 0;
  /// `sky_of_parts` (render/shade/shade.h) of the sample, which must have lights. Called before the
  /// first `see`.
  [[nodiscard]] virtual Vec3 find_sky() = 0;
  /// Calls `follow` once for each of the sample's groups. Stages that support it call from several
  /// threads at once, each with its own stages and meter.
  virtual void follow_groups(std::size_t count, const FollowGroup& follow) = 0;
  /// `taken`: nothing will be added any more.
  [[nodiscard]] virtual FilmSums film(bool taken) = 0;
};

/// The triangle that each pixel sees by OpenGL, rows from the top, silhouettes not resolved yet;
/// nothing where `device` took it (render/raster/rasterizer.h). `gbuffer`: the paper's targets are
/// drawn; takes them, unless the device did. Null: they are not.
using Rasterize = std::function<std::vector<std::uint32_t>(const CameraFrame& frame,
                                                           SlotDevice* device, Gbuffer* gbuffer)>;

/// The input of a device's frame; everything must outlive it.
struct DeviceFrameInput {
  const Executor& executor;  ///< of the host
  const RenderOptions& options;
  View<const PlacedLight> lights;
  FrameTally& tally;
  ProgressMeter& meter;
  Rasterize rasterize;  ///< empty: primary rays are traced
  MethodSettings method;
  DeviceBatchTracer* ordered = nullptr;  ///< of this scene; null: the method does not order rays
  bool blends = false;                   ///< there are several samples per pixel
  Communicator* ranks = nullptr;  ///< the processes that share the frame; null: this is the only
                                  ///< one
};

/// Copies only outdated parts of the scene; fragments, rays, hits and light stay on the device
/// until `film`.
class DeviceStages : public FrameStages, public PathStages {
 public:
  /// Marks the changed parts of the scene as outdated.
  virtual void forget_scene(const FlatUpdate& update) = 0;
  /// Valid until the next call; `film` reads `scene`, too.
  virtual void set_scene(const Executor& executor, const FlatScene& scene,
                         const TextureSet& textures, const EnvironmentView& environment) = 0;
  [[nodiscard]] virtual bool has_scene() const = 0;
  /// Brings the scene, which the device has, except for the instances at `places` in
  /// `scene.meshes`, to where these stand now, and meshes to their poses: a matrix of each instance
  /// is sent, and the weights and joints of each pose; the device moves vertices and places
  /// triangles. Returns the box of all triangles; none if a vertex ends up too far out or nowhere:
  /// then there is no scene.
  [[nodiscard]] virtual std::optional<Box> place(const FlatScene& scene,
                                                 View<const std::uint32_t> places,
                                                 View<const MeshPose> poses) = 0;
  /// The spheres of meshes in the shapes that `place` has given them (`shape_bound`,
  /// scene/flat_update.h).
  [[nodiscard]] virtual std::vector<Sphere> shape_bounds(const FlatScene& scene,
                                                         View<const std::uint32_t> meshes) = 0;
  /// Whether the device draws its own triangles through OpenGL, as far as is known.
  [[nodiscard]] virtual bool draws_there() const = 0;
  /// The scene's, in the device's memory.
  [[nodiscard]] virtual TriangleList triangles() const = 0;
  virtual void begin(const DeviceFrameInput& input) = 0;
};

/// The ids of a triangle.
[[nodiscard]] PixelIds ids_of(const FlatScene& scene, TriangleAt triangle);

/// Adds an engine's report of a batch, or of `part` of its rays, which its plan then states; 0: of
/// all rays.
void add_engine_report(const QueryReport& report, std::size_t part, BatchStatistics* statistics);

}  // namespace raysheaf
