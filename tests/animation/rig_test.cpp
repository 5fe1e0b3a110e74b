// Rigs made by hand: the places of objects at a given time, and the reported changes.
#include <gtest/gtest.h>

#include <cmath>

#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

constexpr float kHalf = 0.70710678f;

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-5f);
  EXPECT_NEAR(a.y, b.y, 1e-5f);
  EXPECT_NEAR(a.z, b.z, 1e-5f);
}

RigNode node_at(double x, double y, double z, std::uint32_t parent = kInvalidId) {
  RigNode node;
  node.translation = {x, y, z};
  node.parent = parent;
  return node;
}

/// Three instances, a camera and a light on four nodes: an arm that turns by 90 degrees in a
/// second, a hand on it, and a stone next to it.
struct Arm {
  SceneDescription scene;
  Rig rig;

  Arm() {
    test::add_mesh(&scene, test::ball(4, 1));
    scene.instances.push_back(scene.instances[0]);
    scene.instances.push_back(scene.instances[0]);
    scene.cameras.push_back(test::camera_at({0, 0, 5}, {}));
    scene.lights.push_back(test::point_light({0, 9, 0}, 50));
    rig.nodes = {node_at(1, 0, 0), node_at(2, 0, 0, 0), node_at(-5, 0, 0), node_at(0, 0, 1, 1)};
    rig.instance_nodes = {0, 1, 2};
    rig.camera_nodes = {3};
    rig.light_nodes = {1};
    RigClip clip;
    clip.name = "turn";
    clip.curves = {{Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf}}};
    clip.channels = {{RigPath::kRotation, 0, 0}};
    rig.clips = {clip};
  }
};

TEST(Rig, MovesObjectsOnItsNodes) {
  Arm arm;
  const auto animation = animate(arm.scene, arm.rig);
  EXPECT_EQ(animation->start(), 0);
  EXPECT_EQ(animation->end(), 1);
  const SceneDescription& scene = animation->scene();
  expect_near(column(scene.instances[1].to_world, 3), {3, 0, 0});
  const SceneChanges changes = animation->seek(1);
  EXPECT_EQ(changes.moved, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(changes.deformed.empty());
  // The hand is 2 along the arm's x axis, which now points along y.
  expect_near(column(scene.instances[1].to_world, 3), {1, 2, 0});
  expect_near(column(scene.instances[2].to_world, 3), {-5, 0, 0});
  expect_near(scene.lights[0].position, {1, 2, 0});
  expect_near(column(scene.cameras[0].to_world, 3), {1, 2, 1});
  expect_near(column(scene.cameras[0].to_world, 0), {0, 1, 0});
  EXPECT_TRUE(animation->seek(1).empty());
  EXPECT_TRUE(animation->seek(7).empty()) << "time ends with the last key";
  EXPECT_EQ(animation->seek(-3).moved.size(), 2u);
  expect_near(column(scene.instances[1].to_world, 3), {3, 0, 0});
}

TEST(Rig, CountsFrames) {
  const Arm arm;
  const auto animation = animate(arm.scene, arm.rig);
  EXPECT_EQ(frame_count(*animation, 24), 25u);
  EXPECT_NEAR(frame_time(*animation, 12, 24), 0.5, 1e-12);
  const auto still = animate(arm.scene);
  EXPECT_EQ(frame_count(*still, 24), 1u);
  EXPECT_TRUE(still->seek(3).empty());
  EXPECT_EQ(frame_count(0xfffffffe, 1), 0xffffffffu);
  EXPECT_THROW(static_cast<void>(frame_count(0xffffffff, 1)), Error);
}

TEST(Rig, HasNoFramesWithoutEnd) {
  Arm arm;
  arm.rig.clips[0].curves[0].times.back() = 1e30f;
  arm.scene.cameras.clear();
  arm.rig.camera_nodes.clear();
  const auto animation = animate(arm.scene, arm.rig);
  try {
    static_cast<void>(frame_count(*animation, 24));
    ADD_FAILURE() << "were counted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("more than 2^32 - 1 frames"), std::string::npos);
  }
  EXPECT_NO_THROW(add_missing_camera_and_light(*animation));
}

TEST(Rig, PlaysClipsApartOrTogether) {
  Arm arm;
  RigClip lift;
  lift.name = "lift";
  lift.curves = {{Interpolation::kStep, {0, 2}, {0, 0, 0, 0, 7, 0}}};
  lift.channels = {{RigPath::kTranslation, 2, 0}};
  arm.rig.clips.push_back(lift);
  // The clips drive different things, so they form one entry.
  auto animation = animate(arm.scene, arm.rig);
  EXPECT_EQ(animation->clips(), std::vector<std::string>{"turn + lift"});
  EXPECT_EQ(animation->end(), 2);
  EXPECT_EQ(animation->seek(2).moved, (std::vector<std::uint32_t>{0, 1, 2}));

  // The clips drive the same thing: each plays separately, starting at rest.
  arm.rig.clips[1].channels.push_back({RigPath::kTranslation, 0, 0});
  arm.rig.clips[0].channels.push_back({RigPath::kTranslation, 0, 1});
  arm.rig.clips[0].curves.push_back({Interpolation::kLinear, {0, 1}, {0, 0, 0, 0, 0, 9}});
  animation = animate(arm.scene, arm.rig);
  EXPECT_EQ(animation->clips(), (std::vector<std::string>{"turn", "lift"}));
  static_cast<void>(animation->seek(1));
  animation->play(1);
  static_cast<void>(animation->seek(2));
  expect_near(column(animation->scene().instances[0].to_world, 3), {0, 7, 0});
  expect_near(column(animation->scene().instances[0].to_world, 0), {1, 0, 0});
  EXPECT_THROW(animation->play(2), Error);
}

/// A strip of two triangles. Its upper end follows a joint that bends, its middle both joints.
struct Strip {
  SceneDescription scene;
  Rig rig;

  Strip() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}};
    mesh.normals.assign(6, {0, 0, 1});
    mesh.triangles = {{0, 1, 3}, {2, 3, 5}};
    test::add_mesh(&scene, mesh);
    rig.nodes = {node_at(0, 0, 0), node_at(0, 1, 0, 0)};
    rig.instance_nodes = {kInvalidId};
    Affine down;
    down.m[1][3] = -1;
    rig.skins = {{"", {0, 1}, {Affine{}, down}}};
    RigShape shape;
    shape.positions = mesh.positions;
    shape.normals = mesh.normals;
    shape.skin = 0;
    shape.joints_per_vertex = 2;
    shape.joints.assign(12, 0);
    for (std::size_t v = 0; v < 6; ++v) shape.joints[2 * v + 1] = 1;
    // Weights with the sum 2: the rig normalises them.
    shape.joint_weights = {2, 0, 2, 0, 1, 1, 1, 1, 0, 2, 0, 2};
    rig.shapes = {shape};
    RigClip clip;
    // Bends by 90 degrees about x: up becomes forward.
    clip.curves = {{Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, kHalf, 0, 0, kHalf}}};
    clip.channels = {{RigPath::kRotation, 1, 0}};
    rig.clips = {clip};
  }
};

