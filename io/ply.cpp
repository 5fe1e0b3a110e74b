#include "io/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <type_traits>
#include <utility>

#include "io/file.h"
#include "io/linear.h"
#include "io/normals.h"
#include "io/ply_body.h"
#include "io/ply_colors.h"
#include "io/ply_corners.h"
#include "io/ply_look.h"
#include "io/polygon.h"
#include "io/text_lines.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// Files with at most this many bytes per `triangles_at_once` may be read whole.
constexpr std::uint64_t kSmallBytes = 16;
/// Lists may always have this many corners, whatever the memory limit.
constexpr std::uint32_t kAlwaysCorners = 4096;

/// Fills a `Mesh` or an `OuterMesh` and the rest of its scene.
template <class AnyMesh>
class PlyReader {
 public:
  using Numbers = std::conditional_t<std::is_same_v<AnyMesh, Mesh>, std::vector<std::uint32_t>,
                                     OuterArray<std::uint32_t>>;

  /// `newest` and `previous` must be empty; `CornerSplitter` uses them.
  PlyReader(PlyNumbers numbers, const PlyHeader& header, AnyMesh& mesh, SceneDescription& scene,
            Numbers& newest, Numbers& previous)
      : header_(header),
        numbers_(std::move(numbers)),
        mesh_(mesh),
        scene_(scene),
        splitter_(mesh, newest, previous) {}

  /// Call it before `read`: vertex colours are shown only if there are no images.
  void read_textures(const SceneFile& from) { textures_.read(header_, from, scene_); }

