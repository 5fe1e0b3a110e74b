#include "io/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "io/linear.h"
#include "io/normals.h"
#include "io/obj_lines.h"
#include "io/polygon.h"
#include "io/refuse.h"
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
  std::vector<std::uint32_t> smoothing;  ///< one per triangle
};

/// Reads statement by statement.
class ObjReader {
 public:
  ObjReader(std::string_view text, MtlLibrary& materials) : lines_(text), materials_(materials) {}

  void run() {
    while (lines_.next()) read_line();
    find_materials();
    scale_colors();
  }

  [[nodiscard]] bool has_colors() const { return !colors_.empty(); }
  /// Adds a warning for each kind of content that was ignored.
  void warn(std::vector<std::string>& warnings) const {
    const auto add = [&](bool is_so, std::string sentence) {
      if (is_so) warnings.push_back(std::move(sentence));
    };
    add(is_in_bytes_, kBytesRemark);
    add(has_commas_, kCommaRemark);
    add(points_or_lines_, "Points and lines are left out.");
    add(curves_, "Curves and surfaces are left out.");
    add(names_nothing_,
        "Faces refer to normals or texture coordinates that the file does not have; these are left "
        "out.");
    add(odd_normals_, "Normals that are not finite are left out.");
    add(odd_uvs_, "Texture coordinates that are not finite are left out.");
    add(short_faces_, "Faces with fewer than three vertices are left out.");
    const auto has_faces = [](const Group& group) { return !group.corners.empty(); };
    warn_of_odd_faces(odd_faces_, std::any_of(groups_.begin(), groups_.end(), has_faces), warnings);
  }

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
  void read_line() {
    const std::string& keyword = lines_.keyword();
    if (keyword == "v") {
      add_position();
    } else if (keyword == "vn") {
      add_normal();
    } else if (keyword == "vt") {
      add_uv();
    } else if (keyword == "f" || keyword == "fo") {
      add_face();
    } else if (keyword == "s") {
      begin_smoothing();
    } else if (keyword == "g") {
      begin_group();
    } else if (keyword == "o") {
      begin_object();
    } else if (keyword == "usemtl") {
      use_material();
    } else if (keyword == "mtllib") {
      libraries_.emplace_back(trim(lines_.rest()));
    } else {
      points_or_lines_ = points_or_lines_ || keyword == "l" || keyword == "p";
      curves_ = curves_ || keyword == "curv" || keyword == "curv2" || keyword == "surf";
    }
  }

