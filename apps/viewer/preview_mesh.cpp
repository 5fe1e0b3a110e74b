#include "preview_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr float kSeeThrough = 0.5f;  ///< transmission from which a material is drawn as glass
constexpr float kBlendCutoff = 0.5f;

Vec3 moved(const Affine& a, Vec3 p) {
  return column(a, 0) * p.x + column(a, 1) * p.y + column(a, 2) * p.z + column(a, 3);
}

void grow(Box* box, Vec3 p) {
  box->min = {std::min(box->min.x, p.x), std::min(box->min.y, p.y), std::min(box->min.z, p.z)};
  box->max = {std::max(box->max.x, p.x), std::max(box->max.y, p.y), std::max(box->max.z, p.z)};
}

/// Columns of the matrix that moves normals, up to a factor: the cofactors.
std::array<Vec3, 3> cofactors(const Affine& a) {
  const Vec3 x = column(a, 0), y = column(a, 1), z = column(a, 2);
  return {cross(y, z), cross(z, x), cross(x, y)};
}

std::array<std::int8_t, 4> packed_normal(Vec3 n) {
  const auto part = [](float v) {
    return static_cast<std::int8_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 127));
  };
  return {part(n.x), part(n.y), part(n.z), 0};
}

std::uint8_t root_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(std::sqrt(std::clamp(linear, 0.0f, 1.0f)) * 255));
}

/// The mean of each square of `factor` by `factor` pixels.
Image reduced(const Image& image, std::uint32_t factor) {
  Image small;
  small.width = std::max(1u, image.width / factor);
  small.height = std::max(1u, image.height / factor);
  small.rgba.resize(std::size_t{4} * small.width * small.height);
  for (std::uint32_t y = 0; y < small.height; ++y) {
    for (std::uint32_t x = 0; x < small.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      std::uint32_t count = 0;
      for (std::uint32_t v = y * factor; v < std::min((y + 1) * factor, image.height); ++v) {
        for (std::uint32_t u = x * factor; u < std::min((x + 1) * factor, image.width); ++u) {
          const std::size_t at = 4 * (std::size_t{v} * image.width + u);
          for (std::size_t c = 0; c < 4; ++c) sum[c] += image.rgba[at + c];
          ++count;
        }
      }
      const std::size_t to = 4 * (std::size_t{y} * small.width + x);
      for (std::size_t c = 0; c < 4; ++c)
        small.rgba[to + c] = static_cast<std::uint8_t>(sum[c] / std::max(count, 1u));
    }
  }
  return small;
}

Image small_image(const Image& image) {
  const std::uint32_t side = std::max(image.width, image.height);
  return reduced(image, (side + kPreviewTextureSide - 1) / kPreviewTextureSide);
}

Vec2 placed(const TextureSlot& slot, Vec2 uv) {
  const float x = uv.x * slot.scale.x, y = uv.y * slot.scale.y;
  const float c = std::cos(slot.rotation), s = std::sin(slot.rotation);
  return {c * x + s * y + slot.offset.x, c * y - s * x + slot.offset.y};
}

class Builder {
 public:
  explicit Builder(const SceneDescription& scene) : scene_(scene) {
    indices_.resize(scene.materials.size() + 1);  // the last ones have no material
    groups_.resize(indices_.size());
  }

