// Animated nodes, skins and morph targets of glTF, compared with values computed by hand; and the
// place that each error names.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "raysheaf/animation.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using enum ErrorCode;

constexpr float kHalf = 0.70710678f;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-5f);
  EXPECT_NEAR(a.y, b.y, 1e-5f);
  EXPECT_NEAR(a.z, b.z, 1e-5f);
}
Vec3 origin_of(const Affine& a) {
  return {a.m[0][3], a.m[1][3], a.m[2][3]};
}

class GltfMoving : public IoTest {
 protected:
  /// Adds a channel of the first animation, with its curve.
  void drive(std::size_t node, const char* path, const std::vector<float>& times,
             const std::vector<float>& values, const char* interpolation = "LINEAR") {
    const std::size_t width = std::string(path) == "rotation"  ? 4
                              : std::string(path) == "weights" ? 1
                                                               : 3;
    const char* type = width == 4 ? "VEC4" : width == 3 ? "VEC3" : "SCALAR";
    const std::size_t input = file_.accessor(times, "SCALAR", 5126, 1);
    const std::size_t output = file_.accessor(values, type, 5126, width);
    json& animation = file_.json["animations"][0];
    animation["samplers"].push_back(
        {{"input", input}, {"output", output}, {"interpolation", interpolation}});
    animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                     {"target", {{"node", node}, {"path", path}}}});
  }
  /// A triangle between two joints: corners at y = 0, 0 and 1, the last on the second joint, which
  /// bends by 90 degrees about x in a second. The mesh's node is far away.
  void show_skin() {
    const std::size_t positions = file_.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::size_t joints = file_.accessor(
        std::vector<std::uint8_t>{0, 9, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 5121, 4);
    const std::size_t weights = file_.accessor(
        std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, "VEC4", 5121, 4, true);
    const std::size_t inverse =
        file_.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,     0, 1,
                                          1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5f, 0, 1},
                       "MAT4", 5126, 16);
    file_.show(
        {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
    file_.json["nodes"][0]["translation"] = {100, 100, 100};
    file_.json["nodes"][0]["skin"] = 0;
    file_.node({{"children", {2}}});
    file_.add("nodes", {{"translation", {0, 0.5, 0}}});
    file_.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}});
    drive(2, "rotation", {0, 1}, {0, 0, 0, 1, kHalf, 0, 0, kHalf});
  }
  /// A triangle with two targets, of which the second has the weight 0.5.
  void show_morph() {
    const std::size_t up = file_.positions({0, 0, 0, 0, 0, 0, 0, 4, 0});
    const std::size_t out = file_.positions({0, 0, 2, 0, 0, 2, 0, 0, 2});
    file_.show({{"attributes", {{"POSITION", file_.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                {"targets", {{{"POSITION", up}}, {{"POSITION", out}}}}});
    file_.json["meshes"][0]["weights"] = {0, 0.5};
  }

  /// Expects one warning that contains all of the words.
  void warned(const std::vector<std::string>& words) {
    const std::unique_ptr<Animation> animation = load();
    const SceneDescription& scene = animation->scene();
    const bool found =
        std::any_of(scene.warnings.begin(), scene.warnings.end(), [&](const std::string& sentence) {
          return std::all_of(words.begin(), words.end(), [&](const std::string& word) {
            return sentence.find(word) != sentence.npos;
          });
        });
    EXPECT_TRUE(found) << words[0] << " of " << scene.warnings.size() << " warnings";
  }
  /// Expects the same warning, and no animation.
  void left_at_rest(const std::vector<std::string>& words) {
    warned(words);
    EXPECT_EQ(load()->end(), load()->start());
    EXPECT_NO_THROW(static_cast<void>(load_scene(write("still.gltf", file_.text()))));
  }

  [[nodiscard]] std::unique_ptr<Animation> load() {
    return load_animation(write("moving.gltf", file_.text()));
  }
  void refused(const std::vector<std::string>& words) {
    const std::string file = write("broken.gltf", file_.text());
    try {
      static_cast<void>(load_animation(file));
      ADD_FAILURE() << "was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), kInvalidData);
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(file)) << what;
      for (const std::string& word : words)
        EXPECT_NE(what.find(word), what.npos) << "no \"" << word << "\" in: " << what;
    }
    EXPECT_THROW(static_cast<void>(load_scene(file)), Error);
  }
  GltfFile file_;
};

TEST_F(GltfMoving, NodesCarryMeshesCamerasAndLights) {
  file_.show_triangle();
  file_.node({{"children", {0, 2, 3}}});
  file_.roots = {1};
  file_.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  file_.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  file_.add("nodes", {{"camera", 0}, {"translation", {0, 0, 3}}});
  file_.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  drive(1, "translation", {1, 3}, {0, 0, 0, 4, 0, 0});
  drive(1, "scale", {0, 2}, {1, 1, 1, 3, 3, 3}, "STEP");
  const auto animation = load();
  EXPECT_EQ(animation->end(), 3);
  EXPECT_EQ(animation->clips(), std::vector<std::string>{"animation 0"});
  const SceneDescription& scene = animation->scene();
  EXPECT_EQ(animation->seek(2).moved, std::vector<std::uint32_t>{0});
  expect_near(origin_of(scene.instances[0].to_world), {2, 0, 0});
  EXPECT_NEAR(scene.instances[0].to_world.m[1][1], 3, 1e-6);
  expect_near(origin_of(scene.cameras[0].to_world), {2, 0, 9});
  expect_near(scene.lights[0].position, {2, 0, 0});
  static_cast<void>(animation->seek(1.9));
  EXPECT_NEAR(scene.instances[0].to_world.m[1][1], 1, 1e-6);
}

// v0 = 0 with out-tangent 8; v1 = 2 with in-tangent 0: after half of the second, 1 + 8 / 8 = 2.
TEST_F(GltfMoving, SplinesHaveTangents) {
  file_.show_triangle();
  drive(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0},
        "CUBICSPLINE");
  const auto animation = load();
  static_cast<void>(animation->seek(0.5));
  expect_near(origin_of(animation->scene().instances[0].to_world), {2, 0, 0});
}