TEST(Rig, SkinsPullVertices) {
  const Strip strip;
  const auto animation = animate(strip.scene, strip.rig);
  const Mesh& mesh = animation->scene().meshes[0];
  for (std::size_t v = 0; v < 6; ++v)
    expect_near(mesh.positions[v], strip.scene.meshes[0].positions[v]);
  const SceneChanges changes = animation->seek(1);
  EXPECT_EQ(changes.deformed, std::vector<std::uint32_t>{0});
  expect_near(mesh.positions[1], {1, 0, 0});
  expect_near(mesh.positions[2], {0, 1, 0});
  expect_near(mesh.positions[4], {0, 1, 1});
  expect_near(mesh.positions[5], {1, 1, 1});
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.normals[3], {0, -kHalf, kHalf});
  expect_near(mesh.normals[5], {0, -1, 0});
  EXPECT_TRUE(animation->seek(1).empty());
}

TEST(Rig, TargetsMoveVerticesBeforeSkinsDo) {
  Strip strip;
  RigShape& shape = strip.rig.shapes[0];
  shape.targets.resize(2);
  shape.targets[0].positions.assign(6, {0, 0, 2});
  shape.targets[1].positions.assign(6, {});
  shape.targets[1].positions[5] = {0, 4, 0};
  shape.targets[1].normals.assign(6, {1, 0, -1});
  shape.weights = {0.25f, 0};
  strip.rig.clips[0].curves.push_back({Interpolation::kLinear, {0, 2}, {0.25f, 0, 0.5f, 1}});
  strip.rig.clips[0].channels.push_back({RigPath::kWeights, 0, 1});
  const auto animation = animate(strip.scene, strip.rig);
  const Mesh& mesh = animation->scene().meshes[0];
  expect_near(mesh.positions[0], {0, 0, 0.5f});
  EXPECT_EQ(animation->seek(2).deformed, std::vector<std::uint32_t>{0});
  expect_near(mesh.positions[0], {0, 0, 1});
  expect_near(mesh.normals[0], {1, 0, 0});
  // (1, 2, 0) + (0, 0, 1) + (0, 4, 0), then bent about y = 1.
  expect_near(mesh.positions[5], {1, 0, 5});
}

