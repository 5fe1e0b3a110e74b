// Cuts a scene in memory into blocks of neighbouring triangles.
#include <algorithm>
#include <numeric>
#include <span>
#include <string>

#include "base/mirrors_body.h"
#include "base/vec.h"
#include "raysheaf/error.h"
#include "raysheaf/stream.h"
#include "raysheaf/studio.h"
#include "scene/cutout.h"
#include "scene/flat_scene.h"
#include "scene/material_of.h"
#include "scene/shown_name.h"

namespace raysheaf {
namespace {

/// A triangle that is being moved into a block. `rank`: of its instance in the order (geom_id,
/// inst_id).
struct Loose {
  Vec3 center;  ///< times three
  std::uint32_t rank = 0, prim_id = 0;
};
static_assert(sizeof(Loose) == 20);

bool by_ids(const Loose& a, const Loose& b) {
  return a.rank != b.rank ? a.rank < b.rank : a.prim_id < b.prim_id;
}

std::vector<std::uint32_t> instances_by_rank(const SceneDescription& scene) {
  std::vector<std::uint32_t> order(scene.instances.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return scene.instances[a].mesh < scene.instances[b].mesh;
  });
  return order;
}

/// Moves the triangles with the smaller centres, on the axis of their largest extent, to the first
/// `left` places.
void halve(std::span<Loose> triangles, std::size_t left) {
  Box box;
  for (const Loose& t : triangles) {
    box.min = min(box.min, t.center);
    box.max = max(box.max, t.center);
  }
  const Vec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(left),
                   triangles.end(), [axis](const Loose& a, const Loose& b) {
                     const float x = component(a.center, axis), y = component(b.center, axis);
                     return x != y ? x < y : by_ids(a, b);
                   });
}

class Cutter {
 public:
  Cutter(const SceneDescription& scene, BlockSink* sink, std::size_t most)
      : scene_(scene), sink_(*sink), most_(most), ranks_(instances_by_rank(scene)) {}

  void run() {
    std::vector<Loose> all = loosened();
    cut(all);
  }

 private:
  [[nodiscard]] const Instance& instance(std::uint32_t rank) const {
    return scene_.instances[ranks_[rank]];
  }
  [[nodiscard]] const Mesh& mesh(std::uint32_t rank) const {
    return scene_.meshes[instance(rank).mesh];
  }
  [[nodiscard]] Vec3 placed(std::uint32_t rank, std::uint32_t vertex) const {
    return transform_point(instance(rank).to_world, mesh(rank).positions[vertex]);
  }

  [[nodiscard]] std::vector<Loose> loosened() const {
    std::vector<Loose> all;
    all.reserve(scene_.triangle_count());
    for (std::uint32_t rank = 0; rank < ranks_.size(); ++rank) {
      const Mesh& from = mesh(rank);
      for (std::uint32_t i = 0; i < from.triangles.size(); ++i) {
        const auto& corner = from.triangles[i];
        const Vec3 a = placed(rank, corner[0]), b = placed(rank, corner[1]),
                   c = placed(rank, corner[2]);
        if (!(max_component(max(max(abs(a), abs(b)), abs(c))) <= kLargestCoordinate)) refuse(rank);
        all.push_back({a + b + c, rank, i});
      }
    }
    return all;
  }

  [[noreturn]] void refuse(std::uint32_t rank) const {
    throw Error(ErrorCode::kInvalidData,
                "the transform" + of_name(instance(rank).name) + " puts a vertex of meshes[" +
                    std::to_string(instance(rank).mesh) + "] farther out than 1e18",
                "instances[" + std::to_string(ranks_[rank]) + "].to_world");
  }

  void cut(std::span<Loose> triangles) {
    const std::size_t pieces = (triangles.size() + most_ - 1) / most_;
    if (pieces == 0) return;
    if (pieces == 1) return emit(triangles);
    split(triangles, triangles.size() * (pieces / 2) / pieces);
  }

  void split(std::span<Loose> triangles, std::size_t left) {
    halve(triangles, left);
    cut(triangles.first(left));
    cut(triangles.subspan(left));
  }

  void emit(std::span<Loose> triangles) {
    std::sort(triangles.begin(), triangles.end(), by_ids);
    collect_vertices(triangles);
    if (vertices_.size() > kBlockVertices) return split(triangles, triangles.size() / 2);
    block_.triangles.clear();
    block_.prim_ids.clear();
    block_.parts.clear();
    block_.sides.clear();
    shading_.materials.clear();
    for (const Loose& t : triangles) add(t);
    add_vertices();
    shrink(&block_.sides);
    shrink(&shading_.materials);
    sink_.add(block_, shading_);
  }

  /// Collects each vertex that the triangles use, once: its instance's rank and its number,
  /// ascending.
  void collect_vertices(std::span<const Loose> triangles) {
    vertices_.clear();
    for (const Loose& t : triangles) {
      for (const std::uint32_t v : mesh(t.rank).triangles[t.prim_id])
        vertices_.push_back(key(t, v));
    }
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  }

  static std::uint64_t key(const Loose& t, std::uint32_t vertex) {
    return std::uint64_t{t.rank} << 32 | vertex;
  }

