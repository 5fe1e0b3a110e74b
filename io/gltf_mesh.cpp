#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "io/corner_normals.h"
#include "io/gltf.h"
#include "io/gltf_shape.h"
#include "io/linear.h"
#include "io/normals.h"
#include "io/refuse.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
/// glTF's codes of primitive modes; smaller ones are points and lines.
constexpr int kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;

int mode_of(const JsonValue& primitive) {
  return primitive.get("mode", kTriangles);
}

/// Triangles of a primitive with `count` corners.
std::size_t triangle_count_of(int mode, std::size_t count) {
  return mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
}

/// Assembles triangles from the corners of a list, strip or fan (glTF 2.0, section 3.7.2.1).
class TriangleAssembler {
 public:
  explicit TriangleAssembler(int mode) : mode_(mode) {}

  /// Whether `corner` completes a triangle.
  bool add(std::uint32_t corner) {
    const std::size_t n = count_++;
    if (n == 0) first_ = corner;
    const std::uint32_t before = last_[0], last = last_[1];
    last_ = {last, corner};
    if (n < 2) return false;
    if (mode_ == kTriangleFan)
      triangle_ = {last, corner, first_};
    else if (mode_ == kTriangleStrip && n % 2 != 0)
      triangle_ = {before, corner, last};
    else
      triangle_ = {before, last, corner};
    return mode_ != kTriangles || n % 3 == 2;
  }
  [[nodiscard]] const Triangle& triangle() const { return triangle_; }

 private:
  int mode_;
  std::size_t count_ = 0;
  std::uint32_t first_ = 0;
  std::array<std::uint32_t, 2> last_{};
  Triangle triangle_{};
};

/// Position, normal, both sets of texture coordinates, colour and alpha.
constexpr std::size_t kVertexBytes = 3 * sizeof(Vec3) + 2 * sizeof(Vec2) + sizeof(float);
/// The most memory that `add_missing_normals` needs per triangle: its corners, their normals, and
/// copies.
constexpr std::size_t kNormalsBytes = 96 + 3 * kVertexBytes;

/// Concatenates the primitives of one mesh into a `Mesh` or an `OuterMesh`.
template <class AnyMesh>
class MeshReader {
 public:
  MeshReader(const GltfModel& model, AccessorReader& accessors, const std::vector<UvSets>& uv_sets,
             std::size_t joint_count, Warnings& warnings, AnyMesh& mesh)
      : model_(model),
        accessors_(accessors),
        uv_sets_(uv_sets),
        warnings_(warnings),
        mesh_(mesh),
        shape_(accessors, joint_count, warnings) {}

  void read(std::size_t index) {
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
  }
  [[nodiscard]] ShapeReader& shape() { return shape_; }
  /// If true, the caller must call `add_missing_normals`.
  [[nodiscard]] bool misses_normals() const { return misses_normals_; }
  /// Whether each vertex has a normal (only for a `Mesh`).
  [[nodiscard]] const std::vector<bool>& has_normal() const { return has_normal_; }

 private:
  static constexpr bool kHeld = std::is_same_v<AnyMesh, Mesh>;

  /// The accessors of position, normal and uv, then of joints and weights, then of morph targets.
  /// Primitives with equal accessors share their vertices.
  using Attributes = std::vector<int>;

  void read_primitive(const JsonValue& primitive) {
    if (!is_drawn(primitive)) return;
    const int material = primitive.get("material", -1);
    const UvSets sets = material < 0 ? UvSets{} : uv_sets_[static_cast<std::size_t>(material)];
    const UvNames uv_names{"TEXCOORD_" + std::to_string(sets.first),
                           "TEXCOORD_" + std::to_string(sets.second)};
    const JsonValue& named = primitive.at("attributes");
    const bool thins = has_alpha(named.get("COLOR_0", -1)) && looks_at_alpha(material);
    Attributes attributes{named.get("POSITION", -1),
                          named.get("NORMAL", -1),
                          named.get(uv_names.first, -1),
                          named.get("COLOR_0", -1),
                          sets.second < 0 ? -1 : named.get(uv_names.second, -1),
                          thins ? 1 : 0};
    const ShapeSource source = shape_.source(primitive, place_);
    if (!kHeld && !(source.joints.empty() && source.targets.empty())) throw NeedsWholeFile{};
    attributes.insert(attributes.end(), source.joints.begin(), source.joints.end());
    attributes.insert(attributes.end(), source.targets.begin(), source.targets.end());
    const std::size_t count = accessors_.count(attributes[0]);
    const GltfAccessor* indices = checked_indices(primitive, count);
    const int mode = mode_of(primitive);
    const std::size_t corners = checked_corners(mode, indices == nullptr ? count : indices->count);
    const std::uint32_t base = vertices(attributes, source, count, uv_names);
    add_triangles(mode, indices, corners, base, any_normals_ && attributes[1] < 0);
    add_materials(static_cast<std::uint32_t>(material), triangle_count_of(mode, corners));
  }