  void add(const Instance& instance) {
    const Mesh& mesh = scene_.meshes[instance.mesh];
    const bool mirrored = dot(cross(column(instance.to_world, 0), column(instance.to_world, 1)),
                              column(instance.to_world, 2)) < 0;
    // A vertex has one position in the textures, so that each material has its own vertices.
    std::map<std::size_t, std::uint32_t> first_of;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::size_t material = material_of(mesh, i);
      auto [found, is_new] = first_of.try_emplace(material, 0);
      if (is_new) found->second = add_vertices(mesh, instance.to_world, material, mirrored);
      std::array<std::uint32_t, 3> corners = mesh.triangles[i];
      if (mirrored) std::swap(corners[1], corners[2]);
      PreviewGroup& group = group_for(material, is_new);
      for (const std::uint32_t corner : corners) {
        const Vec3 at = mesh_.vertices[found->second + corner].position;
        grow(&group.box, at);
        indices_[material].push_back(found->second + corner);
      }
      group.count += 3;
    }
  }

  [[nodiscard]] PreviewMesh finish() {
    for (const bool see_through : {false, true}) {
      for (std::size_t m = 0; m < indices_.size(); ++m) {
        PreviewDraw draw = look_of(m);
        if (indices_[m].empty() || draw.see_through != see_through) continue;
        const auto first = static_cast<std::uint32_t>(mesh_.indices.size());
        draw.groups = std::move(groups_[m]);
        for (PreviewGroup& group : draw.groups) group.first += first;
        mesh_.indices.insert(mesh_.indices.end(), indices_[m].begin(), indices_[m].end());
        mesh_.draws.push_back(draw);
      }
    }
    return std::move(mesh_);
  }

 private:
  /// Where the next triangle of this material belongs.
  PreviewGroup& group_for(std::size_t material, bool is_new_instance) {
    std::vector<PreviewGroup>& groups = groups_[material];
    if (is_new_instance || groups.back().count == 3 * kPreviewGroup)
      groups.push_back({static_cast<std::uint32_t>(indices_[material].size()), 0, {}});
    return groups.back();
  }

  [[nodiscard]] std::size_t material_of(const Mesh& mesh, std::size_t triangle) const {
    if (mesh.materials.empty()) return scene_.materials.size();
    const std::size_t which = mesh.materials.size() == 1 ? 0 : triangle;
    return std::min<std::size_t>(mesh.materials[which], scene_.materials.size());
  }

  /// Surfaces that emit an image without a colour of their own: screens.
  [[nodiscard]] static bool glows(const Material& material) {
    return material.emission_texture.texture != kInvalidId &&
           material.base_color_texture.texture == kInvalidId;
  }
  [[nodiscard]] TextureSlot slot_of(std::size_t m) const {
    if (m >= scene_.materials.size()) return {};
    const Material& material = scene_.materials[m];
    return glows(material) ? material.emission_texture : material.base_color_texture;
  }

  std::uint32_t add_vertices(const Mesh& mesh, const Affine& to_world, std::size_t material,
                             bool mirrored) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    const TextureSlot slot = slot_of(material);
    const bool second = slot.second_uvs && !mesh.second_uvs.empty();
    const std::vector<Vec2>& uvs = second ? mesh.second_uvs : mesh.uvs;
    const std::array<Vec3, 3> turn = cofactors(to_world);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      PreviewVertex& vertex = mesh_.vertices.emplace_back();
      vertex.position = moved(to_world, mesh.positions[i]);
      if (!mesh.normals.empty()) {
        const Vec3 n = mesh.normals[i];
        const Vec3 turned = normalized(turn[0] * n.x + turn[1] * n.y + turn[2] * n.z);
        vertex.normal = packed_normal(mirrored ? turned * -1.0f : turned);
      }
      if (!uvs.empty()) vertex.uv = placed(slot, uvs[i]);
      const Vec3 color = mesh.colors.empty() ? Vec3{1, 1, 1} : mesh.colors[i];
      vertex.color = {root_byte(color.x), root_byte(color.y), root_byte(color.z), 255};
    }
    return first;
  }

  PreviewDraw look_of(std::size_t m) {
    PreviewDraw draw;
    if (m >= scene_.materials.size()) return draw;
    const Material& material = scene_.materials[m];
    draw.color = {material.base_color.x, material.base_color.y, material.base_color.z};
    draw.unlit = material.unlit || glows(material);
    if (glows(material)) {
      draw.color = material.emission;
    } else {
      draw.emission = material.emission;
    }
    draw.double_sided = material.double_sided;
    draw.see_through = material.transmission >= kSeeThrough;
    draw.alpha_cutoff = material.alpha_blend ? kBlendCutoff : material.alpha_cutoff;
    if (!indices_[m].empty()) draw.texture = texture_of(slot_of(m));
    return draw;
  }

  std::uint32_t texture_of(const TextureSlot& slot) {
    if (slot.texture >= scene_.textures.size()) return kInvalidId;
    const Texture& texture = scene_.textures[slot.texture];
    if (texture.image >= scene_.images.size() || scene_.images[texture.image].rgba.empty())
      return kInvalidId;
    auto [found, is_new] = textures_.try_emplace(slot.texture, 0);
    if (is_new) {
      found->second = static_cast<std::uint32_t>(mesh_.textures.size());
      mesh_.textures.push_back(
          {small_image(scene_.images[texture.image]), texture.wrap_u, texture.wrap_v});
    }
    return found->second;
  }

  const SceneDescription& scene_;
  PreviewMesh mesh_;
  std::vector<std::vector<std::uint32_t>> indices_;  ///< of each material
  std::vector<std::vector<PreviewGroup>> groups_;    ///< of `indices_`
  std::map<std::uint32_t, std::uint32_t> textures_;  ///< by the scene's number
};

}  // namespace

PreviewMesh preview_mesh(const SceneDescription& scene) {
  if (scene.triangle_count() > kMostPreviewTriangles) return {};
  Builder builder(scene);
  for (const Instance& instance : scene.instances) builder.add(instance);
  return builder.finish();
}

}  // namespace raysheaf::viewer
