// Meshes that change their shape by skins and morph targets, moved by a device: the CPU's frames,
// bit for bit, and the bytes sent do not grow with the vertices. On the CPU as a device.
#include <gtest/gtest.h>

#include <cmath>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "frame/device_scenes.h"
#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/renderer.h"
#include "render/raster/rasterizer.h"
#include "support/guarded_memory.h"

namespace raysheaf {
namespace {

constexpr float kHalfTurn = 0.70710678f;

/// A sphere on two bones that bend, with two morph targets; an instance moves on a node, and
/// another one stands still. With `flat`, a third of its triangles have their planes' normals.
std::unique_ptr<Animation> bending(std::uint32_t rings, bool flat = false, bool skinned = true) {
  SceneDescription scene = test::ball_on_floor();
  Mesh ball = test::ball(rings, 0.8f, {0, 1, 0});
  ball.materials = {0};
  if (flat) {  // whose vertices must be their own
    Mesh apart;
    apart.materials = ball.materials;
    for (const auto& triangle : ball.triangles) {
      const auto first = static_cast<std::uint32_t>(apart.positions.size());
      for (const std::uint32_t v : triangle) {
        apart.positions.push_back(ball.positions[v]);
        apart.normals.push_back(ball.normals[v]);
      }
      apart.triangles.push_back({first, first + 1, first + 2});
    }
    ball = apart;
  }
  RigShape shape;
  shape.positions = ball.positions;
  shape.normals = ball.normals;
  shape.targets.resize(2);
  for (const Vec3 p : ball.positions) {
    shape.targets[0].positions.push_back({0.3f * p.y, 0, 0.1f * p.x});
    shape.targets[1].normals.push_back({0, 0.2f * p.x, 0});
    if (!skinned) continue;
    shape.joints.insert(shape.joints.end(), {0, 1});
    shape.joint_weights.insert(shape.joint_weights.end(), {2 - p.y, std::max(p.y, 0.0f)});
  }
  shape.weights = {0, 0.5f};
  for (std::uint32_t t = 0; flat && t < ball.triangles.size(); t += 3)
    shape.flat_triangles.push_back(t);
  shape.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(ball);
  Instance instance;
  instance.mesh = shape.mesh;
  scene.instances.push_back(instance);
  instance.to_world.m[0][3] = 1.5f;
  scene.instances.push_back(instance);

  Rig rig;
  rig.nodes.resize(3);
  rig.nodes[1].parent = 0;
  rig.nodes[1].translation = {0, 1, 0};
  rig.instance_nodes.assign(scene.instances.size(), kInvalidId);
  rig.camera_nodes.assign(scene.cameras.size(), kInvalidId);
  rig.light_nodes.assign(scene.lights.size(), kInvalidId);
  rig.instance_nodes[0] = 2;
  if (skinned) {
    RigSkin skin;
    skin.joints = {0, 1};
    skin.inverse_bind.resize(2);
    skin.inverse_bind[1].m[1][3] = -1;
    rig.skins = {skin};
    shape.skin = 0;
    shape.joints_per_vertex = 2;
  }
  rig.shapes = {shape};
  RigClip clip;
  clip.curves = {{Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, kHalfTurn, 0, 0, kHalfTurn}},
                 {Interpolation::kLinear, {0, 1}, {0, 0.5f, 1, -0.5f}},
                 {Interpolation::kLinear, {0, 1}, {0, 0, 0, 0.5f, 0.2f, 0}}};
  clip.channels = {
      {RigPath::kRotation, 1, 0}, {RigPath::kWeights, 0, 1}, {RigPath::kTranslation, 2, 2}};
  rig.clips = {clip};
  return animate(std::move(scene), std::move(rig));
}

bool tells(const RenderResult& result, const std::string& words) {
  for (const BatchStatistics& batch : result.statistics.batches)
    for (const std::string& sentence : batch.plan)
      if (sentence.find(words) != std::string::npos) return true;
  return false;
}

void expect_same_counts(const RenderResult& there, const RenderResult& here) {
  const std::vector<BatchStatistics>&a = there.statistics.batches, &b = here.statistics.batches;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].rays, b[i].rays);
    EXPECT_EQ(a[i].hits, b[i].hits);
    EXPECT_EQ(a[i].mesh_sphere_tests, b[i].mesh_sphere_tests);
    EXPECT_EQ(a[i].final_tests, b[i].final_tests);
    EXPECT_EQ(a[i].total_tests(), b[i].total_tests());
  }
}

class PosedFrames : public ::testing::Test {
 protected:
  const Executor executor_{2};
  test::GuardedMemory memory_;
  const Context device_ =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor_, memory_));

  void expect_frames(Animation& there, Animation& here, const RenderOptions& options,
                     bool there_moves) {
    Renderer of_device(device_), of_host;
    of_device.show(there.scene());
    of_host.show(here.scene());
    for (int frame = 0; frame < 5; ++frame) {
      SCOPED_TRACE(frame);
      const RenderResult picture = of_device.render(options), expected = of_host.render(options);
      test::expect_same_picture(picture, expected);
      if (options.method != Method::kDual) expect_same_counts(picture, expected);
      EXPECT_EQ(tells(picture, "moves the vertices of 1 mesh,"), there_moves && frame > 0);
      const double time = 0.2 * (frame + 1);
      of_device.show(there.scene(), there.seek_poses(time));
      of_host.show(here.scene(), here.seek(time));
    }
    // The host's vertices are brought there when they are asked for.
    static_cast<void>(there.seek(1));
    const std::size_t mesh = there.scene().meshes.size() - 1;
    EXPECT_TRUE(
        test::same_bits(there.scene().meshes[mesh].positions, here.scene().meshes[mesh].positions));
    EXPECT_TRUE(
        test::same_bits(there.scene().meshes[mesh].normals, here.scene().meshes[mesh].normals));
  }

  std::vector<std::uint64_t> sent(std::uint32_t rings, const RenderOptions& options) {
    const std::unique_ptr<Animation> animation = bending(rings);
    Renderer renderer(device_);
    renderer.show(animation->scene());
    std::vector<std::uint64_t> bytes;
    for (int frame = 0; frame < 4; ++frame) {
      const std::uint64_t before = memory_.uploaded_bytes();
      static_cast<void>(renderer.render(options));
      bytes.push_back(memory_.uploaded_bytes() - before);
      renderer.show(animation->scene(), animation->seek_poses(0.2 * (frame + 1)));
    }
    return {bytes.begin() + 2, bytes.end()};
  }
};