TEST(Rig, FlatTrianglesStayFlat) {
  Strip strip;
  strip.rig.shapes[0].flat_triangles = {1};
  const auto animation = animate(strip.scene, strip.rig);
  static_cast<void>(animation->seek(0.5));
  const Mesh& mesh = animation->scene().meshes[0];
  const Vec3 a = mesh.positions[2], b = mesh.positions[3], c = mesh.positions[5];
  const Vec3 normal = normalized(cross(b - a, c - a));
  for (const std::size_t v : {2, 3, 5}) expect_near(mesh.normals[v], normal);
  expect_near(mesh.normals[0], {0, 0, 1});
}

TEST(Rig, TheSameWithAnyNumberOfThreads) {
  Strip strip;
  // A strip that is long enough for several tasks.
  Mesh& mesh = strip.scene.meshes[0];
  RigShape& shape = strip.rig.shapes[0];
  for (int i = 0; i < 4000; ++i) {
    shape.positions.push_back({0.001f * static_cast<float>(i), 1.5f, 0.3f});
    shape.joints.insert(shape.joints.end(), {0, 1});
    shape.joint_weights.insert(shape.joint_weights.end(), {0.3f, 0.7f});
  }
  shape.normals.resize(shape.positions.size(), {0, 0, 1});
  mesh.positions = shape.positions;
  mesh.normals = shape.normals;
  const auto one = animate(strip.scene, strip.rig, 1), four = animate(strip.scene, strip.rig, 4);
  static_cast<void>(one->seek(0.6));
  static_cast<void>(four->seek(0.3));
  static_cast<void>(four->seek(0.6));
  EXPECT_TRUE(test::same_bits(one->scene().meshes[0].positions, four->scene().meshes[0].positions));
  EXPECT_TRUE(test::same_bits(one->scene().meshes[0].normals, four->scene().meshes[0].normals));
}

/// Expects that `rig` is refused with this place and these words.
template <class Rig>
void expect_refused(const Rig& rigged, const std::string& place, const std::string& words) {
  try {
    static_cast<void>(animate(rigged.scene, rigged.rig));
    ADD_FAILURE() << place << " was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.place(), place);
    EXPECT_NE(error.sentence().find(words), std::string::npos) << error.what();
  }
}

TEST(Rig, NamesWhatIsWrong) {
  const auto arm_with = [](auto change) {
    Arm arm;
    change(arm.rig);
    return arm;
  };
  const auto strip_with = [](auto change) {
    Strip strip;
    change(strip.rig);
    return strip;
  };
  expect_refused(arm_with([](Rig& r) { r.nodes[1].parent = 1; }), "nodes[1].parent", "precede");
  expect_refused(arm_with([](Rig& r) {
                   r.nodes[2].rotation = {0, 0, 0, 0};
                 }),
                 "nodes[2].rotation", "length");
  expect_refused(arm_with([](Rig& r) { r.instance_nodes[1] = 9; }), "instance_nodes[1]", "4 nodes");
  expect_refused(arm_with([](Rig& r) { r.camera_nodes.clear(); }), "camera_nodes", "0 entries");
  expect_refused(arm_with([](Rig& r) { r.clips[0].curves[0].times[1] = 0; }),
                 "clips[0].curves[0].times[1]", "not later");
  expect_refused(arm_with([](Rig& r) { r.clips[0].curves[0].values[5] = NAN; }),
                 "clips[0].curves[0].values[5]", "not finite");
  expect_refused(arm_with([](Rig& r) { r.clips[0].curves[0].values.pop_back(); }),
                 "clips[0].curves[0].values", "need 8");
  expect_refused(arm_with([](Rig& r) { r.clips[0].channels.push_back(r.clips[0].channels[0]); }),
                 "clips[0].channels[1]", "earlier");
  expect_refused(arm_with([](Rig& r) { r.nodes[0].matrix.emplace(); }),
                 "clips[0].channels[0].target", "matrix");
  expect_refused(strip_with([](Rig& r) { r.shapes[0].joints[3] = 2; }), "shapes[0].joints[3]",
                 "2 joints");
  expect_refused(strip_with([](Rig& r) { r.skins[0].inverse_bind.pop_back(); }),
                 "skins[0].inverse_bind", "1 matrices");
  expect_refused(strip_with([](Rig& r) { r.shapes[0].weights = {1}; }), "shapes[0].weights",
                 "1 weights for 0");
  expect_refused(strip_with([](Rig& r) { r.shapes[0].positions.pop_back(); }),
                 "shapes[0].positions", "5 vectors");
}

}  // namespace
}  // namespace raysheaf