TEST_F(GltfMoving, SkinsPutVerticesWhereTheirJointsAre) {
  show_skin();
  const auto animation = load();
  const Mesh& mesh = animation->scene().meshes[0];
  // In the rest pose the mesh follows its joints, not its node.
  expect_near(mesh.positions[2], {0, 1, 0});
  expect_near(origin_of(animation->scene().instances[0].to_world), {0, 0, 0});
  EXPECT_EQ(animation->seek(1).deformed, std::vector<std::uint32_t>{0});
  expect_near(mesh.positions[0], {0, 0, 0});
  expect_near(mesh.positions[2], {0, 0.5f, 0.5f});
  EXPECT_FALSE(warns(animation->scene(), "kin"));
  expect_near(load_scene(write("rest.gltf", file_.text())).meshes[0].positions[2], {0, 1, 0});
}

TEST_F(GltfMoving, TargetsMoveVertices) {
  show_morph();
  drive(0, "weights", {0, 2}, {0, 0.5f, 1, 1});
  const auto animation = load();
  const Mesh& mesh = animation->scene().meshes[0];
  expect_near(mesh.positions[2], {0, 1, 1});
  EXPECT_EQ(animation->seek(1).deformed, std::vector<std::uint32_t>{0});
  expect_near(mesh.positions[2], {0, 3, 1.5f});
  static_cast<void>(animation->seek(2));
  expect_near(mesh.positions[2], {0, 5, 2});
}

