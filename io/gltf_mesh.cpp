#include <algorithm>
#include <array>
#include <map>

#include "io/gltf.h"
#include "io/gltf_shape.h"
#include "io/linear.h"
#include "io/normals.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
/// glTF's numbers for what a primitive is; below are points and lines.
constexpr int kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;

int mode_of(const JsonValue& primitive) {
  return primitive.get("mode", kTriangles);
}

/// The corners of a list, strip or fan of `count` vertices, as glTF 2.0, section 3.7.2.1 has them.
std::vector<Triangle> corners_of(int mode, std::size_t vertex_count) {
  const auto count = static_cast<std::uint32_t>(vertex_count);
  std::vector<Triangle> result;
  if (mode == kTriangles) {
    result.reserve(count / 3);
    for (std::uint32_t i = 0; i + 2 < count; i += 3) result.push_back({i, i + 1, i + 2});
  } else if (mode == kTriangleStrip) {
    for (std::uint32_t i = 0; i + 2 < count; ++i) {
      result.push_back({i, i + 1 + i % 2, i + 2 - i % 2});
    }
  } else {
    for (std::uint32_t i = 1; i + 1 < count; ++i) result.push_back({i, i + 1, 0});
  }
  return result;
}

/// Concatenates the primitives of one mesh.
class MeshReader {
 public:
  MeshReader(const GltfModel& model, AccessorReader& accessors, const std::vector<int>& uv_sets,
             std::size_t joint_count, Warnings& warnings)
      : model_(model),
        accessors_(accessors),
        uv_sets_(uv_sets),
        warnings_(warnings),
        shape_(accessors, joint_count, warnings) {}

