#include "io/outer_cut.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "io/float_spacing.h"
#include "io/linear.h"
#include "raysheaf/error.h"
#include "raysheaf/studio.h"

namespace raysheaf::io {
namespace {

constexpr std::uint32_t kDigitBits = 16;

/// A triangle to be put into a block. `number` counts the triangles of all instances, sorted by
/// their meshes.
struct OuterTriangle {
  Vec3 center;  ///< three times the centre
  std::uint32_t number = 0;
};
static_assert(sizeof(OuterTriangle) == 16);

/// Transforms a point exactly as the library does.
Vec3 placed(const Affine& a, Vec3 p) {
  const auto row = [p](const std::array<float, 4>& m) {
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  };
  return {row(a.m[0]), row(a.m[1]), row(a.m[2])};
}

Vec3 sum_of(Vec3 a, Vec3 b, Vec3 c) {
  return {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z};
}

void enlarge_box(Box* box, Vec3 p) {
  box->min = {std::min(box->min.x, p.x), std::min(box->min.y, p.y), std::min(box->min.z, p.z)};
  box->max = {std::max(box->max.x, p.x), std::max(box->max.y, p.y), std::max(box->max.z, p.z)};
}

/// The axis along which centres are farthest apart.
int longest_axis(const Box& box) {
  const float x = box.max.x - box.min.x, y = box.max.y - box.min.y, z = box.max.z - box.min.z;
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Floats as integers with the same order; -0 equals 0.
std::uint32_t order_word(float x) {
  x += 0.0f;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// A sort key that differs for all triangles.
std::uint64_t order_of(const OuterTriangle& triangle, int axis) {
  const Vec3 center = triangle.center;
  const float x = axis == 0 ? center.x : axis == 1 ? center.y : center.z;
  return std::uint64_t{order_word(x)} << 32 | triangle.number;
}

/// Triangles that are written once and then read from the beginning any number of times.
class OuterTriangles {
 public:
  explicit OuterTriangles(const std::string& beside) : all_(beside, 1) {}

  void add(const OuterTriangle& triangle) {
    all_.push_back(triangle);
    enlarge_box(&centers_, triangle.center);
  }
  /// Called after the last triangle.
  void rest() { all_.rest(); }
  [[nodiscard]] std::uint64_t size() const { return all_.size(); }
  [[nodiscard]] const Box& centers() const { return centers_; }
  template <class Body>
  void for_each(const Body& body) {
    for (std::uint64_t i = 0; i < all_.size(); ++i) body(all_[i]);
    all_.rest();
  }

 private:
  OuterArray<OuterTriangle> all_;
  Box centers_;
};

/// The key of the triangle of this rank along an axis. Keeps `at_once` keys in memory.
std::uint64_t order_at(OuterTriangles& triangles, int axis, std::uint64_t rank,
                       std::uint64_t at_once) {
  std::uint64_t prefix = 0, within = triangles.size();
  std::uint32_t known = 0;  // how many leading bits of the key are known
  const auto has_prefix = [&](std::uint64_t order) {
    return known == 0 || order >> (64 - known) == prefix;
  };
  while (within > at_once) {
    std::vector<std::uint64_t> counts(std::size_t{1} << kDigitBits);
    const std::uint32_t shift = 64 - known - kDigitBits;
    triangles.for_each([&](const OuterTriangle& triangle) {
      const std::uint64_t order = order_of(triangle, axis);
      if (has_prefix(order)) ++counts[order >> shift & (counts.size() - 1)];
    });
    std::uint64_t digit = 0;
    for (; rank >= counts[digit]; ++digit) rank -= counts[digit];
    within = counts[digit];
    prefix = prefix << kDigitBits | digit;
    known += kDigitBits;
  }
  std::vector<std::uint64_t> orders;
  orders.reserve(within);
  triangles.for_each([&](const OuterTriangle& triangle) {
    const std::uint64_t order = order_of(triangle, axis);
    if (has_prefix(order)) orders.push_back(order);
  });
  const auto at = orders.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(orders.begin(), at, orders.end());
  return *at;
}

/// Instances sorted by their meshes, and the numbers of their triangles.
class OuterRanks {
 public:
  explicit OuterRanks(const OuterScene& scene) : order_(scene.rest.instances.size()) {
    const auto& instances = scene.rest.instances;
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return instances[a].mesh < instances[b].mesh;
    });
    for (const std::uint32_t i : order_)
      first_.push_back(first_.back() + scene.meshes[instances[i].mesh].triangles.size());
  }

  [[nodiscard]] std::size_t count() const { return order_.size(); }
  [[nodiscard]] std::uint64_t triangle_count() const { return first_.back(); }
  [[nodiscard]] std::uint32_t instance(std::size_t rank) const { return order_[rank]; }
  [[nodiscard]] std::uint64_t first(std::size_t rank) const { return first_[rank]; }
  [[nodiscard]] std::size_t rank_of(std::uint32_t number) const {
    const auto above = std::upper_bound(first_.begin(), first_.end(), std::uint64_t{number});
    return static_cast<std::size_t>(above - first_.begin()) - 1;
  }

 private:
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> first_{0};  // one entry more than there are instances
};

/// Triangles of one instance, which becomes an instance in a scene of its own.
struct OuterPart {
  std::uint32_t instance = 0;
  std::vector<std::uint32_t> prim_ids;
};

/// Receives the blocks of a part of the scene and replaces its indices by those of the whole scene.
class PartSink : public BlockSink {
 public:
  PartSink(BlockSink* to, const SceneDescription& scene, const std::vector<OuterPart>& parts)
      : to_(*to), scene_(scene), parts_(parts) {}
  void add(const TriangleBlock& block, const BlockShading& shading) override {
    block_ = block;
    for (BlockPart& part : block_.parts) {
      const OuterPart& from = parts_[part.inst_id];
      part.inst_id = from.instance;
      part.geom_id = scene_.instances[from.instance].mesh;
      for (std::uint32_t i = part.first; i < part.first + part.count; ++i)
        block_.prim_ids[i] = from.prim_ids[block_.prim_ids[i]];
    }
    to_.add(block_, shading);
  }

