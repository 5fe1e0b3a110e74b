// The translation unit of tinyobjloader's OBJ parser.
#include "io/obj.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <istream>
#include <optional>
#include <unordered_map>

#include "io/linear.h"
#include "io/normals.h"
#include "io/obj_lines.h"
#include "io/polygon.h"
#include "io/srgb.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// The indices at a face's corner; uv and normal are `kInvalidId` if missing.
struct Corner {
  std::uint32_t position = 0, uv = kInvalidId, normal = kInvalidId;
  bool operator==(const Corner&) const = default;
};

/// Marks vertices without a colour. Colours have no negative components.
constexpr Vec3 kNoColor{-1, -1, -1};

/// The faces of one object or group, triangulated.
struct Group {
  std::string name;
  std::vector<Corner> corners;           ///< three per triangle
  std::vector<std::uint32_t> materials;  ///< one per triangle
};

/// Receives the parser's callbacks.
class ObjReader {
 public:
  ObjReader(ObjLines& lines, MtlLibrary& materials) : lines_(lines), materials_(materials) {}

  void run() {
    std::istream stream(&lines_);
    // Without this, the stream would swallow the exceptions of its buffer.
    stream.exceptions(std::ios::badbit);
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, float x, float y, float z, float) {
      static_cast<ObjReader*>(self)->add_position({x, y, z});
    };
    callbacks.normal_cb = [](void* self, float x, float y, float z) {
      static_cast<ObjReader*>(self)->add_normal({x, y, z});
    };
    // In OBJ, v counts from the bottom row up.
    callbacks.texcoord_cb = [](void* self, float x, float y, float) {
      static_cast<ObjReader*>(self)->add_uv({x, 1 - y});
    };
    callbacks.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
      static_cast<ObjReader*>(self)->add_face(corners, static_cast<std::size_t>(count));
    };
    callbacks.usemtl_cb = [](void* self, const char* name, int) {
      static_cast<ObjReader*>(self)->use_material(name);
    };
    callbacks.group_cb = [](void* self, const char** names, int count) {
      static_cast<ObjReader*>(self)->begin_group(names, count);
    };
    callbacks.object_cb = [](void* self, const char* name) {
      static_cast<ObjReader*>(self)->begin_object(name);
    };
    tinyobj::LoadObjWithCallback(stream, callbacks, this, nullptr, nullptr, nullptr);
    find_materials();
    scale_colors();
  }

  [[nodiscard]] bool has_colors() const { return !colors_.empty(); }
  /// Whether colours range to 255 instead of 1.
  [[nodiscard]] bool is_in_bytes() const { return is_in_bytes_; }
  /// Whether a face refers to normals or texture coordinates although the file has none.
  [[nodiscard]] bool names_nothing() const { return names_nothing_; }

  std::vector<Mesh> build_meshes() {
    if (has_colors()) colors_.resize(positions_.size(), {1, 1, 1});
    std::vector<Mesh> meshes;
    for (Group& group : groups_) {
      if (!group.corners.empty()) meshes.push_back(build(group));
      group = {};
    }
    return meshes;
  }

 private:
  void add_position(Vec3 p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw Error(ErrorCode::kInvalidData, "the vertex is not finite", lines_.place());
    }
    positions_.push_back(p);
    if (lines_.color()) add_color(*lines_.color());
  }
  /// Earlier vertices have no colour.
  void add_color(Vec3 color) {
    colors_.resize(positions_.size() - 1, kNoColor);
    colors_.push_back(color);
    is_in_bytes_ = is_in_bytes_ || std::max({color.x, color.y, color.z}) > kMostUnitColor;
  }
  /// Colours stay as written until all are known, because programs that mean bytes write values up
  /// to 255.
  void scale_colors() {
    const float largest = is_in_bytes_ ? 255.0f : 1.0f;
    const auto linear = [&](float x) {
      return static_cast<float>(linear_of_srgb(std::clamp(x / largest, 0.0f, 1.0f)));
    };
    for (Vec3& color : colors_) {
      if (color.x == kNoColor.x)
        color = {1, 1, 1};
      else
        color = {linear(color.x), linear(color.y), linear(color.z)};
    }
  }
  void add_normal(Vec3 n) {
    if (!std::isfinite(n.x) || !std::isfinite(n.y) || !std::isfinite(n.z)) {
      throw Error(ErrorCode::kInvalidData, "the normal is not finite", lines_.place());
    }
    normals_.push_back(n);
  }
  void add_uv(Vec2 uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      throw Error(ErrorCode::kInvalidData, "the texture coordinate is not finite", lines_.place());
    }
    uvs_.push_back(uv);
  }

  /// `raw` counts from 1, or backwards from the newest if negative; 0 means none.
  std::uint32_t resolve(int raw, std::size_t count, const char* what) const {
    if (raw == 0) return kInvalidId;
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t index = raw > 0 ? raw - std::int64_t{1} : size + raw;
    if (index >= 0 && index < size) return static_cast<std::uint32_t>(index);
    throw Error(ErrorCode::kInvalidData,
                std::string(what) + " " + std::to_string(raw) + " is out of range: there are " +
                    std::to_string(count) + " so far",
                lines_.place());
  }

  /// The same for normals and texture coordinates. If the file has none so far, the number is
  /// ignored: some programs omit the lists but keep the numbers.
  std::uint32_t resolve_beside(int raw, std::size_t count, const char* what) {
    if (count > 0) return resolve(raw, count, what);
    names_nothing_ = names_nothing_ || raw != 0;
    return kInvalidId;
  }

  void add_face(const tinyobj::index_t* raw, std::size_t count) {
    face_.clear();
    points_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      face_.push_back({resolve(raw[i].vertex_index, positions_.size(), "vertex"),
                       resolve_beside(raw[i].texcoord_index, uvs_.size(), "texture coordinate"),
                       resolve_beside(raw[i].normal_index, normals_.size(), "normal")});
      points_.push_back(positions_[face_.back().position]);
    }
    Group& group = current_group();
    const std::uint32_t material = current_material();
    if (count == 3) {
      group.corners.insert(group.corners.end(), face_.begin(), face_.end());
      group.materials.push_back(material);
      return;
    }
    for (const auto& t : triangulate(points_)) {
      for (const std::uint32_t corner : t) group.corners.push_back(face_[corner]);
      group.materials.push_back(material);
    }
  }

  Group& current_group() {
    if (group_ != kInvalidId) return groups_[group_];
    std::string name = object_name_;
    if (!group_name_.empty()) name += (name.empty() ? "" : "/") + group_name_;
    const auto [it, fresh] = group_of_.try_emplace(name, groups_.size());
    if (fresh) groups_.push_back({name, {}, {}});
    group_ = static_cast<std::uint32_t>(it->second);
    return groups_[group_];
  }
  void begin_object(const std::string& name) {
    object_name_ = trim(name);
    group_name_.clear();
    group_ = kInvalidId;
  }
  void begin_group(const char** names, int count) {
    group_name_.clear();
    for (int i = 0; i < count; ++i) group_name_ += (i > 0 ? " " : "") + std::string(names[i]);
    group_ = kInvalidId;
  }

  /// Materials are looked up after all libraries are read, because a library may follow the faces
  /// that use it.
  void use_material(const std::string& name) {
    material_name_ = trim(name);
    material_ = kInvalidId;
  }
  std::uint32_t current_material() {
    if (material_ != kInvalidId) return material_;
    const auto [it, fresh] = number_of_name_.try_emplace(
        material_name_, static_cast<std::uint32_t>(material_names_.size()));
    if (fresh) material_names_.push_back(material_name_);
    material_ = it->second;
    return material_;
  }
  void find_materials() {
    for (const std::string& names : lines_.take_libraries()) materials_.add(names);
    std::vector<std::uint32_t> found;
    for (const std::string& name : material_names_)
      found.push_back(name.empty() ? materials_.fallback() : materials_.find(name));
    for (Group& group : groups_)
      for (std::uint32_t& material : group.materials) material = found[material];
  }

  /// Merges corners with the same references to one vertex. Only the newest few vertices of a
  /// position are searched, so that the time stays linear.
  class VertexMerger {
   public:
    explicit VertexMerger(std::size_t positions) : newest_(positions, kInvalidId) {}

    void begin() {
      for (const Corner& corner : vertices_) newest_[corner.position] = kInvalidId;
      vertices_.clear();
      previous_.clear();
    }
    std::uint32_t vertex_of(const Corner& corner) {
      std::uint32_t v = newest_[corner.position];
      for (int step = 0; step < 16 && v != kInvalidId; ++step, v = previous_[v]) {
        if (vertices_[v] == corner) return v;
      }
      const auto fresh = static_cast<std::uint32_t>(vertices_.size());
      previous_.push_back(newest_[corner.position]);
      newest_[corner.position] = fresh;
      vertices_.push_back(corner);
      return fresh;
    }
    [[nodiscard]] const std::vector<Corner>& vertices() const { return vertices_; }

   private:
    std::vector<std::uint32_t> newest_, previous_;
    std::vector<Corner> vertices_;
  };

  Mesh build(Group& group) {
    if (!merger_) merger_.emplace(positions_.size());
    VertexMerger& merger = *merger_;
    merger.begin();
    Mesh mesh;
    mesh.name = group.name;
    mesh.triangles.resize(group.corners.size() / 3);
    for (std::size_t c = 0; c < group.corners.size(); ++c) {
      mesh.triangles[c / 3][c % 3] = merger.vertex_of(group.corners[c]);
    }
    fill_vertices(merger.vertices(), mesh);
    mesh.materials = std::move(group.materials);
    const std::uint32_t first = mesh.materials.front();
    const bool uniform = std::all_of(mesh.materials.begin(), mesh.materials.end(),
                                     [&](std::uint32_t m) { return m == first; });
    if (uniform) mesh.materials.resize(1);
    return mesh;
  }

  void fill_vertices(const std::vector<Corner>& vertices, Mesh& mesh) const {
    const bool has_uvs = std::any_of(vertices.begin(), vertices.end(),
                                     [](const Corner& c) { return c.uv != kInvalidId; });
    std::vector<bool> has_normal;
    bool all_normals = true;
    for (const Corner& corner : vertices) {
      mesh.positions.push_back(positions_[corner.position]);
      if (has_uvs) mesh.uvs.push_back(corner.uv == kInvalidId ? Vec2{} : uvs_[corner.uv]);
      if (has_colors()) mesh.colors.push_back(colors_[corner.position]);
      Vec3 normal = corner.normal == kInvalidId ? Vec3{} : normals_[corner.normal];
      has_normal.push_back(make_unit(normal));
      all_normals = all_normals && has_normal.back();
      mesh.normals.push_back(has_normal.back() ? normal : Vec3{0, 0, 1});
    }
    if (!all_normals) add_missing_normals(mesh, has_normal);
  }

  ObjLines& lines_;
  MtlLibrary& materials_;
  std::vector<Vec3> positions_, normals_, colors_;
  std::vector<Vec2> uvs_;
  std::vector<Group> groups_;
  std::unordered_map<std::string, std::size_t> group_of_;
  std::string object_name_, group_name_, material_name_;
  std::uint32_t group_ = kInvalidId;
  std::uint32_t material_ = kInvalidId;  ///< index of `material_name_`
  std::vector<std::string> material_names_;
  std::unordered_map<std::string, std::uint32_t> number_of_name_;
  bool names_nothing_ = false, is_in_bytes_ = false;
  std::vector<Corner> face_;
  std::vector<Vec3> points_;
  std::optional<VertexMerger> merger_;
};

}  // namespace

SceneDescription load_obj(const Bytes& file, const SceneFile& from) {
  SceneDescription scene;
  scene.name = std::filesystem::path(from.path).stem().string();
  ObjLines lines(text_of(file));
  MtlLibrary materials(from, scene);
  ObjReader reader(lines, materials);
  reader.run();
  scene.meshes = reader.build_meshes();
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    scene.instances.push_back({scene.meshes[m].name, m, {}});
  }
  if (reader.has_colors()) materials.whiten_fallback();
  materials.finish();
  if (reader.is_in_bytes()) scene.warnings.emplace_back(kBytesRemark);
  if (lines.had_lines_or_points()) scene.warnings.push_back("Points and lines are left out.");
  if (lines.had_curves()) scene.warnings.push_back("Curves and surfaces are left out.");
  if (reader.names_nothing()) {
    scene.warnings.push_back(
        "Faces refer to normals or texture coordinates that the file does not have; these are left "
        "out.");
  }
  if (lines.had_short_faces()) {
    scene.warnings.push_back("Faces with fewer than three vertices are left out.");
  }
  return scene;
}

}  // namespace raysheaf::io
