#include "io/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "io/linear.h"
#include "io/normals.h"
#include "io/ply_body.h"
#include "io/polygon.h"
#include "io/srgb.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// For each of `triangles_at_once`, which a file may have to be read whole.
constexpr std::uint64_t kSmallBytes = 16;
/// That a list may have, whatever is to be held.
constexpr std::uint32_t kAlwaysCorners = 4096;

std::string stem_of(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

/// The largest code of a colour of this type. Bytes and words are used whole; programs that write
/// wider ones, or bytes with a sign, mean bytes.
std::size_t largest_code(PlyType type) {
  if (type == PlyType::kUint16) return 65535;
  return type == PlyType::kInt16 ? 32767 : 255;
}

/// What each code of sRGB is, of those up to `largest`.
std::vector<float> linear_of_codes(std::size_t largest) {
  std::vector<float> linear;
  for (std::size_t code = 0; code <= largest; ++code) {
    const double part = static_cast<double>(code) / static_cast<double>(largest);
    linear.push_back(static_cast<float>(linear_of_srgb(part)));
  }
  return linear;
}

/// Fills a mesh, `Mesh` or `OuterMesh`, and the rest of its scene.
template <class AnyMesh>
class PlyReader {
 public:
  PlyReader(PlyNumbers numbers, const PlyHeader& header, AnyMesh& mesh, SceneDescription& scene)
      : header_(header), numbers_(std::move(numbers)), mesh_(mesh), scene_(scene) {}

  /// `most_corners`: of a list; more are not read.
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
    scene_.materials.push_back(material());
    mesh_.materials.push_back(0);
    mesh_.name = scene_.name = name;
    scene_.instances.push_back({name, 0, {}});
  }
  /// One a vertex, where every vertex has one.
  [[nodiscard]] bool has_normals() const { return has_normals_ && all_normals_; }
  /// Whether each vertex has one; empty where none has, and of an `OuterMesh`.
  [[nodiscard]] const std::vector<bool>& has_normal() const { return has_normal_; }

 private:
  enum Role { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kAlpha, kRoles };

  static int role_of(const PlyProperty& property) {
    constexpr std::pair<std::string_view, Role> kNames[] = {{"x", kX},
                                                            {"y", kY},
                                                            {"z", kZ},
                                                            {"nx", kNormalX},
                                                            {"ny", kNormalY},
                                                            {"nz", kNormalZ},
                                                            {"red", kRed},
                                                            {"green", kGreen},
                                                            {"blue", kBlue},
                                                            {"diffuse_red", kRed},
                                                            {"diffuse_green", kGreen},
                                                            {"diffuse_blue", kBlue},
                                                            {"alpha", kAlpha},
                                                            {"diffuse_alpha", kAlpha}};
    if (property.is_list) return -1;
    for (const auto& [name, role] : kNames) {
      if (property.name == name) return role;
    }
    return -1;
  }

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
    has_colors_ = has[kRed] && has[kGreen] && has[kBlue];
    if (has_colors_ && color_type < PlyType::kFloat32)
      linear_of_code_ = linear_of_codes(largest_code(color_type));
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
      scene_.warnings.emplace_back("The alpha of vertices is left out: the surface is whole.");
  }

  void add_vertex(const std::array<double, kRoles>& values, std::uint64_t index) {
    const Vec3 position = narrow(Double3{values[kX], values[kY], values[kZ]});
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
      throw Error(ErrorCode::kInvalidData, "the position is not finite",
                  "vertex[" + std::to_string(index) + "]");
    }
    mesh_.positions.push_back(position);
    if (has_normals_)
      add_normal(narrow(Double3{values[kNormalX], values[kNormalY], values[kNormalZ]}));
    if (has_colors_) add_color({values[kRed], values[kGreen], values[kBlue]}, index);
  }

  /// A colour's part; integers are codes of sRGB.
  [[nodiscard]] float channel(double x) const {
    if (!std::isfinite(x)) return 0;
    if (linear_of_code_.empty()) return static_cast<float>(std::clamp(x, 0.0, 1.0));
    const auto largest = static_cast<double>(linear_of_code_.size() - 1);
    return linear_of_code_[static_cast<std::size_t>(std::clamp(x, 0.0, largest))];
  }

  /// One for all becomes the material's, so that they are kept from the first that differs on.
  void add_color(Double3 raw, std::uint64_t index) {
    const Vec3 color{channel(raw.x), channel(raw.y), channel(raw.z)};
    if (index == 0) color_ = color;
    const bool same = color.x == color_.x && color.y == color_.y && color.z == color_.z;
    if (mesh_.colors.empty() && same) return;
    if (mesh_.colors.empty()) mesh_.colors.resize(index, color_);
    mesh_.colors.push_back(color);
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
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == static_cast<std::size_t>(corners))
          read_list(property, element.name, i, strips);
        else
          numbers_.skip(property, element.name, i);
      }
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
      if (!(vertex >= 0) || vertex >= static_cast<double>(mesh_.positions.size()) ||
          vertex != std::floor(vertex)) {
        throw Error(ErrorCode::kInvalidData,
                    "the vertex index is out of range: there are " +
                        std::to_string(mesh_.positions.size()) + " vertices",
                    element + "[" + std::to_string(index) + "]." + list.name + "[" +
                        std::to_string(i) + "]");
      }
      corners_.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (strip)
      add_strip();
    else
      add_face();
  }

  void add_strip() {
    for (std::size_t i = 0; i + 2 < corners_.size(); ++i) {
      mesh_.triangles.push_back({corners_[i], corners_[i + 1 + i % 2], corners_[i + 2 - i % 2]});
    }
    corners_.clear();
  }
  void add_face() {
    short_faces_ = short_faces_ || corners_.size() < 3;
    if (corners_.size() == 3) {
      mesh_.triangles.push_back({corners_[0], corners_[1], corners_[2]});
      return;
    }
    points_.clear();
    for (const std::uint32_t v : corners_) points_.push_back(mesh_.positions[v]);
    for (const auto& t : triangulate(points_)) {
      mesh_.triangles.push_back({corners_[t[0]], corners_[t[1]], corners_[t[2]]});
    }
  }

  Material material() {
    Material material;
    material.name = "default";
    material.double_sided = true;
    material.base_color = {0.8f, 0.8f, 0.8f, 1};
    if (!has_colors_ || mesh_.positions.empty()) return material;
    const Vec3 color = mesh_.colors.empty() ? color_ : Vec3{1, 1, 1};
    material.base_color = {color.x, color.y, color.z, 1};
    return material;
  }

  static constexpr bool kHeld = std::is_same_v<AnyMesh, Mesh>;

  const PlyHeader& header_;
  PlyNumbers numbers_;
  AnyMesh& mesh_;
  SceneDescription& scene_;
  std::uint64_t most_corners_ = 0;
  std::vector<bool> has_normal_;
  bool has_normals_ = false, all_normals_ = true, has_colors_ = false;
  bool short_faces_ = false;
  std::vector<float> linear_of_code_;  ///< empty where colours are floats
  Vec3 color_;                         ///< the first vertex's
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> points_;
};

}  // namespace

SceneDescription load_ply(const Bytes& file, const SceneFile& from) {
  const PlyHeader header = read_ply_header(file, file.size());
  SceneDescription scene;
  Mesh& mesh = scene.meshes.emplace_back();
  PlyReader reader(PlyNumbers(file, header), header, mesh, scene);
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
  if (header.format == PlyFormat::kAscii) return std::nullopt;
  OuterScene scene;
  scene.columns = std::make_unique<OuterColumns>(options);
  OuterMesh& mesh = scene.meshes.emplace_back(scene.columns.get());
  PlyReader reader(PlyNumbers(file, header), header, mesh, scene.rest);
  reader.read(stem_of(path), std::max(options.triangles_at_once, kAlwaysCorners));
  if (mesh.triangles.size() >= kInvalidId) throw NeedsWholeFile{};
  if (!reader.has_normals()) add_missing_normals(mesh, options);
  scene.rest.meshes.emplace_back().name = mesh.name;
  scene.rest.files = {path};
  return scene;
}

}  // namespace raysheaf::io