  /// Attribute names of the first and the second set.
  struct UvNames {
    std::string first, second;
  };

  [[nodiscard]] bool has_alpha(int colors) const {
    return colors >= 0 && model_.accessors[static_cast<std::size_t>(colors)].components == 4;
  }
  /// Whether the material uses the alpha of the vertex colours.
  bool looks_at_alpha(int material) const {
    if (material < 0) return false;
    const JsonValue& source = model_.list("materials")[static_cast<std::size_t>(material)];
    const auto mode = source.get("alphaMode", std::string());
    return mode == "MASK" || mode == "BLEND";
  }

  bool is_drawn(const JsonValue& primitive) {
    const int mode = mode_of(primitive);
    if (mode > kTriangleFan) {
      throw Error(ErrorCode::kInvalidData,
                  "is " + std::to_string(mode) + ", which is not a primitive mode",
                  place_ + ".mode");
    }
    if (mode < kTriangles) {
      warnings_.once("Points and lines are left out.");
      return false;
    }
    const JsonValue& attributes = primitive.at("attributes");
    if (attributes.contains("POSITION")) return true;
    warnings_.once("Primitives without positions are left out.");
    return false;
  }

  /// Null if the primitive has no indices: then each vertex is a corner.
  const GltfAccessor* checked_indices(const JsonValue& primitive, std::size_t vertex_count) {
    const int accessor = primitive.get("indices", -1);
    if (accessor < 0) return nullptr;
    const std::string place = place_ + ".indices";
    const GltfAccessor& indices = accessors_.indices(accessor, place);
    accessors_.each_index(indices, [&](std::size_t i, std::uint32_t index) {
      if (index < vertex_count) return;
      throw Error(ErrorCode::kInvalidData,
                  "index " + std::to_string(index) + " is out of range: the primitive has " +
                      std::to_string(vertex_count) + " vertices",
                  place + "[" + std::to_string(i) + "]");
    });
    return &indices;
  }

  std::size_t checked_corners(int mode, std::size_t count) {
    if (count >= kInvalidId) throw Error(ErrorCode::kUnsupported, "has too many vertices", place_);
    if (mode == kTriangles && count % 3 != 0) {
      warnings_.once("Vertices that are left over after the last whole triangle are left out.");
    }
    return count;
  }

  /// `flat`: the triangles get vertices of their own, so that they stay flat next to primitives
  /// with normals.
  void add_triangles(int mode, const GltfAccessor* indices, std::size_t corners, std::uint32_t base,
                     bool flat) {
    const std::size_t more = triangle_count_of(mode, corners);
    accessors_.charge(
        more, sizeof(Triangle) + sizeof(std::uint32_t) + (flat ? 3 * kVertexBytes : 0), place_);
    if (flat && mesh_.positions.size() + 3 * more >= kInvalidId) {
      throw Error(ErrorCode::kUnsupported, "the mesh has 2^32 vertices or more", place_);
    }
    if constexpr (kHeld) {
      if (mesh_.triangles.empty()) mesh_.triangles.reserve(more);
    }
    TriangleAssembler assembler(mode);
    const auto add_corner = [&](std::size_t, std::uint32_t index) {
      if (!assembler.add(base + index)) return;
      mesh_.triangles.push_back(flat ? unshared(assembler.triangle()) : assembler.triangle());
    };
    if (indices != nullptr) return accessors_.each_index(*indices, add_corner);
    for (std::uint32_t i = 0; i < corners; ++i) add_corner(i, i);
  }