  /// `most_corners`: the longest list that is read.
  void read(const std::string& name, std::uint64_t most_corners) {
    most_corners_ = most_corners;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex" && mesh_.positions.empty())
        read_vertices(element);
      else if (element.name == "face")
        read_lists(element, false);
      else if (element.name == "tristrips")
        read_lists(element, true);
      else
        skip(element);
    }
    if (short_faces_) {
      scene_.warnings.push_back("Faces with fewer than three vertices are left out.");
    }
    warn_of_odd_faces(odd_faces_, !mesh_.triangles.empty(), scene_.warnings);
    if (numbers_.has_commas()) scene_.warnings.emplace_back(kCommaRemark);
    replace_odd_vertices();
    scale_colors();
    if (mesh_.triangles.empty()) uses_plain_ = true;
    textures_.add_materials(plain_color(), uses_plain_, scene_);
    if (mesh_.materials.empty()) mesh_.materials.push_back(material_of_first_);
    mesh_.name = scene_.name = name;
    scene_.instances.push_back({name, 0, {}});
  }
  /// Whether every vertex has a normal.
  [[nodiscard]] bool has_normals() const { return has_normals_ && all_normals_; }
  /// Whether each vertex has a normal. Empty if none has, and for an `OuterMesh`.
  [[nodiscard]] const std::vector<bool>& has_normal() const { return has_normal_; }

 private:
  void read_vertices(const PlyElement& element) {
    std::vector<int> roles;
    std::array<bool, kRoles> has{};
    PlyType color_type = PlyType::kFloat32, alpha_type = PlyType::kFloat32;
    for (const PlyProperty& property : element.properties) {
      roles.push_back(role_of(property));
      if (roles.back() >= 0) has[static_cast<std::size_t>(roles.back())] = true;
      if (roles.back() == kRed) color_type = property.type;
      if (roles.back() == kAlpha) alpha_type = property.type;
    }
    if (!has[kX] || !has[kY] || !has[kZ]) {
      throw Error(ErrorCode::kInvalidData, "has no x, y and z", "element vertex");
    }
    if (element.count >= kInvalidId) {
      throw Error(ErrorCode::kUnsupported, "has 2^32 vertices or more", "element vertex");
    }
    has_normals_ = has[kNormalX] && has[kNormalY] && has[kNormalZ];
    has_uvs_ = textures_.any() && has[kU] && has[kV];
    has_colors_ = has[kRed] && has[kGreen] && has[kBlue] && shows_colors();
    if (has_colors_) colors_ = PlyColors(color_type);
    if constexpr (kHeld) mesh_.positions.reserve(element.count);
    const double opaque =
        alpha_type < PlyType::kFloat32 ? static_cast<double>(largest_code(alpha_type)) : 1;
    bool is_thin = false;
    std::array<double, kRoles> values{};
    values[kAlpha] = opaque;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < roles.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (roles[p] < 0)
          numbers_.skip(property, element.name, i);
        else
          values[static_cast<std::size_t>(roles[p])] = numbers_.next(property.type, "vertex", i);
      }
      add_vertex(values, i);
      is_thin |= values[kAlpha] < opaque;
    }
    if (is_thin)
      scene_.warnings.emplace_back("The alpha of vertices is left out: the surface is opaque.");
  }

  void add_vertex(const std::array<double, kRoles>& values, std::uint64_t index) {
    const Vec3 position = narrow(Double3{values[kX], values[kY], values[kZ]});
    if (!is_finite(position)) odd_vertices_.push_back(static_cast<std::uint32_t>(index));
    mesh_.positions.push_back(position);
    if (has_normals_)
      add_normal(narrow(Double3{values[kNormalX], values[kNormalY], values[kNormalZ]}));
    if (has_uvs_) mesh_.uvs.push_back(uv_of(values[kU], values[kV]));
    if (has_colors_) add_color(colors_.color(values[kRed], values[kGreen], values[kBlue]), index);
  }

  /// In PLY, `v` counts from the bottom row.
  static Vec2 uv_of(double u, double v) {
    const Vec2 uv{static_cast<float>(u), static_cast<float>(1 - v)};
    return std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : Vec2{};
  }

  /// Textures take precedence over colours.
  bool shows_colors() {
    if (textures_.any() && !std::exchange(warned_of_colors_, true))
      scene_.warnings.emplace_back("Colours of a mesh with textures are left out.");
    return !textures_.any();
  }

  /// A colour that all vertices share becomes the material's. From the first vertex that differs,
  /// each has its own.
  void add_color(Vec3 color, std::uint64_t index) {
    if (index == 0) color_ = color;
    const bool same = color.x == color_.x && color.y == color_.y && color.z == color_.z;
    if (mesh_.colors.empty() && same) return;
    if (mesh_.colors.empty()) mesh_.colors.resize(index, color_);
    mesh_.colors.push_back(color);
  }

  /// Called when all colours are known.
  void scale_colors() {
    if (!colors_.needs_scale()) return;
    if (colors_.is_in_bytes()) scene_.warnings.emplace_back(kBytesRemark);
    color_ = colors_.scaled(color_);
    for (std::uint64_t v = 0; v < mesh_.colors.size(); ++v)
      put(mesh_.colors, v, colors_.scaled(mesh_.colors[v]));
  }

  void add_normal(Vec3 normal) {
    const bool has = make_unit(normal);
    all_normals_ = all_normals_ && has;
    mesh_.normals.push_back(has ? normal : kHeld ? Vec3{0, 0, 1} : Vec3{});
    if constexpr (kHeld) has_normal_.push_back(has);
  }

  void skip(const PlyElement& element) {
    if (element.count > 0) {
      scene_.warnings.push_back("The PLY element \"" + element.name.substr(0, 64) +
                                "\" is left out.");
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        numbers_.skip(property, element.name, i);
      }
    }
  }

  void read_lists(const PlyElement& element, bool strips) {
    vertex_count_ = static_cast<double>(
        header_.find("vertex") == nullptr ? std::uint64_t{0} : header_.find("vertex")->count);
    const int plural = element.find("vertex_indices"), singular = element.find("vertex_index");
    const int corners = plural >= 0 ? plural : singular;
    if (corners < 0 || !element.properties[static_cast<std::size_t>(corners)].is_list) {
      throw Error(ErrorCode::kInvalidData, "has no list vertex_indices", "element " + element.name);
    }
    if (element.count > 0 && mesh_.positions.empty()) {
      throw Error(ErrorCode::kInvalidData,
                  "there are no vertices before it; element vertex is first",
                  "element " + element.name);
    }
    const bool is_plain = strips || !begin_faces(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == static_cast<std::size_t>(corners))
          read_list(property, element.name, i, strips);
        else if (is_plain)
          numbers_.skip(property, element.name, i);
        else
          read_of_face(property, element.name, i);
      }
      if (strips || leaves_out_face()) continue;
      if (!is_plain) split_corners();
      add_face();
    }
  }

  /// Whether faces have colours, texture coordinates or materials of their own.
  bool begin_faces(const PlyElement& element) {
    const auto has = [&](const char* name) { return element.find(name) >= 0; };
    const int red = element.find("red");
    faces_have_uvs_ = textures_.any() && has("texcoord");
    const bool has_colors = red >= 0 && has("green") && has("blue");
    faces_have_colors_ = has_colors && !has_colors_ && shows_colors();
    if (has_colors && has_colors_)
      scene_.warnings.emplace_back(
          "The colours of vertices are used, those of faces are left out.");
    if (faces_have_colors_)
      colors_ = PlyColors(element.properties[static_cast<std::size_t>(red)].type);
    if (faces_have_uvs_ || faces_have_colors_) splitter_.begin(faces_have_uvs_, faces_have_colors_);
    return faces_have_uvs_ || faces_have_colors_ || (textures_.any() && has("texnumber"));
  }

  void read_of_face(const PlyProperty& property, const std::string& element, std::uint64_t index) {
    const int role = role_of(property);
    if (property.is_list && property.name == "texcoord" && faces_have_uvs_) {
      const std::uint64_t count = numbers_.next_count(property, element, index);
      if (count > 2 * most_corners_) throw NeedsWholeFile{};
      face_uvs_.clear();
      for (std::uint64_t i = 0; i < count; ++i)
        face_uvs_.push_back(numbers_.next(property.type, element, index));
    } else if (role >= 0) {
      of_face_[static_cast<std::size_t>(role)] = numbers_.next(property.type, element, index);
    } else {
      numbers_.skip(property, element, index);
    }
  }

  /// Gives the corners of a face vertices with the face's colour and texture coordinates.
  void split_corners() {
    has_face_uvs_ = !faces_have_uvs_ || (face_uvs_.size() == 2 * corners_.size());
    material_ =
        has_face_uvs_ ? textures_.material_of(of_face_[kTexture]) : textures_.plain_material();
    if (!faces_have_uvs_ && !faces_have_colors_) return;
    const Vec3 color = colors_.color(of_face_[kRed], of_face_[kGreen], of_face_[kBlue]);
    const auto copied = [this](std::uint32_t vertex) {
      if (!has_normal_.empty()) has_normal_.push_back(has_normal_[vertex]);
    };
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const bool has_uv = faces_have_uvs_ && has_face_uvs_;
      const Vec2 uv = has_uv ? uv_of(face_uvs_[2 * i], face_uvs_[2 * i + 1]) : Vec2{};
      corners_[i] = splitter_.vertex_with(
          corners_[i], {faces_have_uvs_ ? &uv : nullptr, faces_have_colors_ ? &color : nullptr},
          copied);
    }
  }
  void read_list(const PlyProperty& list, const std::string& element, std::uint64_t index,
                 bool strip) {
    const std::uint64_t count = numbers_.next_count(list, element, index);
    if (count > most_corners_) throw NeedsWholeFile{};
    corners_.clear();
    for (std::uint64_t i = 0; i < count; ++i) {
      const double vertex = numbers_.next(list.type, element, index);
      if (strip && vertex == -1) {
        add_strip();
        continue;
      }
      if (!(vertex >= 0) || vertex >= vertex_count_ || vertex != std::floor(vertex)) {
        throw Error(ErrorCode::kInvalidData,
                    "the vertex index is out of range: there are " +
                        std::to_string(static_cast<std::uint64_t>(vertex_count_)) + " vertices",
                    element + "[" + std::to_string(index) + "]." + list.name + "[" +
                        std::to_string(i) + "]");
      }
      corners_.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (strip) add_strip();
  }

  /// A material that all triangles share is a single entry. From the first triangle that differs,
  /// each has its own.
  void add_triangle(const std::array<std::uint32_t, 3>& corners) {
    if (mesh_.triangles.empty()) material_of_first_ = material_;
    if (mesh_.materials.empty() && material_ != material_of_first_)
      mesh_.materials.resize(mesh_.triangles.size(), material_of_first_);
    mesh_.triangles.push_back(corners);
    uses_plain_ = uses_plain_ || material_ == textures_.plain_material();
    if (!mesh_.materials.empty()) mesh_.materials.push_back(material_);
  }
  /// Whether all of these vertices are finite.
  [[nodiscard]] bool are_finite(std::span<const std::uint32_t> vertices) const {
    return odd_vertices_.empty() ||
           std::all_of(vertices.begin(), vertices.end(),
                       [&](std::uint32_t v) { return is_finite(Vec3(mesh_.positions[v])); });
  }
  bool leaves_out_face() {
    if (are_finite(corners_)) return false;
    ++odd_faces_;
    return true;
  }
  /// Vertices that are not finite, which no face uses, get the position of one that a face uses.
  void replace_odd_vertices() {
    if (odd_vertices_.empty() || mesh_.triangles.empty()) return;
    const std::array<std::uint32_t, 3> triangle = mesh_.triangles[0];
    const Vec3 used = mesh_.positions[triangle[0]];
    for (const std::uint32_t v : odd_vertices_) put(mesh_.positions, v, used);
  }
  void add_strip() {
    for (std::size_t i = 0; i + 2 < corners_.size(); ++i) {
      if (are_finite(std::span(corners_).subspan(i, 3)))
        add_triangle({corners_[i], corners_[i + 1 + i % 2], corners_[i + 2 - i % 2]});
      else
        ++odd_faces_;
    }
    corners_.clear();
  }
  void add_face() {
    short_faces_ = short_faces_ || corners_.size() < 3;
    if (corners_.size() == 3) {
      add_triangle({corners_[0], corners_[1], corners_[2]});
      return;
    }
    points_.clear();
    for (const std::uint32_t v : corners_) points_.push_back(mesh_.positions[v]);
    for (const auto& t : triangulate(points_)) {
      add_triangle({corners_[t[0]], corners_[t[1]], corners_[t[2]]});
    }
  }

  [[nodiscard]] Vec3 plain_color() const {
    if (!(has_colors_ || faces_have_colors_) || mesh_.positions.empty()) return {0.8f, 0.8f, 0.8f};
    return mesh_.colors.empty() ? color_ : Vec3{1, 1, 1};
  }

  static constexpr bool kHeld = std::is_same_v<AnyMesh, Mesh>;

  const PlyHeader& header_;
  PlyNumbers numbers_;
  AnyMesh& mesh_;
  SceneDescription& scene_;
  std::uint64_t most_corners_ = 0;
  std::vector<bool> has_normal_;
  bool has_normals_ = false, all_normals_ = true, has_colors_ = false;
  bool short_faces_ = false, has_uvs_ = false, warned_of_colors_ = false;
  bool faces_have_uvs_ = false, faces_have_colors_ = false, has_face_uvs_ = true,
       uses_plain_ = false;
  PlyColors colors_;
  Vec3 color_;  ///< the first vertex's colour
  PlyTextures textures_;
  /// The materials of the current face and of the first triangle.
  std::uint32_t material_ = 0, material_of_first_ = 0;
  CornerSplitter<AnyMesh, Numbers> splitter_;
  std::array<double, kRoles> of_face_{};
  std::vector<double> face_uvs_;
  double vertex_count_ = 0;
  std::vector<std::uint32_t> odd_vertices_;  ///< those that are not finite
  std::uint64_t odd_faces_ = 0;
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> points_;
};

}  // namespace