// Two squares without normals that meet at a right angle along the y axis: the two vertices of the
// crease become four, and the copies move with the originals.
TEST_F(GltfMoving, VerticesThatAreSplitMoveAsTheyDid) {
  const std::size_t positions =
      file_.positions({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 1, 1});
  const std::size_t none = file_.positions(std::vector<float>(18, 0.0f));
  const std::size_t up = file_.positions({0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0, 4});
  std::vector<std::uint8_t> joints(24, 0), weights(24, 0);
  for (std::size_t v = 0; v < 6; ++v) weights[4 * v] = 255;
  const std::size_t corners = file_.accessor(
      std::vector<std::uint8_t>{0, 2, 3, 0, 3, 1, 0, 5, 4, 0, 1, 5}, "SCALAR", 5121, 1);
  file_.show({{"attributes",
               {{"POSITION", positions},
                {"NORMAL", none},
                {"JOINTS_0", file_.accessor(joints, "VEC4", 5121, 4)},
                {"WEIGHTS_0", file_.accessor(weights, "VEC4", 5121, 4, true)}}},
              {"indices", corners},
              {"targets", {{{"POSITION", up}}}}});
  file_.json["meshes"][0]["weights"] = {0.5};
  file_.json["nodes"][0]["skin"] = 0;
  file_.node({{"translation", {0, 7, 0}}});
  file_.add("skins", {{"joints", {1}}});
  const SceneDescription scene = load_scene(write("a.gltf", file_.text()));
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 8u);
  expect_near(mesh.positions[1], {0, 8, 2});
  expect_near(mesh.positions[6], {0, 7, 2});
  expect_near(mesh.positions[7], {0, 8, 2});
  for (std::size_t t = 0; t < 4; ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      EXPECT_NEAR(std::abs(t < 2 ? mesh.normals[v].z : mesh.normals[v].x), 1, 1e-6);
}

TEST_F(GltfMoving, NodesHaveWeightsOfTheirOwn) {
  show_morph();
  file_.node({{"mesh", 0}, {"weights", {1, 0}}});
  file_.node({{"mesh", 0}});
  const SceneDescription scene = load_scene(write("a.gltf", file_.text()));
  ASSERT_EQ(scene.meshes.size(), 2u) << "the first and the third share theirs";
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[2].mesh);
  expect_near(scene.meshes[scene.instances[0].mesh].positions[2], {0, 1, 1});
  expect_near(scene.meshes[scene.instances[1].mesh].positions[2], {0, 5, 0});
}

TEST_F(GltfMoving, IgnoresUnknownChannels) {
  file_.show_triangle();
  drive(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  json& channels = file_.json["animations"][0]["channels"];
  channels.push_back({{"sampler", 0}, {"target", {{"path", "translation"}}}});
  channels.push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "pointer"}}}});
  channels.push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}});
  const auto animation = load();
  EXPECT_TRUE(warns(animation->scene(), "\"pointer\""));
  EXPECT_TRUE(warns(animation->scene(), "weights"));
  EXPECT_EQ(animation->seek(1).moved.size(), 1u);
}