  /// Reads all numbers of the line, of which the first six are kept, and returns how many there
  /// are.
  std::size_t read_numbers(std::size_t least) {
    std::size_t count = 0;
    std::string_view rest = lines_.rest();
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const std::optional<double> number = read_number(word, &has_commas_);
      if (!number) refuse(in_quotes(word) + " is not a number", lines_.place());
      if (count < numbers_.size()) numbers_[count] = *number;
      ++count;
    }
    if (count < least) {
      refuse("has " + std::to_string(count) + " numbers where " + std::to_string(least) +
                 " are needed",
             lines_.place());
    }
    return count;
  }
  [[nodiscard]] Vec3 first_three() const {
    return narrow(Double3{numbers_[0], numbers_[1], numbers_[2]});
  }

  /// Three numbers after the position are a colour.
  void add_position() {
    const std::size_t count = read_numbers(3);
    positions_.push_back(first_three());
    if (count == numbers_.size()) add_color();
  }
  /// Earlier vertices have no colour.
  void add_color() {
    const auto part = [&](std::size_t i) {
      return numbers_[i] > 0 ? static_cast<float>(std::min(numbers_[i], 255.0)) : 0;
    };
    const Vec3 color{part(3), part(4), part(5)};
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
  void add_normal() {
    read_numbers(3);
    const Vec3 n = first_three();
    normals_.push_back(is_finite(n) ? n : Vec3{});
    odd_normals_ = odd_normals_ || !is_finite(n);
  }
  /// In OBJ, v counts from the bottom row up.
  void add_uv() {
    numbers_[1] = 0;
    read_numbers(1);
    const Vec2 uv{static_cast<float>(numbers_[0]), 1 - static_cast<float>(numbers_[1])};
    const bool finite = std::isfinite(uv.x) && std::isfinite(uv.y);
    uvs_.push_back(finite ? uv : Vec2{});
    odd_uvs_ = odd_uvs_ || !finite;
  }

  /// `raw` counts from 1, or backwards from the newest if negative. `kInvalidId` if there is no
  /// such element so far.
  static std::uint32_t index_of(std::int64_t raw, std::size_t count) {
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t index = raw > 0 ? raw - 1 : size + raw;
    return raw != 0 && index >= 0 && index < size ? static_cast<std::uint32_t>(index) : kInvalidId;
  }
  [[nodiscard]] std::uint32_t position_of(std::int64_t raw) const {
    const std::uint32_t index = index_of(raw, positions_.size());
    if (index == kInvalidId) {
      refuse("vertex " + std::to_string(raw) + " is out of range: " +
                 (raw == 0 ? "indices begin at 1"
                           : "there are " + std::to_string(positions_.size()) + " so far"),
             lines_.place());
    }
    return index;
  }
  /// The index of a normal or of texture coordinates. Numbers without an element are ignored: some
  /// programs omit the lists but keep the numbers.
  std::uint32_t index_beside(std::int64_t raw, std::size_t count) {
    if (raw == kNoIndex) return kInvalidId;
    const std::uint32_t index = index_of(raw, count);
    names_nothing_ = names_nothing_ || index == kInvalidId;
    return index;
  }

  void add_face() {
    face_.clear();
    points_.clear();
    bool finite = true;
    ObjReference raw;
    std::string_view rest = lines_.rest();
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      if (!read_reference(word, &raw))
        refuse(in_quotes(word) + " is not a vertex reference", lines_.place());
      face_.push_back({position_of(raw[0]), index_beside(raw[1], uvs_.size()),
                       index_beside(raw[2], normals_.size())});
      points_.push_back(positions_[face_.back().position]);
      finite = finite && is_finite(points_.back());
    }
    short_faces_ = short_faces_ || face_.size() < 3;
    if (face_.size() < 3) return;
    if (!finite) {
      ++odd_faces_;
      return;
    }
    if (face_.size() == 3) return add_triangle({0, 1, 2});
    for (const auto& t : triangulate(points_)) add_triangle(t);
  }
  /// `corners`: within the current face.
  void add_triangle(const std::array<std::uint32_t, 3>& corners) {
    Group& group = current_group();
    for (const std::uint32_t corner : corners) group.corners.push_back(face_[corner]);
    group.materials.push_back(current_material());
    group.smoothing.push_back(smoothing_);
  }

  /// "s off" and "s 0" end smoothing; any other word is the name of a group.
  void begin_smoothing() {
    std::string_view rest = lines_.rest();
    const std::string name = in_lower_case(take_word(rest));
    const bool is_off = name == "off" || name.find_first_not_of('0') == name.npos;
    smoothing_ =
        is_off
            ? kFlat
            : smoothing_of_.try_emplace(name, static_cast<std::uint32_t>(smoothing_of_.size()) + 1)
                  .first->second;
  }

  Group& current_group() {
    if (group_ != kInvalidId) return groups_[group_];
    std::string name = object_name_;
    if (!group_name_.empty()) name += (name.empty() ? "" : "/") + group_name_;
    const auto [it, fresh] = group_of_.try_emplace(name, groups_.size());
    if (fresh) groups_.push_back({name, {}, {}, {}});
    group_ = static_cast<std::uint32_t>(it->second);
    return groups_[group_];
  }
  void begin_object() {
    object_name_ = trim(lines_.rest());
    group_name_.clear();
    group_ = kInvalidId;
  }
  void begin_group() {
    group_name_.clear();
    for (const std::string_view name : words_of(lines_.rest()))
      group_name_ += (group_name_.empty() ? "" : " ") + std::string(name);
    if (group_name_.empty()) group_name_ = "default";
    group_ = kInvalidId;
  }

  /// Materials are looked up after all libraries are read, because a library may follow the faces
  /// that use it.
  void use_material() {
    material_name_ = trim(lines_.rest());
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
    for (const std::string& names : libraries_) materials_.add(names);
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
    fill_vertices(merger.vertices(), group.smoothing, mesh);
    mesh.materials = std::move(group.materials);
    const std::uint32_t first = mesh.materials.front();
    const bool uniform = std::all_of(mesh.materials.begin(), mesh.materials.end(),
                                     [&](std::uint32_t m) { return m == first; });
    if (uniform) mesh.materials.resize(1);
    return mesh;
  }

  void fill_vertices(const std::vector<Corner>& vertices,
                     const std::vector<std::uint32_t>& smoothing, Mesh& mesh) const {
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
    if (!all_normals) add_missing_normals(mesh, has_normal, smoothing);
  }

  ObjLines lines_;
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
  std::vector<std::string> libraries_;
  std::uint32_t smoothing_ = kByAngle;
  std::unordered_map<std::string, std::uint32_t> smoothing_of_;
  bool names_nothing_ = false, is_in_bytes_ = false, has_commas_ = false, points_or_lines_ = false,
       curves_ = false, odd_normals_ = false, odd_uvs_ = false, short_faces_ = false;
  std::size_t odd_faces_ = 0;
  std::array<double, 6> numbers_{};
  std::vector<Corner> face_;
  std::vector<Vec3> points_;
  std::optional<VertexMerger> merger_;
};

}  // namespace

SceneDescription load_obj(const Bytes& file, const SceneFile& from) {
  SceneDescription scene;
  scene.name = stem_of(from.path);
  MtlLibrary materials(from, scene);
  ObjReader reader(text_of(file), materials);
  reader.run();
  reader.warn(scene.warnings);
  scene.meshes = reader.build_meshes();
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    scene.instances.push_back({scene.meshes[m].name, m, {}});
  }
  if (reader.has_colors()) materials.whiten_fallback();
  materials.finish();
  return scene;
}

}  // namespace raysheaf::io
