// Triangles that stream past the rays: scenes that are larger than memory (docs/stream.md).
//
//   blocks, wherever they are ─► read ─► culled whole ─► met by the rays that are left ─► forgotten
//                                            ▲
//                     rays, their hits and the hierarchy over them stay in memory
//
// The answer to a ray is its least (t, geom_id, inst_id, prim_id), so that neither the order of the
// blocks nor how the triangles were cut into them changes it: the same bits as in memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A block has no more of either.
inline constexpr std::uint32_t kBlockTriangles = 65536, kBlockVertices = 65536;

/// What is known of a block that was not read.
struct BlockInfo {
  Box bounds;  ///< holds every vertex, in the world; empty where there are none
  std::uint32_t triangles = 0;
  std::uint64_t geometry_bytes = 0, shading_bytes = 0;  ///< that reading its parts takes
};

/// The triangles [first, first + count) of a block belong to one instance of one mesh.
struct BlockPart {
  std::uint32_t geom_id = 0, inst_id = 0;
  std::uint32_t first = 0, count = 0;
};

/// Bits of `TriangleBlock::sides`.
enum BlockSide : std::uint8_t {
  kBlockSingleSided = 1,  ///< the back does not show to primary rays
  kBlockMirrored = 2,     ///< the instance mirrors: the front is clockwise
};

/// Where triangles are. Sorted by (geom_id, inst_id, prim_id), none twice, so that their places
/// break ties between hits as their ids do.
struct TriangleBlock {
  std::vector<Vec3> positions;  ///< in the world
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> prim_ids;  ///< one a triangle
  std::vector<BlockPart> parts;         ///< ascending, without gaps, none empty
  std::vector<std::uint8_t> sides;      ///< `BlockSide`, one a triangle; or one for all
};

/// What triangles look like: wanted for the blocks that own hits alone.
struct BlockShading {
  std::vector<Vec3> normals;             ///< one a vertex, in its instance's own space; or none
  std::vector<Vec2> uvs;                 ///< one a vertex; or none
  std::vector<Vec3> colors;              ///< one a vertex, as a mesh has them; or none
  std::vector<std::uint32_t> materials;  ///< one a triangle; or one for all
  std::vector<std::uint8_t> has_normals, has_uvs;  ///< 0 or 1, one a part
  std::vector<std::uint8_t> has_colors;            ///< the same; empty where no part has any
  std::vector<Vec2> second_uvs;                    ///< one a vertex, beside `uvs`; or none
  std::vector<std::uint8_t> has_second_uvs;        ///< as `has_colors`; of parts that have `uvs`
};

/// Triangle blocks that can be had one at a time, in any order and again. `read` and `read_shading`
/// are called from several threads at once, with different results to fill; these come with what
/// earlier reads left in them, so that their memory is used again. An `Error` that they throw ends
/// the query and names the block. Whatever they give is looked over: indices, order, bounds.
class GeometrySource {
 public:
  GeometrySource() = default;
  GeometrySource(const GeometrySource&) = delete;
  GeometrySource& operator=(const GeometrySource&) = delete;
  virtual ~GeometrySource() = default;

  /// The same at every call.
  [[nodiscard]] virtual std::span<const BlockInfo> blocks() const = 0;
  virtual void read(std::size_t block, TriangleBlock* out) const = 0;
  /// For `render` alone.
  virtual void read_shading(std::size_t block, BlockShading* out) const = 0;
  /// All but triangles: instances, materials, textures, images, lights, cameras. Meshes are there,
  /// without vertices and triangles. For `render` alone.
  [[nodiscard]] virtual const SceneDescription& scene() const = 0;
  /// What an error names: "hall.rsb: block 17".
  [[nodiscard]] virtual std::string place(std::size_t block) const {
    return "block " + std::to_string(block);
  }
};

/// Throw `Error` (kInvalidData) that names the first field which is not as said above.
void validate(const TriangleBlock& block);
void validate(const TriangleBlock& block, const BlockShading& shading);
/// Of every vertex.
[[nodiscard]] Box bounds_of(const TriangleBlock& block);
/// What `validate` says of a scene (raysheaf/scene_description.h), triangles or not.
void validate_but_triangles(const SceneDescription& scene);

