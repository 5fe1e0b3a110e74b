// Files and animations: the same numbers and bytes on every machine.
#include <gtest/gtest.h>

#include "raysheaf/animation.h"
#include "raysheaf/block_file.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"
#include "support/folder.h"
#include "support/pictures.h"
#include "tests/bits/checksums.h"

namespace raysheaf::test {
namespace {

Checksum geometry_of(const SceneDescription& scene) {
  Checksum sum;
  for (const Mesh& mesh : scene.meshes)
    sum.add_all(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles);
  for (const Instance& instance : scene.instances) sum.add_all(instance.mesh, instance.to_world);
  return sum;
}

TEST(BitsOfFiles, AreTheSameEverywhere) {
  const TemporaryFolder folder;
  const std::string glb = folder.file("soup.glb"), blocks = folder.file("soup.rsb");
  SceneDescription scene = soup(SoupKind::kSmall, 5000, 12);
  for (const Light& light : ball_on_floor().lights) scene.lights.push_back(light);
  save_glb(scene, glb);
  expect_bits("GLB file", checksum_of(std::string_view(read_file(glb))));
  expect_bits("GLB file, read", geometry_of(load_scene(glb)));
  BlockFileWriter writer(blocks);
  const std::optional<SceneDescription> packed =
      pack_file(glb, &writer, {.triangles_at_once = 1, .beside = blocks});
  ASSERT_TRUE(packed.has_value());
  writer.finish(*packed);
  expect_bits("block file", checksum_of(std::string_view(read_file(blocks))));
}

TEST(BitsOfFiles, DecimalNumbersAreTheSameEverywhere) {
  const TemporaryFolder folder;
  Random random(13);
  std::string obj, ply;
  constexpr int kVertices = 999;
  for (int i = 0; i < kVertices; ++i) {
    std::string line;
    for (int axis = 0; axis < 3; ++axis) {
      line += ' ' + std::to_string(random.below(2000));
      line += '.' + std::to_string(random.bits());
      if (random.below(3) == 0)
        line += 'e' + std::to_string(static_cast<int>(random.below(24)) - 16);
    }
    obj += "v" + line + "\n";
    ply += line + "\n";
  }
  std::string faces;
  for (int i = 0; i < kVertices; i += 3) {
    obj += "f " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " " +
           std::to_string(i + 3) + "\n";
    faces +=
        "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
  }
  write_file(folder.file("a.obj"), obj);
  write_file(folder.file("a.ply"),
             "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kVertices) +
                 "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                 std::to_string(kVertices / 3) + "\nproperty list uchar int vertex_indices\n" +
                 "end_header\n" + ply + faces);
  expect_bits("OBJ, read", geometry_of(load_scene(folder.file("a.obj"))));
  expect_bits("PLY, read", geometry_of(load_scene(folder.file("a.ply"))));
}

TEST(BitsOfAnimations, AreTheSameEverywhere) {
  SceneDescription scene = ball_on_floor();
  Rig rig;
  RigNode node;
  rig.nodes = {node, node};
  rig.nodes[1].parent = 0;
  rig.instance_nodes = {1, kInvalidId};
  rig.camera_nodes = {kInvalidId};
  rig.light_nodes = {kInvalidId};
  RigClip clip;
  Random random(14);
  for (const Interpolation interpolation : {Interpolation::kLinear, Interpolation::kCubicSpline}) {
    Curve curve;
    curve.interpolation = interpolation;
    curve.times = {0, 0.5f, 1.25f, 2};
    const std::size_t count = interpolation == Interpolation::kLinear ? 4 : 12;
    for (std::size_t i = 0; i < 4 * count; ++i) curve.values.push_back(random.between(-1, 1));
    clip.channels.push_back({RigPath::kRotation, static_cast<std::uint32_t>(clip.curves.size()),
                             static_cast<std::uint32_t>(clip.curves.size())});
    clip.curves.push_back(curve);
  }
  rig.clips = {clip};
  const std::unique_ptr<Animation> animation = animate(scene, rig, 1);
  Checksum sum;
  for (int frame = 0; frame <= 20; ++frame) {
    animation->seek(0.1 * frame);
    sum.add(animation->scene().instances[0].to_world);
  }
  expect_bits("animation", sum);
}

}  // namespace
}  // namespace raysheaf::test