 private:
  BlockSink& to_;
  const SceneDescription& scene_;
  const std::vector<OuterPart>& parts_;
  TriangleBlock block_;
};

/// A mesh of the triangles `prim_ids`, which are in ascending order. Vertices keep their order, so
/// that the blocks are those of the whole mesh.
Mesh part_of_mesh(const OuterMesh& from, const std::vector<std::uint32_t>& prim_ids) {
  Mesh mesh;
  mesh.triangles.reserve(prim_ids.size());
  std::vector<std::uint32_t> vertices;
  vertices.reserve(3 * prim_ids.size());
  for (const std::uint32_t i : prim_ids) {
    const auto& triangle = mesh.triangles.emplace_back(from.triangles[i]);
    vertices.insert(vertices.end(), triangle.begin(), triangle.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) {
      const auto at = std::lower_bound(vertices.begin(), vertices.end(), v);
      v = static_cast<std::uint32_t>(at - vertices.begin());
    }
  }
  const auto gather = [](const auto& column, const auto& numbers, auto* to) {
    if (column.empty()) return;
    to->reserve(numbers.size());
    for (const std::uint32_t i : numbers) to->push_back(column[i]);
  };
  gather(from.positions, vertices, &mesh.positions);
  gather(from.normals, vertices, &mesh.normals);
  gather(from.uvs, vertices, &mesh.uvs);
  gather(from.second_uvs, vertices, &mesh.second_uvs);
  gather(from.colors, vertices, &mesh.colors);
  if (from.materials.size() == 1)
    mesh.materials = {from.materials[0]};
  else
    gather(from.materials, prim_ids, &mesh.materials);
  return mesh;
}

class OuterCutter {
 public:
  OuterCutter(const OuterScene& scene, const OuterRanks& ranks, BlockSink* sink,
              const PackOptions& options)
      : scene_(scene), ranks_(ranks), sink_(*sink), options_(options) {}

  void cut(std::unique_ptr<OuterTriangles> triangles) {
    const std::uint64_t count = triangles->size();
    const std::uint64_t held = std::max(options_.triangles_at_once, options_.triangles_a_block);
    if (count <= held) return cut_held(std::move(triangles));
    const std::uint64_t most = options_.triangles_a_block, pieces = (count + most - 1) / most;
    const int axis = longest_axis(triangles->centers());
    const std::uint64_t rank = count * (pieces / 2) / pieces;
    const std::uint64_t plane = order_at(*triangles, axis, rank, held);
    auto left = std::make_unique<OuterTriangles>(options_.beside);
    auto right = std::make_unique<OuterTriangles>(options_.beside);
    triangles->for_each([&](const OuterTriangle& triangle) {
      (order_of(triangle, axis) < plane ? left : right)->add(triangle);
    });
    triangles.reset();
    left->rest();
    right->rest();
    cut(std::move(left));
    cut(std::move(right));
  }