/// Takes blocks as they are made.
class BlockSink {
 public:
  BlockSink() = default;
  BlockSink(const BlockSink&) = delete;
  BlockSink& operator=(const BlockSink&) = delete;
  virtual ~BlockSink() = default;
  virtual void add(const TriangleBlock& block, const BlockShading& shading) = 0;
};

/// Blocks in memory.
class BlockList : public GeometrySource, public BlockSink {
 public:
  void add(const TriangleBlock& block, const BlockShading& shading) override;
  void set_scene(SceneDescription scene) { scene_ = std::move(scene); }

  [[nodiscard]] std::span<const BlockInfo> blocks() const override { return infos_; }
  void read(std::size_t block, TriangleBlock* out) const override { *out = blocks_[block]; }
  void read_shading(std::size_t block, BlockShading* out) const override { *out = shading_[block]; }
  [[nodiscard]] const SceneDescription& scene() const override { return scene_; }

 private:
  std::vector<BlockInfo> infos_;
  std::vector<TriangleBlock> blocks_;
  std::vector<BlockShading> shading_;
  SceneDescription scene_;
};

/// Another source's blocks in a scene of one's own: other cameras, lights, another environment.
/// What blocks name must be what it is there: instances, meshes, materials, textures, images.
class BlocksInScene : public GeometrySource {
 public:
  /// Both outlive it.
  BlocksInScene(const GeometrySource& blocks, const SceneDescription& scene)
      : blocks_(blocks), scene_(scene) {}

  [[nodiscard]] std::span<const BlockInfo> blocks() const override { return blocks_.blocks(); }
  void read(std::size_t block, TriangleBlock* out) const override { blocks_.read(block, out); }
  void read_shading(std::size_t block, BlockShading* out) const override {
    blocks_.read_shading(block, out);
  }
  [[nodiscard]] const SceneDescription& scene() const override { return scene_; }
  [[nodiscard]] std::string place(std::size_t block) const override { return blocks_.place(block); }

 private:
  const GeometrySource& blocks_;
  const SceneDescription& scene_;
};

/// Of all blocks; empty where there are none.
[[nodiscard]] Box world_bounds(const GeometrySource& source);

/// Takes `Material::alpha_cutoff` and `alpha_blend` out of a scene, with a warning where that
/// shows: what streams is whole.
void make_whole(SceneDescription* scene);

/// Cuts a scene's triangles, placed in the world, into blocks of neighbours: halves of halves along
/// the longest side, until what is left fits into `triangles_a_block` (1 to `kBlockTriangles`).
/// Meshes without any are left out as `SceneDescription` knows them. Returns the scene without its
/// vertices and triangles, made whole, with a camera and a light added where it has none. The same
/// blocks every time. Memory beside the scene: 20 bytes a triangle. O(M log(M / B)). Throws `Error`
/// as `render`.
[[nodiscard]] SceneDescription cut_into_blocks(const SceneDescription& scene, BlockSink* sink,
                                               std::uint32_t triangles_a_block = kBlockTriangles);

/// `hall_scene` (raysheaf/builtin_scenes.h), block by block as it is generated: memory does not
/// grow with it, and there may be 2 000 000 000 triangles. Returns the scene without triangles.
[[nodiscard]] SceneDescription hall_in_blocks(std::uint64_t triangles, BlockSink* sink,
                                              std::uint32_t threads = 0);

/// The hit of a ray, and where its triangle is. Those of several machines combine in any order.
struct StreamHit {
  Hit hit;
  std::uint32_t block = kInvalidId;
  std::uint32_t part = 0, triangle = 0;   ///< in the block
  std::array<std::uint32_t, 3> vertex{};  ///< its corners in the block
  std::array<Vec3, 3> corner{};           ///< in the world
};

/// The order that the least hit is the least of.
[[nodiscard]] bool precedes(const Hit& a, const Hit& b);