TEST_F(GltfMoving, LeavesBrokenCurvesAtRest) {
  file_.show_triangle();
  const json before = file_.json;
  const auto again = [&] { file_.json = before; };
  drive(0, "translation", {0, 2, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0});
  left_at_rest({"animations[0].samplers[0].input[2]", "not later"});
  again();
  drive(0, "translation", {0, kNan}, {0, 0, 0, 0, 0, 0});
  left_at_rest({"animations[0].samplers[0].input[1]", "not finite"});
  again();
  drive(0, "scale", {0, 1}, {0, 0, 0, 0, kNan, 0});
  left_at_rest({"animations[0].samplers[0].output[1]", "not finite"});
  again();
  drive(0, "scale", {0, 1}, {0, 0, 0});
  left_at_rest({"animations[0].samplers[0].output", "1 elements", "need 2"});
  again();
  drive(0, "scale", {0, 1}, {0, 0, 0, 0, 0, 0}, "CUBICSPLINE");
  left_at_rest({"animations[0].samplers[0].output", "need 6"});
  again();
  drive(0, "scale", {0, 1}, {0, 0, 0, 0, 0, 0}, "WAVY");
  left_at_rest({"animations[0].samplers[0].interpolation", "WAVY"});
  again();
  drive(0, "scale", {-1, 1}, {0, 0, 0, 0, 0, 0});
  left_at_rest({"animations[0].samplers[0].input[0]", "negative"});
  again();
  drive(0, "scale", {0}, {1, 1, 1});
  drive(0, "scale", {0}, {1, 1, 1});
  warned({"animations[0].channels[1].target", "scale", "earlier channel"});
  again();
  drive(0, "scale", {0}, {1, 1, 1});
  file_.json["animations"][0]["channels"][0]["sampler"] = 5;
  left_at_rest({"animations[0].channels[0].sampler", "1 samplers"});
  again();
  drive(0, "scale", {0}, {1, 1, 1});
  file_.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  left_at_rest({"animations[0].channels[0].target.node", "matrix"});
  again();
  drive(0, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  drive(0, "translation", {0, 0}, {1, 1, 1, 2, 2, 2});
  warned({"animations[0].samplers[1].input[1]", "not later"});
  EXPECT_EQ(load()->seek(1).moved.size(), 1u) << "the other channel moves it";
  again();
  drive(0, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  file_.json["animations"][0]["samplers"][0]["input"] = 99;
  left_at_rest({"animations[0].samplers[0].input", "99", "left out"});
  again();
  file_.json["animations"] = {json::object(), 5, {{"channels", 3}, {"samplers", json::array()}}};
  left_at_rest({"animations[1]", "is not an object"});
}

TEST_F(GltfMoving, RefusesBrokenSkins) {
  show_skin();
  const json before = file_.json;
  const auto again = [&] { file_.json = before; };
  file_.json["skins"][0]["joints"] = {1, 7};
  refused({"skins[0].joints[1]", "3 nodes"});
  again();
  file_.json["skins"][0]["joints"] = {1, 2, 0};
  refused({"skins[0].inverseBindMatrices", "2 matrices for 3 joints"});
  again();
  file_.json["skins"][0]["joints"] = {1};
  refused({"meshes[0].primitives[0].attributes.JOINTS_0[2]", "joint 1", "1 joints"});
  again();
  file_.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  refused({"meshes[0].primitives[0].attributes", "no WEIGHTS_0"});
  again();
  file_.json["nodes"][2]["children"] = {1};
  refused({"nodes[", "ancestor"});
  again();
  file_.json["nodes"][0]["skin"] = 1;
  refused({"nodes[0].skin", "1 skins"});
}

TEST_F(GltfMoving, RefusesBrokenTargets) {
  show_morph();
  const json before = file_.json;
  const auto again = [&] { file_.json = before; };
  file_.json["meshes"][0]["weights"] = {1, 1, 1};
  refused({"meshes[0].weights", "3 weights", "2 morph targets"});
  again();
  file_.json["nodes"][0]["weights"] = {1};
  refused({"nodes[0].weights", "1 weights", "2 morph targets"});
  again();
  drive(0, "weights", {0, 1}, {0, 0, 0});
  left_at_rest({"animations[0].samplers[0].output", "3 elements", "2 weights need 4"});
  again();
  file_.json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = 99;
  refused({"meshes[0].primitives[0].targets[1].POSITION", "99"});
  again();
  file_.json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = file_.positions({0, 0, 0});
  refused({"meshes[0].primitives[0].targets[1].POSITION", "1 elements, but POSITION 3"});
  again();
  json second = file_.json["meshes"][0]["primitives"][0];
  second["targets"].erase(1);
  file_.json["meshes"][0]["primitives"].push_back(second);
  refused({"meshes[0].primitives[1].targets", "has 1", "has 2"});
}

// Naming one target many times costs a hundred bytes each, but the memory of all its vertices.
TEST_F(GltfMoving, RefusesMoreTargetsThanTheFileHasBytes) {
  std::vector<float> many(3 * 20000, 0.5f);
  const std::size_t accessor = file_.positions(many);
  json targets = json::array();
  for (int t = 0; t < 2000; ++t) targets.push_back({{"POSITION", accessor}});
  file_.show({{"attributes", {{"POSITION", accessor}}}, {"targets", targets}});
  const std::string file = write("many.gltf", file_.text());
  expect_refused(file, kOutOfMemory, {"far more memory than the file has bytes"});
}

}  // namespace
}  // namespace raysheaf::test
