// The promises about the built-in scenes: sizes, validity, the same bits every time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "base/vec.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::size_t triangle_count(const SceneDescription& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances)
    count += scene.meshes[instance.mesh].triangles.size();
  return count;
}

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_bits(const Affine& a, const Affine& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

class BuiltinScene : public testing::TestWithParam<std::string> {
 protected:
  SceneDescription scene_ = builtin_scene(GetParam());
};

INSTANTIATE_TEST_SUITE_P(All, BuiltinScene, testing::ValuesIn(builtin_scene_names()),
                         [](const auto& test) { return test.param; });

TEST_P(BuiltinScene, IsNamedAndHasACameraAndALight) {
  EXPECT_EQ(scene_.name, GetParam());
  ASSERT_GE(scene_.cameras.size(), 1u);
  ASSERT_GE(scene_.lights.size(), 1u);
  EXPECT_EQ(scene_.lights[0].type, Light::Type::kPoint);
  EXPECT_TRUE(scene_.warnings.empty());
}

TEST_P(BuiltinScene, HasTheSameBitsEveryTime) {
  const SceneDescription again = builtin_scene(GetParam());
  ASSERT_EQ(scene_.meshes.size(), again.meshes.size());
  for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
    const Mesh &a = scene_.meshes[i], &b = again.meshes[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_TRUE(same_bits(a.positions, b.positions) && same_bits(a.normals, b.normals) &&
                same_bits(a.uvs, b.uvs) && same_bits(a.triangles, b.triangles) &&
                same_bits(a.materials, b.materials))
        << a.name;
  }
  ASSERT_EQ(scene_.instances.size(), again.instances.size());
  for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
    EXPECT_EQ(scene_.instances[i].mesh, again.instances[i].mesh);
    EXPECT_TRUE(same_bits(scene_.instances[i].to_world, again.instances[i].to_world));
  }
  ASSERT_EQ(scene_.images.size(), again.images.size());
  for (std::size_t i = 0; i < scene_.images.size(); ++i) {
    EXPECT_EQ(scene_.images[i].rgba, again.images[i].rgba);
  }
}

TEST_P(BuiltinScene, IndicesAreInRange) {
  for (const Instance& instance : scene_.instances) EXPECT_LT(instance.mesh, scene_.meshes.size());
  for (const Mesh& mesh : scene_.meshes) {
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
    EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size()) << mesh.name;
    EXPECT_TRUE(mesh.materials.size() == 1 || mesh.materials.size() == mesh.triangles.size())
        << mesh.name;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle)
        EXPECT_LT(vertex, mesh.positions.size()) << mesh.name;
    }
    for (const std::uint32_t material : mesh.materials)
      EXPECT_LT(material, scene_.materials.size());
  }
  for (const Material& material : scene_.materials) {
    for (const TextureSlot& slot : {material.base_color_texture, material.emission_texture}) {
      EXPECT_TRUE(slot.texture == kInvalidId || slot.texture < scene_.textures.size())
          << material.name;
    }
  }
  for (const Texture& texture : scene_.textures) EXPECT_LT(texture.image, scene_.images.size());
  for (const Image& image : scene_.images) {
    EXPECT_EQ(image.rgba.size(), std::size_t{4} * image.width * image.height) << image.name;
  }
}

TEST_P(BuiltinScene, EveryMeshAndMaterialIsUsed) {
  std::set<std::uint32_t> meshes, materials;
  for (const Instance& instance : scene_.instances) meshes.insert(instance.mesh);
  for (const Mesh& mesh : scene_.meshes)
    materials.insert(mesh.materials.begin(), mesh.materials.end());
  EXPECT_EQ(meshes.size(), scene_.meshes.size());
  EXPECT_EQ(materials.size(), scene_.materials.size());
}

TEST_P(BuiltinScene, NumbersAreFinite) {
  for (const Mesh& mesh : scene_.meshes) {
    for (const Vec3 p : mesh.positions) ASSERT_TRUE(is_finite(p)) << mesh.name;
    for (const Vec2 uv : mesh.uvs)
      ASSERT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y)) << mesh.name;
  }
  for (const Instance& instance : scene_.instances) {
    for (int c = 0; c < 4; ++c)
      EXPECT_TRUE(is_finite(column(instance.to_world, c))) << instance.name;
    EXPECT_FALSE(mirrors(instance.to_world)) << instance.name;
  }
}

