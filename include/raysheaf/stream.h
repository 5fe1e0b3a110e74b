// Triangles that stream past the rays: scenes that are larger than memory (docs/stream.md).
//
//   blocks of a source ─► read ─► culled as a whole ─► tested with the remaining rays ─► released
//                                      ▲
//               rays, their hits and the hierarchy over them stay in memory
//
// The answer to a ray is its least (t, geom_id, inst_id, prim_id). It depends neither on the order
// of the blocks nor on how the triangles were cut into them: the bits are those of the scene in
// memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raysheaf/context.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The most triangles and vertices of a block.
inline constexpr std::uint32_t kBlockTriangles = 65536, kBlockVertices = 65536;

/// The properties of a block that are known before it is read.
struct BlockInfo {
  Box bounds;  ///< contains every vertex, in world space; empty without vertices
  std::uint32_t triangles = 0;
  std::uint64_t geometry_bytes = 0, shading_bytes = 0;  ///< bytes to read
};

/// The triangles [first, first + count) of a block belong to one instance of one mesh.
struct BlockPart {
  std::uint32_t geom_id = 0, inst_id = 0;
  std::uint32_t first = 0, count = 0;
};

/// The geometry of a block. Triangles are sorted by (geom_id, inst_id, prim_id) without duplicates,
/// so that their positions in the block decide between equal hits as their ids do.
struct TriangleBlock {
  std::vector<Vec3> positions;  ///< in world space
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> prim_ids;  ///< one for each triangle
  std::vector<BlockPart> parts;         ///< ascending, without gaps, none empty
  std::vector<std::uint8_t> sides;      ///< `TriangleFlag`, one for each triangle, or one for all
};

/// Shading data of a block, read only for blocks that contain hits.
struct BlockShading {
  /// One for each vertex, in its instance's local space; or none.
  std::vector<Vec3> normals;
  std::vector<Vec2> uvs;                 ///< one for each vertex; or none
  std::vector<Vec3> colors;              ///< one for each vertex, as `Mesh::colors`; or none
  std::vector<std::uint32_t> materials;  ///< one for each triangle; or one for all
  std::vector<std::uint8_t> has_normals, has_uvs;  ///< 0 or 1, one for each part
  /// 0 or 1, one for each part; empty if no part has colours.
  std::vector<std::uint8_t> has_colors;
  /// One for each vertex, in addition to `uvs`; or none.
  std::vector<Vec2> second_uvs;
  /// As `has_colors`; only for parts that have `uvs`.
  std::vector<std::uint8_t> has_second_uvs;
};

/// Yields blocks of triangles one at a time, in any order and repeatedly. Several threads call
/// `read` and `read_shading` at the same time, each with its own result to fill; a result may hold
/// data of earlier reads, so that its memory is reused. An `Error` that they throw ends the query
/// and names the block. All data are validated: indices, order, bounds.
class GeometrySource {
 public:
  GeometrySource() = default;
  GeometrySource(const GeometrySource&) = delete;
  GeometrySource& operator=(const GeometrySource&) = delete;
  virtual ~GeometrySource() = default;

  /// Every call must return the same blocks.
  [[nodiscard]] virtual std::span<const BlockInfo> blocks() const = 0;
  virtual void read(std::size_t block, TriangleBlock* out) const = 0;
  /// Only `render` calls it.
  virtual void read_shading(std::size_t block, BlockShading* out) const = 0;
  /// The scene without triangles: instances, materials, textures, images, lights, cameras, and
  /// meshes without vertices and triangles. Only `render` calls it.
  [[nodiscard]] virtual const SceneDescription& scene() const = 0;
  /// The place of errors: "hall.rsb: block 17".
  [[nodiscard]] virtual std::string place(std::size_t block) const {
    return "block " + std::to_string(block);
  }
};

/// Throw `Error` (kInvalidData) naming the first field that violates the rules above.
void validate(const TriangleBlock& block);
void validate(const TriangleBlock& block, const BlockShading& shading);
/// The box of all vertices.
[[nodiscard]] Box bounds_of(const TriangleBlock& block);
/// As `validate` of a scene (raysheaf/scene_description.h), except for triangles.
void validate_but_triangles(const SceneDescription& scene);

/// Receives blocks as they are made.
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