  GltfMesh read(std::size_t index) {
    const JsonValue& source = model_.list("meshes")[index];
    mesh_.name = source.get("name", std::string());
    const auto primitives = source.items("primitives");
    any_normals_ = std::any_of(primitives.begin(), primitives.end(), [](const JsonValue& p) {
      return mode_of(p) >= kTriangles && p.at("attributes").contains("NORMAL");
    });
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      place_ = "meshes[" + std::to_string(index) + "].primitives[" + std::to_string(p) + "]";
      read_primitive(primitives[p]);
    }
    finish();
    RigShape shape = shape_.take(mesh_);
    return {std::move(mesh_), std::move(shape)};
  }

 private:
  /// The accessors of position, normal and uv, then of joints and weights, then of targets:
  /// primitives with the same share their vertices.
  using Attributes = std::vector<int>;

  void read_primitive(const JsonValue& primitive) {
    if (!is_drawn(primitive)) return;
    const int material = primitive.get("material", -1);
    const int set = material < 0 ? 0 : uv_sets_[static_cast<std::size_t>(material)];
    const std::string uv_name = "TEXCOORD_" + std::to_string(set);
    const JsonValue& named = primitive.at("attributes");
    Attributes attributes{named.get("POSITION", -1), named.get("NORMAL", -1),
                          named.get(uv_name, -1)};
    const ShapeSource source = shape_.source(primitive, place_);
    attributes.insert(attributes.end(), source.joints.begin(), source.joints.end());
    attributes.insert(attributes.end(), source.targets.begin(), source.targets.end());
    const std::size_t count = accessors_.count(attributes[0]);
    std::vector<Triangle> triangles = read_triangles(primitive, count);
    const std::uint32_t base = vertices(attributes, source, count, uv_name);
    for (Triangle& t : triangles) {
      for (std::uint32_t& v : t) v += base;
    }
    if (any_normals_ && attributes[1] < 0) unshare(triangles);
    mesh_.triangles.insert(mesh_.triangles.end(), triangles.begin(), triangles.end());
    mesh_.materials.insert(mesh_.materials.end(), triangles.size(),
                           static_cast<std::uint32_t>(material));
  }

  bool is_drawn(const JsonValue& primitive) {
    const int mode = mode_of(primitive);
    if (mode > kTriangleFan) {
      throw Error(ErrorCode::kInvalidData, "is " + std::to_string(mode) + ", which is no mode",
                  place_ + ".mode");
    }
    if (mode < kTriangles) {
      warnings_.once("Points and lines are left out.");
      return false;
    }
    const JsonValue& attributes = primitive.at("attributes");
    if (attributes.contains("COLOR_0")) warnings_.once("Vertex colours are left out.");
    if (attributes.contains("POSITION")) return true;
    warnings_.once("Primitives without positions are left out.");
    return false;
  }

  std::vector<Triangle> read_triangles(const JsonValue& primitive, std::size_t vertex_count) {
    const int accessor = primitive.get("indices", -1), mode = mode_of(primitive);
    if (accessor < 0) return checked_corners(mode, vertex_count);
    const std::string place = place_ + ".indices";
    const std::vector<std::uint32_t> indices = accessors_.indices(accessor, place);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] < vertex_count) continue;
      throw Error(ErrorCode::kInvalidData,
                  "index " + std::to_string(indices[i]) + " is out of range: the primitive has " +
                      std::to_string(vertex_count) + " vertices",
                  place + "[" + std::to_string(i) + "]");
    }
    std::vector<Triangle> triangles = checked_corners(mode, indices.size());
    for (Triangle& t : triangles) t = {indices[t[0]], indices[t[1]], indices[t[2]]};
    return triangles;
  }

  std::vector<Triangle> checked_corners(int mode, std::size_t count) {
    if (count >= kInvalidId) throw Error(ErrorCode::kUnsupported, "has too many vertices", place_);
    if (mode == kTriangles && count % 3 != 0) {
      warnings_.once("Vertices that are left over after the last whole triangle are left out.");
    }
    return corners_of(mode, count);
  }

  /// The first vertex of these attributes, which are read unless an earlier primitive did.
  std::uint32_t vertices(const Attributes& attributes, const ShapeSource& source, std::size_t count,
                         const std::string& uv_name) {
    const auto known = first_vertex_.find(attributes);
    if (known != first_vertex_.end()) return known->second;
    const std::size_t base = mesh_.positions.size();
    if (base + count >= kInvalidId) {
      throw Error(ErrorCode::kUnsupported, "the mesh has 2^32 vertices or more", place_);
    }
    const std::string place = place_ + ".attributes.";
    const std::vector<float> positions =
        accessors_.attribute(attributes[0], 3, count, place + "POSITION");
    const std::vector<Vec3> points = as_vec3(positions);
    mesh_.positions.insert(mesh_.positions.end(), points.begin(), points.end());
    read_normals(attributes[1], count, place + "NORMAL");
    read_uvs(attributes[2], count, place + uv_name);
    shape_.read(source, base, count, any_normals_, place_);
    first_vertex_[attributes] = static_cast<std::uint32_t>(base);
    return static_cast<std::uint32_t>(base);
  }

  void read_normals(int accessor, std::size_t count, const std::string& place) {
    if (!any_normals_) return;
    if (accessor < 0) {
      mesh_.normals.resize(mesh_.positions.size(), Vec3{0, 0, 1});
      has_normal_.resize(mesh_.positions.size(), true);
      return;
    }
    for (Vec3 normal : as_vec3(accessors_.attribute(accessor, 3, count, place))) {
      has_normal_.push_back(make_unit(normal));
      mesh_.normals.push_back(normal);
    }
  }

  void read_uvs(int accessor, std::size_t count, const std::string& place) {
    if (accessor >= 0) {
      mesh_.uvs.resize(mesh_.positions.size() - count);
      const std::vector<float> values = accessors_.attribute(accessor, 2, count, place);
      for (std::size_t i = 0; i < count; ++i) {
        mesh_.uvs.push_back({values[2 * i], values[2 * i + 1]});
      }
    } else if (!mesh_.uvs.empty()) {
      mesh_.uvs.resize(mesh_.positions.size());
    }
  }

  /// Vertices of their own for triangles whose primitive has no normals, so that they stay flat
  /// beside primitives that have some.
  void unshare(std::vector<Triangle>& triangles) {
    if (mesh_.positions.size() + 3 * triangles.size() >= kInvalidId) {
      throw Error(ErrorCode::kUnsupported, "the mesh has 2^32 vertices or more", place_);
    }
    auto flat = static_cast<std::uint32_t>(mesh_.triangles.size());
    for (Triangle& t : triangles) {
      shape_.add_flat(flat++);
      const Double3 a = widen(mesh_.positions[t[0]]), b = widen(mesh_.positions[t[1]]),
                    c = widen(mesh_.positions[t[2]]);
      const Vec3 normal = narrow(normalized(cross(b - a, c - a), {0, 0, 1}));
      for (std::uint32_t& v : t) {
        const Vec3 position = mesh_.positions[v];
        const Vec2 uv = mesh_.uvs.empty() ? Vec2{} : mesh_.uvs[v];
        shape_.repeat(v);
        v = static_cast<std::uint32_t>(mesh_.positions.size());
        mesh_.positions.push_back(position);
        mesh_.normals.push_back(normal);
        has_normal_.push_back(true);
        if (!mesh_.uvs.empty()) mesh_.uvs.push_back(uv);
      }
    }
  }

  void finish() {
    if (!mesh_.uvs.empty()) mesh_.uvs.resize(mesh_.positions.size());
    auto& materials = mesh_.materials;
    const bool uniform = std::adjacent_find(materials.begin(), materials.end(),
                                            std::not_equal_to<>()) == materials.end();
    if (uniform && !materials.empty()) materials.resize(materials[0] == kInvalidId ? 0 : 1);
    if (std::find(has_normal_.begin(), has_normal_.end(), false) == has_normal_.end()) return;
    warnings_.once("Vertex normals of length zero are replaced by computed ones.");
    add_missing_normals(mesh_, has_normal_);
  }

  const GltfModel& model_;
  AccessorReader& accessors_;
  const std::vector<int>& uv_sets_;
  Warnings& warnings_;
  Mesh mesh_;
  ShapeReader shape_;
  std::string place_;
  bool any_normals_ = false;
  std::vector<bool> has_normal_;
  std::map<Attributes, std::uint32_t> first_vertex_;
};

}  // namespace

GltfMesh read_mesh(const GltfModel& model, std::size_t index, std::size_t joint_count,
                   AccessorReader& accessors, const std::vector<int>& uv_sets, Warnings& warnings) {
  return MeshReader(model, accessors, uv_sets, joint_count, warnings).read(index);
}

}  // namespace raysheaf::io