  void add_materials(std::uint32_t material, std::size_t triangles) {
    if (triangles == 0) return;
    if (!mesh_.materials.empty() && mesh_.materials[0] != material) one_material_ = false;
    if constexpr (kHeld)
      mesh_.materials.insert(mesh_.materials.end(), triangles, material);
    else
      mesh_.materials.resize(mesh_.materials.size() + triangles, material);
  }

  /// The first vertex with these attributes, which are read when a primitive first uses them.
  std::uint32_t vertices(const Attributes& attributes, const ShapeSource& source, std::size_t count,
                         const UvNames& uv_names) {
    const auto known = first_vertex_.find(attributes);
    if (known != first_vertex_.end()) return known->second;
    const std::size_t base = mesh_.positions.size();
    if (base + count >= kInvalidId) {
      throw Error(ErrorCode::kUnsupported, "the mesh has 2^32 vertices or more", place_);
    }
    const std::string place = place_ + ".attributes.";
    if constexpr (kHeld) {
      if (base == 0) mesh_.positions.reserve(count);
    }
    accessors_.each_vertex(attributes[0], 3, count, place + "POSITION", [&](const float* p) {
      if (std::max({std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])}) > kFarthest)
        refuse("is farther out than 1e18",
               element(place + "POSITION", mesh_.positions.size() - base));
      mesh_.positions.push_back({p[0], p[1], p[2]});
    });
    read_normals(attributes[1], count, place + "NORMAL");
    read_uvs(mesh_.uvs, attributes[2], count, place + uv_names.first);
    if (attributes[4] >= 0 && mesh_.uvs.empty()) mesh_.uvs.resize(mesh_.positions.size());
    read_uvs(mesh_.second_uvs, attributes[4], count, place + uv_names.second);
    if (attributes[4] < 0 && !mesh_.second_uvs.empty()) repeat_first_uvs(base);
    read_colors(attributes[3], attributes[5] != 0, count, place + "COLOR_0");
    shape_.read(source, base, count, any_normals_, place_);
    first_vertex_[attributes] = static_cast<std::uint32_t>(base);
    return static_cast<std::uint32_t>(base);
  }

  void read_normals(int accessor, std::size_t count, const std::string& place) {
    if (!any_normals_) return;
    if (accessor < 0) {
      for (std::size_t i = 0; i < count; ++i) add_normal({0, 0, 1});
      return;
    }
    accessors_.each_vertex(accessor, 3, count, place, [&](const float* p) {
      add_normal({p[0], p[1], p[2]});
    });
  }
  void add_normal(Vec3 normal) {
    const bool has = make_unit(normal);
    misses_normals_ = misses_normals_ || !has;
    if constexpr (kHeld) has_normal_.push_back(has);
    mesh_.normals.push_back(normal);
  }

  template <class Column>
  void read_uvs(Column& uvs, int accessor, std::size_t count, const std::string& place) {
    if (accessor >= 0) {
      uvs.resize(mesh_.positions.size() - count);
      accessors_.each_vertex(accessor, 2, count, place, [&](const float* p) {
        uvs.push_back({p[0], p[1]});
      });
    } else if (!uvs.empty()) {
      uvs.resize(mesh_.positions.size());
    }
  }
  /// Copies the first set to the second for vertices from `base` on that have no second set.
  void repeat_first_uvs(std::size_t base) {
    for (std::size_t i = base; i < mesh_.positions.size() && i < mesh_.uvs.size(); ++i)
      put(mesh_.second_uvs, i, Vec2(mesh_.uvs[i]));
  }

  /// Vertices of primitives without colours are white if other primitives have colours. `thins`:
  /// the material uses their alpha.
  void read_colors(int accessor, bool thins, std::size_t count, const std::string& place) {
    constexpr Vec3 kWhite{1, 1, 1};
    const auto part = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
    if (accessor >= 0) {
      mesh_.colors.resize(mesh_.positions.size() - count, kWhite);
      const int width = accessors_.components(accessor) == 4 ? 4 : 3;
      std::size_t vertex = mesh_.positions.size() - count;
      accessors_.each_vertex(accessor, width, count, place, [&](const float* p) {
        mesh_.colors.push_back({part(p[0]), part(p[1]), part(p[2])});
        if (thins && width == 4 && p[3] < 1) add_alpha(vertex, part(p[3]));
        ++vertex;
      });
    } else if (!mesh_.colors.empty()) {
      mesh_.colors.resize(mesh_.positions.size(), kWhite);
    }
    if (!mesh_.alphas.empty()) mesh_.alphas.resize(mesh_.positions.size(), 1.0f);
  }
  void add_alpha(std::size_t vertex, float alpha) {
    if constexpr (kHeld) {
      mesh_.alphas.resize(vertex, 1.0f);
      mesh_.alphas.push_back(alpha);
    } else {
      warnings_.once("Triangles that stream past are whole, whatever alpha cuts away.");
    }
  }

  /// Appends copies of the triangle's vertices and returns the triangle that uses them.
  Triangle unshared(Triangle t) {
    if constexpr (kHeld) shape_.add_flat(static_cast<std::uint32_t>(mesh_.triangles.size()));
    const Double3 a = widen(mesh_.positions[t[0]]), b = widen(mesh_.positions[t[1]]),
                  c = widen(mesh_.positions[t[2]]);
    const Vec3 normal = narrow(normalized(cross(b - a, c - a), {0, 0, 1}));
    for (std::uint32_t& v : t) {
      const Vec3 position = mesh_.positions[v];
      const std::uint32_t from = v;
      shape_.repeat(from);
      v = static_cast<std::uint32_t>(mesh_.positions.size());
      mesh_.positions.push_back(position);
      mesh_.normals.push_back(normal);
      if constexpr (kHeld) has_normal_.push_back(true);
      repeat(mesh_.uvs, from);
      repeat(mesh_.second_uvs, from);
      repeat(mesh_.colors, from);
      repeat(mesh_.alphas, from);
    }
    return t;
  }

  void finish() {
    if (!mesh_.uvs.empty()) mesh_.uvs.resize(mesh_.positions.size());
    if (!mesh_.second_uvs.empty()) mesh_.second_uvs.resize(mesh_.positions.size());
    if (!mesh_.alphas.empty()) mesh_.alphas.resize(mesh_.positions.size(), 1.0f);
    if (one_material_ && !mesh_.materials.empty())
      mesh_.materials.resize(mesh_.materials[0] == kInvalidId ? 0 : 1);
    if (misses_normals_)
      warnings_.once("Vertex normals of length zero are replaced by computed ones.");
  }

  const GltfModel& model_;
  AccessorReader& accessors_;
  const std::vector<UvSets>& uv_sets_;
  Warnings& warnings_;
  AnyMesh& mesh_;
  ShapeReader shape_;
  std::string place_;
  bool any_normals_ = false, misses_normals_ = false, one_material_ = true;
  std::vector<bool> has_normal_;
  std::map<Attributes, std::uint32_t> first_vertex_;
};

}  // namespace

GltfMesh read_mesh(const GltfModel& model, std::size_t index, std::size_t joint_count,
                   AccessorReader& accessors, const std::vector<UvSets>& uv_sets,
                   Warnings& warnings) {
  GltfMesh result;
  MeshReader reader(model, accessors, uv_sets, joint_count, warnings, result.mesh);
  reader.read(index);
  if (reader.misses_normals()) {
    accessors.charge(result.mesh.triangles.size(), kNormalsBytes, element("meshes", index));
    for (const std::uint32_t v : add_missing_normals(result.mesh, reader.has_normal()))
      reader.shape().repeat(v);
  }
  result.shape = reader.shape().take(result.mesh);
  return result;
}

void read_outer_mesh(const GltfModel& model, std::size_t index, AccessorReader& accessors,
                     const std::vector<UvSets>& uv_sets, Warnings& warnings,
                     const PackOptions& options, OuterMesh* mesh) {
  MeshReader reader(model, accessors, uv_sets, 0, warnings, *mesh);
  reader.read(index);
  if (mesh->triangles.size() >= kInvalidId) throw NeedsWholeFile{};
  if (reader.misses_normals()) add_missing_normals(*mesh, options);
}

}  // namespace raysheaf::io