  void add(const Loose& t) {
    const auto place = static_cast<std::uint32_t>(block_.triangles.size());
    if (block_.parts.empty() || block_.parts.back().inst_id != ranks_[t.rank])
      block_.parts.push_back({instance(t.rank).mesh, ranks_[t.rank], place, 0});
    ++block_.parts.back().count;
    block_.prim_ids.push_back(t.prim_id);
    auto& corners = block_.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t wanted = key(t, mesh(t.rank).triangles[t.prim_id][k]);
      corners[k] = static_cast<std::uint32_t>(
          std::lower_bound(vertices_.begin(), vertices_.end(), wanted) - vertices_.begin());
    }
    const std::uint32_t material = material_of(mesh(t.rank), t.prim_id);
    shading_.materials.push_back(material);
    const bool one_side = !material_or_default(scene_, material).double_sided;
    block_.sides.push_back(static_cast<std::uint8_t>(
        (one_side ? kSingleSided : 0) | (mirrors(instance(t.rank).to_world) ? kMirrored : 0)));
  }

  void add_vertices() {
    block_.positions.resize(vertices_.size());
    shading_.has_normals.clear();
    shading_.has_uvs.clear();
    shading_.has_colors.clear();
    shading_.has_second_uvs.clear();
    for (const BlockPart& part : block_.parts) {
      shading_.has_normals.push_back(scene_.meshes[part.geom_id].normals.empty() ? 0 : 1);
      shading_.has_uvs.push_back(scene_.meshes[part.geom_id].uvs.empty() ? 0 : 1);
      shading_.has_colors.push_back(scene_.meshes[part.geom_id].colors.empty() ? 0 : 1);
      shading_.has_second_uvs.push_back(scene_.meshes[part.geom_id].second_uvs.empty() ? 0 : 1);
    }
    const auto any = [](const std::vector<std::uint8_t>& column) {
      return std::find(column.begin(), column.end(), 1) != column.end();
    };
    shading_.normals.assign(any(shading_.has_normals) ? vertices_.size() : 0, Vec3{});
    shading_.uvs.assign(any(shading_.has_uvs) ? vertices_.size() : 0, Vec2{});
    shading_.colors.assign(any(shading_.has_colors) ? vertices_.size() : 0, Vec3{});
    shading_.second_uvs.assign(any(shading_.has_second_uvs) ? vertices_.size() : 0, Vec2{});
    if (shading_.colors.empty()) shading_.has_colors.clear();
    if (shading_.second_uvs.empty()) shading_.has_second_uvs.clear();
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const auto rank = static_cast<std::uint32_t>(vertices_[i] >> 32);
      const auto vertex = static_cast<std::uint32_t>(vertices_[i]);
      const Mesh& from = mesh(rank);
      block_.positions[i] = placed(rank, vertex);
      if (!from.normals.empty()) shading_.normals[i] = from.normals[vertex];
      if (!from.uvs.empty()) shading_.uvs[i] = from.uvs[vertex];
      if (!from.colors.empty()) shading_.colors[i] = from.colors[vertex];
      if (!from.second_uvs.empty()) shading_.second_uvs[i] = from.second_uvs[vertex];
    }
  }

  /// Replaces equal values by one for all.
  template <class T>
  static void shrink(std::vector<T>* column) {
    const T first = column->front();
    if (std::all_of(column->begin(), column->end(), [first](T x) { return x == first; }))
      column->resize(1);
  }

  const SceneDescription& scene_;
  BlockSink& sink_;
  const std::size_t most_;
  const std::vector<std::uint32_t> ranks_;  ///< instances, by rank
  std::vector<std::uint64_t> vertices_;     ///< of the current block
  TriangleBlock block_;
  BlockShading shading_;
};

void show_whole(SceneDescription* scene) {
  const char* const sentence =
      "Streamed triangles are opaque: holes and blending by alpha are not shown.";
  std::vector<std::string>& all = scene->warnings;
  if (std::find(all.begin(), all.end(), sentence) == all.end()) all.emplace_back(sentence);
  for (Material& material : scene->materials) {
    material.alpha_cutoff = 0;
    material.alpha_blend = false;
  }
}

SceneDescription without_triangles(const SceneDescription& scene) {
  SceneDescription rest;
  rest.name = scene.name;
  rest.instances = scene.instances;
  rest.materials = scene.materials;
  rest.textures = scene.textures;
  rest.images = scene.images;
  rest.lights = scene.lights;
  rest.cameras = scene.cameras;
  rest.environment = scene.environment;
  rest.warnings = scene.warnings;
  rest.files = scene.files;
  if (has_cutouts(scene, true)) show_whole(&rest);
  for (const Mesh& mesh : scene.meshes) rest.meshes.emplace_back().name = mesh.name;
  return rest;
}

}  // namespace

void make_whole(SceneDescription* scene) {
  if (has_cutouts(*scene, true)) show_whole(scene);
}

SceneDescription cut_into_blocks(const SceneDescription& scene, BlockSink* sink,
                                 std::uint32_t triangles_a_block) {
  if (triangles_a_block < 1 || triangles_a_block > kBlockTriangles)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 1 to " + std::to_string(kBlockTriangles) + ", not " +
                    std::to_string(triangles_a_block),
                "triangles_a_block");
  validate(scene);
  Cutter(scene, sink, triangles_a_block).run();
  SceneDescription rest = without_triangles(scene);
  if (rest.cameras.empty()) rest.cameras.push_back(framing_camera(scene));
  if (needs_light(rest)) rest.lights = studio_lights(scene, rest.cameras.front());
  return rest;
}

}  // namespace raysheaf