SceneDescription load_ply(const Bytes& file, const SceneFile& from) {
  const PlyHeader header = read_ply_header(file, file.size());
  check_faces(header);
  SceneDescription scene;
  Mesh& mesh = scene.meshes.emplace_back();
  std::vector<std::uint32_t> newest, previous;
  PlyReader<Mesh> reader(PlyNumbers(file, header), header, mesh, scene, newest, previous);
  reader.read_textures(from);
  reader.read(stem_of(from.path), file.size());
  if (!reader.has_normals()) add_missing_normals(mesh, reader.has_normal());
  return scene;
}

std::optional<OuterScene> read_outer_ply(const std::string& path, const PackOptions& options) {
  const FileReader file(path);
  if (file.size() <= kSmallBytes * options.triangles_at_once) return std::nullopt;
  Bytes head(std::min<std::uint64_t>(file.size(), kMaxPlyHeaderBytes + 1));
  file.read(0, head, "");
  const PlyHeader header = read_ply_header(head, file.size());
  head = {};
  check_faces(header);
  if (header.format == PlyFormat::kAscii) return std::nullopt;
  OuterScene scene;
  scene.columns = std::make_unique<OuterColumns>(options);
  OuterMesh& mesh = scene.meshes.emplace_back(scene.columns.get());
  OuterArray<std::uint32_t> newest(options.beside, options.triangles_at_once / 4),
      previous(options.beside, options.triangles_at_once / 4);
  PlyReader<OuterMesh> reader(PlyNumbers(file, header), header, mesh, scene.rest, newest, previous);
  std::set<std::string> names;
  const SceneFile from{path, options.allow_external, nullptr, &names};
  reader.read_textures(from);
  reader.read(stem_of(path), std::max(options.triangles_at_once, kAlwaysCorners));
  if (mesh.triangles.size() >= kInvalidId) throw NeedsWholeFile{};
  if (!reader.has_normals()) add_missing_normals(mesh, options);
  scene.rest.meshes.emplace_back().name = mesh.name;
  scene.rest.files = files_of(from);
  return scene;
}

}  // namespace raysheaf::io