TEST_P(BuiltinScene, TrianglesHaveAreaAndNormalsOnTheirFrontSide) {
  for (const Mesh& mesh : scene_.meshes) {
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 u = mesh.positions[b] - mesh.positions[a],
                 v = mesh.positions[c] - mesh.positions[a];
      const Vec3 face = cross(u, v);
      ASSERT_GT(length(face), 1e-5f * std::max({dot(u, u), dot(v, v), dot(v - u, v - u)}))
          << mesh.name;
      for (const std::uint32_t vertex : {a, b, c}) {
        const Vec3 n = mesh.normals[vertex];
        ASSERT_NEAR(length(n), 1, 1e-4) << mesh.name;
        ASSERT_GT(dot(n, normalized(face)), 0.2f)
            << mesh.name << " at " << mesh.positions[vertex].x << ' ' << mesh.positions[vertex].y
            << ' ' << mesh.positions[vertex].z;
      }
    }
  }
}

TEST_P(BuiltinScene, OrdinaryMaterialsDoNotMirror) {
  for (const Material& material : scene_.materials) {
    const bool mirror = material.metallic == 1 && material.roughness == 0;
    const bool glass = material.transmission == 1 && material.roughness == 0;
    EXPECT_TRUE(mirror || glass || material.roughness >= 0.2f) << material.name;
  }
}

/// Edges without exactly one triangle in the opposite direction.
std::size_t open_edge_count(const Mesh& mesh) {
  std::map<std::array<float, 3>, int> points;
  std::map<std::pair<int, int>, int> edges;
  const auto point = [&](std::uint32_t vertex) {
    const Vec3 p = mesh.positions[vertex];
    return points.try_emplace({p.x, p.y, p.z}, static_cast<int>(points.size())).first->second;
  };
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{point(triangle[i]), point(triangle[(i + 1) % 3])}];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    open += count != 1 || back == edges.end() || back->second != 1;
  }
  return open;
}

TEST(OfficeScene, HasItsSize) {
  const SceneDescription scene = builtin_scene("office");
  EXPECT_GE(triangle_count(scene), 36000u);
  EXPECT_LE(triangle_count(scene), 60000u);
  EXPECT_GE(scene.instances.size(), 200u);
  EXPECT_LT(scene.meshes.size(), scene.instances.size()) << "furniture is shared";
}

TEST(OfficeScene, GlassIsClosedAndLooksOutwards) {
  const SceneDescription scene = builtin_scene("office");
  int found = 0;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[mesh.materials[0]];
    if (material.transmission == 0) continue;
    ++found;
    EXPECT_EQ(mesh.materials.size(), 1u) << mesh.name;
    EXPECT_EQ(material.transmission, 1);
    EXPECT_EQ(material.ior, 1.5f);
    EXPECT_TRUE(material.double_sided);
    EXPECT_EQ(open_edge_count(mesh), 0u) << mesh.name;
    float volume = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      volume += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6;
    }
    EXPECT_GT(volume, 0) << mesh.name;
  }
  EXPECT_GE(found, 1);
}

TEST(CornellScene, HasItsSize) {
  const SceneDescription scene = builtin_scene("cornell");
  EXPECT_EQ(triangle_count(scene), 792u);
  EXPECT_EQ(scene.meshes.size(), 7u);
  EXPECT_EQ(scene.instances.size(), 7u);
  int mirrors = 0, balls = 0;
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_EQ(open_edge_count(mesh), 0u) << mesh.name;
    mirrors += mesh.triangles.size() == 12 && scene.materials[mesh.materials[0]].metallic == 1;
    balls += mesh.triangles.size() == 720;
  }
  EXPECT_EQ(mirrors, 6);
  EXPECT_EQ(balls, 1);
}

TEST(AtriumScene, HasItsSize) {
  const SceneDescription scene = builtin_scene("atrium");
  EXPECT_GE(triangle_count(scene), 66000u);
  EXPECT_LE(triangle_count(scene), 90000u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_FALSE(scene.meshes[0].uvs.empty());
  for (const Material& material : scene.materials) {
    EXPECT_EQ(material.transmission, 0);
    EXPECT_GE(material.roughness, 0.2f);
  }
}

TEST(BuiltinScenes, UnknownNamesAreRefused) {
  EXPECT_EQ(builtin_scene_names(), (std::vector<std::string>{"office", "cornell", "atrium"}));
  for (const char* name : {"", "Office", "office ", "sponza"}) {
    try {
      (void)builtin_scene(name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kNotFound);
      EXPECT_NE(error.sentence().find("atrium"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace raysheaf