TEST_F(PosedFrames, AreTheCpus) {
  for (const bool flat : {false, true}) {
    for (const bool skinned : {false, true}) {
      SCOPED_TRACE(std::to_string(flat) + std::to_string(skinned));
      expect_frames(*bending(7, flat, skinned), *bending(7, flat, skinned), traced(32), true);
    }
  }
  RenderOptions options = traced(24);
  options.method = Method::kBrute;
  expect_frames(*bending(5), *bending(5), options, true);
  for (const Method method : {Method::kRah, Method::kCrsh, Method::kGl10}) {
    SCOPED_TRACE(to_string(method));
    options.method = method;
    expect_frames(*bending(5), *bending(5), options, true);
    expect_frames(*bending(5, true), *bending(5, true), options, true);
  }
}

TEST_F(PosedFrames, SendNoMoreForMoreVertices) {
  RenderOptions options = traced(8);
  options.bounces = 0;
  for (const Method method : {Method::kDual, Method::kRah, Method::kCrsh}) {
    SCOPED_TRACE(to_string(method));
    options.method = method;
    EXPECT_EQ(sent(40, options), sent(6, options));
  }
}

/// Spheres of meshes are found where a method needs them, though others have moved vertices since.
TEST_F(PosedFrames, TakeTurnsWithTheHosts) {
  const std::unique_ptr<Animation> there = bending(6), here = bending(6);
  Renderer of_device(device_), of_host;
  of_device.show(there->scene());
  of_host.show(here->scene());
  constexpr Method kMethods[] = {Method::kDual, Method::kDual, Method::kCrsh, Method::kDual,
                                 Method::kDual, Method::kGl10, Method::kBrute};
  double time = 0;
  for (const Method method : kMethods) {
    RenderOptions options = traced(20);
    options.method = method;
    test::expect_same_picture(of_device.render(options), of_host.render(options));
    time += 0.13;
    const bool by_host = method == Method::kGl10;  // a caller may move vertices itself
    of_device.show(there->scene(), by_host ? there->seek(time) : there->seek_poses(time));
    of_host.show(here->scene(), here->seek(time));
    if (method == Method::kCrsh) {  // two changes in one image
      time += 0.02;
      of_device.show(there->scene(), there->seek_poses(time));
      of_host.show(here->scene(), here->seek(time));
    }
  }
}

/// A renderer of the CPU moves the vertices of poses, too.
TEST_F(PosedFrames, OfTheCpuMoveVerticesThemselves) {
  const std::unique_ptr<Animation> posed = bending(6), moved = bending(6);
  Renderer a, b;
  a.show(posed->scene());
  b.show(moved->scene());
  for (const double time : {0.3, 0.9}) {
    a.show(posed->scene(), posed->seek_poses(time));
    b.show(moved->scene(), moved->seek(time));
    test::expect_same_picture(a.render(traced(20)), b.render(traced(20)));
  }
  EXPECT_TRUE(posed->seek_poses(0.9).empty());
}

/// The host reports a vertex that goes too far.
TEST_F(PosedFrames, TellWhichVertexGoesTooFar) {
  SceneDescription scene = test::ball_on_floor();
  RigShape shape;
  shape.positions = scene.meshes[0].positions;
  shape.normals = scene.meshes[0].normals;
  shape.targets.resize(1);
  shape.targets[0].positions.assign(shape.positions.size(), {0, 1e18f, 0});
  shape.weights = {0};
  Rig rig;
  rig.instance_nodes.assign(scene.instances.size(), kInvalidId);
  rig.camera_nodes.assign(scene.cameras.size(), kInvalidId);
  rig.light_nodes.assign(scene.lights.size(), kInvalidId);
  rig.shapes = {shape};
  RigClip clip;
  clip.curves = {{Interpolation::kLinear, {0, 1}, {0, 9}}};
  clip.channels = {{RigPath::kWeights, 0, 0}};
  rig.clips = {clip};
  const std::unique_ptr<Animation> animation = animate(scene, rig);
  Renderer renderer(device_);
  renderer.show(animation->scene());
  static_cast<void>(renderer.render(traced(8)));
  renderer.show(animation->scene(), animation->seek_poses(1));
  try {
    static_cast<void>(renderer.render(traced(8)));
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
    EXPECT_NE(error.place().find("meshes[0].positions"), std::string::npos) << error.place();
  }
  renderer.show(animation->scene(), animation->seek_poses(0));
  const std::unique_ptr<Animation> by_host = animate(scene, rig);
  static_cast<void>(by_host->seek(0));
  test::expect_same_picture(renderer.render(traced(8)), render(by_host->scene(), traced(8)));
}

}  // namespace
}  // namespace raysheaf