/// Several processes that each stream a part of the blocks past the same rays (`StreamOptions`).
/// Called in every process when its own blocks are done: once a batch, and once more for what hits
/// look like.
class HitExchange {
 public:
  HitExchange() = default;
  HitExchange(const HitExchange&) = delete;
  HitExchange& operator=(const HitExchange&) = delete;
  virtual ~HitExchange() = default;
  /// What this process found becomes the least of all.
  virtual void closest(std::span<StreamHit> hits) = 0;
  /// Bytes become the bitwise or of all: whether rays meet anything, and what only one process
  /// knows while the others have zeros there.
  virtual void unite(std::span<std::uint8_t> bytes) = 0;
  /// Counts and times of what was done, which become those of all processes together; an exchange
  /// that does not say how leaves each with its own.
  virtual void add(std::span<std::uint64_t> /*counts*/) {}
  virtual void add(std::span<double> /*sums*/) {}
  virtual void add(std::span<float> /*sums*/) {}
};

class Context;           // raysheaf/context.h
class StreamCheckpoint;  // raysheaf/checkpoint.h

/// What was read, and what did not have to be. Adds up over the batches of a frame. The same with
/// any number of threads, but for times.
struct StreamStatistics {
  std::uint64_t blocks = 0;          ///< of the source, once a batch
  std::uint64_t culled_blocks = 0;   ///< no ray's bound met them: never read
  std::uint64_t hidden_blocks = 0;   ///< behind what had been hit when their turn came: never read
  std::uint64_t read_blocks = 0;     ///< read for their triangles
  std::uint64_t wasted_blocks = 0;   ///< of those: read, and then behind what others had hit
  std::uint64_t shading_blocks = 0;  ///< read for what hits look like
  std::uint64_t read_bytes = 0;      ///< of both
  double read_ms = 0;  ///< that the reading threads worked: reading, checks, decompression
  double wait_ms = 0;  ///< that tracing waited for them
  // On a device by its clock, while reading and copying go on.
  double cull_ms = 0;   ///< bounds of rays against blocks, and those bounds
  double trace_ms = 0;  ///< blocks against their rays
  double shading_ms = 0;
};

struct StreamOptions {
  /// What a query may take, or a frame: at least 64 MiB, and what its picture needs
  /// (docs/stream.md). As much again of a device's memory, if that has it: where not all rays fit,
  /// the blocks stream once for each part of them.
  std::uint64_t memory_bytes = std::uint64_t{2} << 30;
  /// Where rays and triangles meet, and the threads of all else; it outlives the call. On
  /// Device::kCuda rays, the tree over them and their hits stay on the device (docs/cuda.md). Null:
  /// the CPU, on `threads` of it (of a frame: `RenderOptions::threads`).
  const Context* context = nullptr;
  std::uint32_t threads = 0;  ///< of `closest_hit` and `any_hit`; 0: all cores
  bool check = true;          ///< of the same: refuse rays that are wrong (raysheaf/query.h)
  bool front_to_back = true;  ///< blocks near the rays' origins first; false: as they are numbered
  /// Blocks b with b % parts == part are streamed here; `exchange` fetches what the others found.
  std::uint32_t part = 0, parts = 1;
  HitExchange* exchange = nullptr;
  /// Where an earlier run was stopped, this one goes on; counts are then of what this one did.
  StreamCheckpoint* checkpoint = nullptr;
  StreamStatistics* statistics = nullptr;  ///< added to where it is not null
  /// Called now and then, in bytes; false asks to stop (`Error` kCancelled). `render` has its own.
  std::function<bool(const Progress&)> progress;
};

/// As the functions of the same names for a `Scene` (raysheaf/query.h): hits[i] is that of rays[i]
/// with the least (t, geom_id, inst_id, prim_id); occluded[i] is 1 where rays[i] meets anything.
/// Spans of equal length. Throw `Error` as they do, kInvalidData for a block that is not as
/// promised, kOutOfMemory where `memory_bytes` or a device's memory is too little, and what the
/// source throws.
void closest_hit(const GeometrySource& source, std::span<const Ray> rays, std::span<Hit> hits,
                 const StreamOptions& options = {});
void any_hit(const GeometrySource& source, std::span<const Ray> rays,
             std::span<std::uint8_t> occluded, const StreamOptions& options = {});

/// The frame that `render` gives of the whole scene with `Primary::kTrace`, the same bits but for
/// `tests`. Takes `Method::kDual` and `Primary::kTrace` alone (`Error` kUnsupported). Throws
/// `Error` as `render` and as the queries above.
[[nodiscard]] RenderResult render(const GeometrySource& source, const RenderOptions& options,
                                  const StreamOptions& stream = {});

}  // namespace raysheaf