/// The blocks of another source in a different scene: other cameras, lights, another environment.
/// Instances, meshes, materials, textures and images must be those of the source's scene.
class BlocksInScene : public GeometrySource {
 public:
  /// Both must outlive this object.
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

/// The box of all blocks; empty without blocks.
[[nodiscard]] Box world_bounds(const GeometrySource& source);

/// Removes `Material::alpha_cutoff` and `alpha_blend` from a scene, with a warning if this is
/// visible: streamed triangles are opaque.
void make_whole(SceneDescription* scene);

/// Cuts a scene's triangles, transformed to world space, into blocks of neighbours: it halves them
/// along the longest side until each part fits into `triangles_a_block` (1 to `kBlockTriangles`).
/// Meshes without triangles make no block. Returns the scene without its vertices and triangles,
/// after `make_whole`, with a camera and a light added if it has none. The blocks are the same
/// every time. Memory in addition to the scene: 20 bytes per triangle. O(M log(M / B)) for M
/// triangles and B per block. Throws `Error` as `render`.
[[nodiscard]] SceneDescription cut_into_blocks(const SceneDescription& scene, BlockSink* sink,
                                               std::uint32_t triangles_a_block = kBlockTriangles);

/// The hit of a ray, and its triangle. Hits of several processes combine in any order.
struct StreamHit {
  Hit hit;
  std::uint32_t block = kInvalidId;
  std::uint32_t part = 0, triangle = 0;   ///< in the block
  std::array<std::uint32_t, 3> vertex{};  ///< its corners in the block
  std::array<Vec3, 3> corner{};           ///< in world space
};

/// Whether `a` comes before `b` in the order (t, geom_id, inst_id, prim_id).
[[nodiscard]] bool precedes(const Hit& a, const Hit& b);

/// Combines the hits of several processes that each stream a part of the blocks past the same rays
/// (`StreamOptions`). Every process calls it when its own blocks are done: once for each batch, and
/// once more for the surfaces of hits.
class HitExchange {
 public:
  HitExchange() = default;
  HitExchange(const HitExchange&) = delete;
  HitExchange& operator=(const HitExchange&) = delete;
  virtual ~HitExchange() = default;
  /// Replaces the hits of this process by the least of all processes.
  virtual void closest(std::span<StreamHit> hits) = 0;
  /// Replaces bytes by the bitwise or of all processes: whether rays hit anything, and data that
  /// only one process knows while the others have zeros.
  virtual void unite(std::span<std::uint8_t> bytes) = 0;
  /// Replaces counts and times by the sums of all processes; by default each process keeps its own.
  virtual void add(std::span<std::uint64_t> /*counts*/) {}
  virtual void add(std::span<double> /*sums*/) {}
  virtual void add(std::span<float> /*sums*/) {}
};

class StreamCheckpoint;  // raysheaf/block_file.h

/// Counts of blocks that were read or culled, and times, summed over the batches of a frame. Counts
/// are the same with any number of threads.
struct StreamStatistics {
  std::uint64_t blocks = 0;          ///< of the source, counted for each batch
  std::uint64_t culled_blocks = 0;   ///< outside the bounding volumes of all rays: never read
  std::uint64_t hidden_blocks = 0;   ///< behind the hits known when their turn came: never read
  std::uint64_t read_blocks = 0;     ///< read for their triangles
  std::uint64_t wasted_blocks = 0;   ///< among them: hidden by hits found in the meantime
  std::uint64_t shading_blocks = 0;  ///< read for the surfaces of hits
  std::uint64_t read_bytes = 0;      ///< of both kinds of reads
  double read_ms = 0;  ///< work of the reading threads: reading, checks, decompression
  double wait_ms = 0;  ///< time that tracing waited for them
  // On a device these are times of its clock, in parallel to reading and copying.
  double cull_ms = 0;   ///< bounding volumes of rays, and tests of blocks with them
  double trace_ms = 0;  ///< tests of blocks with their rays
  double shading_ms = 0;
};

struct StreamOptions {
  /// The memory limit of a query or a frame: at least 64 MiB, and as much as its image needs
  /// (docs/stream.md). On a device it also limits the device's memory; if not all rays fit, the
  /// blocks stream once for each part of them.
  std::uint64_t memory_bytes = std::uint64_t{2} << 30;
  /// The device that traces, and the threads of all other work; it must outlive the call. On
  /// Device::kCuda rays, the tree over them and their hits stay on the device (docs/cuda.md). Null:
  /// the CPU, with `threads` threads (for a frame: `RenderOptions::threads`).
  const Context* context = nullptr;
  std::uint32_t threads = 0;  ///< of `closest_hit` and `any_hit`; 0: all cores
  bool check = true;          ///< for `closest_hit` and `any_hit`: validate rays (raysheaf/query.h)
  bool front_to_back = true;  ///< blocks near the rays' origins first; false: in their order
  /// This process streams the blocks b with b % parts == part; `exchange` combines the hits.
  std::uint32_t part = 0, parts = 1;
  HitExchange* exchange = nullptr;
  /// Continues an earlier run where it was stopped; counts are then those of this run.
  StreamCheckpoint* checkpoint = nullptr;
  StreamStatistics* statistics = nullptr;  ///< added to unless null
  /// Called repeatedly, with bytes as items; false requests to stop (`Error` kCancelled). `render`
  /// has its own.
  std::function<bool(const Progress&)> progress;
};

/// As the functions of the same names for a `Scene` (raysheaf/query.h): hits[i] is that of rays[i]
/// with the least (t, geom_id, inst_id, prim_id); occluded[i] is 1 if rays[i] hits anything. Spans
/// of equal length. Throw `Error` as they do, kInvalidData for an invalid block, kOutOfMemory if
/// `memory_bytes` or a device's memory is too small, and the errors of the source.
void closest_hit(const GeometrySource& source, std::span<const Ray> rays, std::span<Hit> hits,
                 const StreamOptions& options = {});
void any_hit(const GeometrySource& source, std::span<const Ray> rays,
             std::span<std::uint8_t> occluded, const StreamOptions& options = {});

}  // namespace raysheaf