 private:
  void cut_held(std::unique_ptr<OuterTriangles> from) {
    const std::vector<OuterPart> parts = parts_of(std::move(from));
    SceneDescription scene;
    for (const Material& material : scene_.rest.materials)
      scene.materials.emplace_back().double_sided = material.double_sided;
    scene.cameras.emplace_back();
    scene.lights.emplace_back();
    for (const OuterPart& part : parts) {
      const Instance& instance = scene_.rest.instances[part.instance];
      scene.instances.push_back(instance);
      scene.instances.back().mesh = static_cast<std::uint32_t>(scene.meshes.size());
      scene.meshes.push_back(part_of_mesh(scene_.meshes[instance.mesh], part.prim_ids));
    }
    scene_.columns->rest();
    PartSink sink(&sink_, scene_.rest, parts);
    static_cast<void>(cut_into_blocks(scene, &sink, options_.triangles_a_block));
  }

  /// The triangles grouped by the ranks of their instances.
  [[nodiscard]] std::vector<OuterPart> parts_of(std::unique_ptr<OuterTriangles> from) const {
    std::vector<std::uint32_t> numbers;
    numbers.reserve(from->size());
    from->for_each([&](const OuterTriangle& triangle) { numbers.push_back(triangle.number); });
    from.reset();
    std::sort(numbers.begin(), numbers.end());
    std::vector<OuterPart> parts;
    std::size_t rank = 0;
    for (const std::uint32_t number : numbers) {
      if (parts.empty() || number >= ranks_.first(rank + 1)) {
        rank = ranks_.rank_of(number);
        parts.push_back({ranks_.instance(rank), {}});
      }
      parts.back().prim_ids.push_back(static_cast<std::uint32_t>(number - ranks_.first(rank)));
    }
    return parts;
  }

  const OuterScene& scene_;
  const OuterRanks& ranks_;
  BlockSink& sink_;
  const PackOptions& options_;
};

/// Writes all triangles in world space to a file and passes them to `fit`. Null if one is too far
/// out.
std::unique_ptr<OuterTriangles> place_all(const OuterScene& scene, const OuterRanks& ranks,
                                          const PackOptions& options, ViewFit* fit) {
  auto all = std::make_unique<OuterTriangles>(options.beside);
  for (std::size_t rank = 0; rank < ranks.count(); ++rank) {
    const Instance& instance = scene.rest.instances[ranks.instance(rank)];
    const OuterMesh& mesh = scene.meshes[instance.mesh];
    for (std::uint64_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<Vec3, 3> at;
      const auto triangle = mesh.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = at[k] = placed(instance.to_world, mesh.positions[triangle[k]]);
        const float far = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
        const bool is_near = far <= kFarthest && std::isfinite(p.x + p.y + p.z);
        if (!is_near) return nullptr;
      }
      fit->add(at);
      const auto number = static_cast<std::uint32_t>(ranks.first(rank) + t);
      all->add({sum_of(at[0], at[1], at[2]), number});
    }
  }
  scene.columns->rest();
  all->rest();
  return all;
}

void add_camera_and_light(const ViewFit& fit, const PackOptions& options, SceneDescription* rest) {
  SceneDescription of_box;
  of_box.meshes.emplace_back();
  of_box.meshes[0].positions = {fit.bounds().min, fit.bounds().max};
  of_box.meshes[0].triangles = {{0, 1, 1}};
  of_box.instances.emplace_back();
  if (options.add_camera || rest->cameras.empty()) rest->cameras.push_back(fit.camera());
  const Camera& seen_by = options.add_camera ? rest->cameras.back() : rest->cameras.front();
  if (options.add_light && needs_light(*rest)) rest->lights = studio_lights(of_box, seen_by);
}

}  // namespace

std::optional<SceneDescription> cut_outer(OuterScene scene, BlockSink* sink,
                                          const PackOptions& options) {
  const OuterRanks ranks(scene);
  if (ranks.triangle_count() == 0 || ranks.triangle_count() >= kInvalidId) return std::nullopt;
  ViewFit fit(options.viewpoint);
  std::unique_ptr<OuterTriangles> all = place_all(scene, ranks, options, &fit);
  if (all == nullptr) return std::nullopt;
  OuterCutter(scene, ranks, sink, options).cut(std::move(all));
  add_camera_and_light(fit, options, &scene.rest);
  warn_of_spacing(fit.bounds(), &scene.rest);
  make_whole(&scene.rest);
  return std::move(scene.rest);
}

}  // namespace raysheaf::io
