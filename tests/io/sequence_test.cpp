// Sequences of files: the frame at a given time, the reported changes, and invalid sequences.
#include "raysheaf/animation.h"
#include "raysheaf/cameras.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using enum ErrorCode;

/// One object with a single triangle for each of `places`, which are x coordinates.
std::string triangles_at(const std::vector<float>& places, const std::string& material = "") {
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string x = std::to_string(places[i]), x1 = std::to_string(places[i] + 1);
    text += "o t" + std::to_string(i) + "\nv " + x + " 0 0\nv " + x1 + " 0 0\nv " + x + " 1 0\n";
    if (!material.empty()) text += "usemtl " + material + "\n";
    text += "f -3 -2 -1\n";
  }
  return text;
}

class Sequence : public IoTest {
 protected:
  Sequence() {
    write("still.obj", triangles_at({100, 200}));
    write("f_1.obj", triangles_at({0, 5}));
    write("f_2.obj", triangles_at({0, 6}));
    write("f_10.obj", triangles_at({0, 6, 7}));
  }
  [[nodiscard]] std::unique_ptr<Animation> load() const {
    SequenceFiles files;
    files.still = path("still.obj");
    files.frames = files_like(path("f_*.obj"));
    return load_sequence(files);
  }
  void refused(const json& description, ErrorCode code, const std::vector<std::string>& words) {
    const std::string file = write("scene.json", description.dump());
    try {
      static_cast<void>(load_animation(file));
      ADD_FAILURE() << "was read: " << description.dump();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(file)) << what;
      for (const std::string& word : words)
        EXPECT_NE(what.find(word), what.npos) << "no \"" << word << "\" in: " << what;
    }
  }
};

TEST_F(Sequence, NamesAreInTheOrderOfTheirNumbers) {
  EXPECT_EQ(files_like(path("f_*.obj")),
            (std::vector<std::string>{path("f_1.obj"), path("f_2.obj"), path("f_10.obj")}));
  EXPECT_EQ(files_like(path("f_?.obj")).size(), 2u);
  EXPECT_THROW(static_cast<void>(files_like(path("g_*.obj"))), Error);
  EXPECT_THROW(static_cast<void>(files_like(path("nowhere/f_*.obj"))), Error);
}

TEST_F(Sequence, ReportsReplacedMeshes) {
  const auto animation = load();
  const SceneDescription& scene = animation->scene();
  EXPECT_EQ(frame_count(*animation, 1), 3u) << "a sequence has its own times";
  ASSERT_EQ(scene.meshes.size(), 4u);
  EXPECT_TRUE(animation->seek(-1).empty());
  SceneChanges changes = animation->seek(frame_time(*animation, 1, 24));
  EXPECT_EQ(changes.deformed, std::vector<std::uint32_t>{3}) << "the same triangles, moved";
  EXPECT_EQ(changes.other_meshes_from, kInvalidId);
  EXPECT_EQ(scene.meshes[3].positions[0].x, 6);
  changes = animation->seek(animation->end());
  EXPECT_FALSE(changes.everything);
  EXPECT_TRUE(changes.deformed.empty());
  EXPECT_EQ(changes.other_meshes_from, 4u);
  EXPECT_EQ(changes.other_instances_from, 4u);
  ASSERT_EQ(scene.instances.size(), 5u);
  EXPECT_EQ(scene.instances[4].mesh, 4u);
  validate(scene);
  changes = animation->seek(0);
  EXPECT_EQ(scene.meshes.size(), 4u);
  EXPECT_EQ(changes.deformed, std::vector<std::uint32_t>{3});
  EXPECT_EQ(changes.other_meshes_from, 4u);
  validate_changes(scene, changes);
}

TEST_F(Sequence, GlassThatBecomesThinIsReported) {
  for (const bool thin : {false, true}) {
    GltfFile file;
    file.show_triangle();
    json& glass = file.json["materials"][0];
    glass["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
    glass["extensions"]["KHR_materials_volume"]["thicknessFactor"] = thin ? 0 : 1;
    write(thin ? "g_2.gltf" : "g_1.gltf", file.text());
  }
  const auto animation = load_animation(path("g_*.gltf"), {});
  EXPECT_FALSE(animation->scene().materials.at(0).thin);
  EXPECT_TRUE(animation->seek(animation->end()).everything);
  EXPECT_TRUE(animation->scene().materials.at(0).thin);
}

TEST_F(Sequence, SaysWhatEachFrameLeavesOutOnce) {
  write("m.mtl", "newmtl red\nKd 1 0 0\n");
  const std::string head = "mtllib m.mtl\n";
  write("w_1.obj", head + triangles_at({0}, "red"));
  write("w_2.obj", head + triangles_at({1}, "zzz"));
  write("w_3.obj", head + triangles_at({2}, "zzz") + "p 1\n");
  for (const bool preload : {false, true}) {
    const auto animation = load_animation(path("w_*.obj"), {.preload = preload});
    const std::vector<std::string>& warnings = animation->scene().warnings;
    EXPECT_TRUE(warnings.empty());
    for (const std::size_t frame : {1u, 2u, 1u, 0u, 2u}) {
      static_cast<void>(animation->seek(animation->frame_times()[frame]));
      EXPECT_GE(warnings.size(), frame);
    }
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_TRUE(warns(animation->scene(), "zzz"));
    EXPECT_TRUE(warns(animation->scene(), "Points"));
  }
}

TEST_F(Sequence, KeepsMaterialsThatTheFramesShare) {
  write("m.mtl", "newmtl red\nKd 1 0 0\nmap_Kd red.png\n");
  write_png({"red", 1, 1, {255, 0, 0, 255}}, path("red.png"));
  write("c_1.obj", "mtllib m.mtl\n" + triangles_at({0}, "red"));
  write("c_2.obj", "mtllib m.mtl\n" + triangles_at({1}, "red"));
  write("c_3.obj", triangles_at({1}, "blue"));
  SequenceFiles files;
  files.still = path("still.obj");
  files.frames = files_like(path("c_*.obj"));
  for (const bool preload : {false, true}) {
    LoadOptions options;
    options.preload = preload;
    const auto animation = load_sequence(files, options);
    const SceneDescription& scene = animation->scene();
    const std::uint32_t red = scene.meshes[2].materials.at(0);
    EXPECT_EQ(scene.materials[red].name, "red");
    const std::uint32_t texture = scene.materials[red].base_color_texture.texture;
    EXPECT_EQ(scene.images[scene.textures[texture].image].rgba[0], 255);
    SceneChanges changes = animation->seek(frame_time(*animation, 1, 24));
    EXPECT_FALSE(changes.everything);
    EXPECT_EQ(changes.deformed, std::vector<std::uint32_t>{2});
    changes = animation->seek(animation->end());
    EXPECT_TRUE(changes.everything) << "another material";
    EXPECT_TRUE(scene.images.empty());
    validate(scene);
    changes = animation->seek(0);
    EXPECT_TRUE(changes.everything) << "the first one again";
    EXPECT_EQ(scene.materials[scene.meshes[2].materials.at(0)].name, "red");
    EXPECT_EQ(scene.images.size(), 1u);
    validate(scene);
  }
}

TEST_F(Sequence, KeepsItsStateIfAFrameCannotBeRead) {
  const auto animation = load();
  write("f_2.obj", "v 0 0\n");
  EXPECT_THROW(animation->seek(frame_time(*animation, 1, 24)), Error);
  EXPECT_EQ(animation->scene().meshes[3].positions[0].x, 5);
  EXPECT_EQ(animation->seek(animation->end()).deformed, std::vector<std::uint32_t>{3});
}

TEST_F(Sequence, KeepsWhatWasAddedToItsScene) {
  const auto animation = load();
  add_missing_camera_and_light(animation->scene());
  static_cast<void>(animation->seek(animation->end()));
  EXPECT_EQ(animation->scene().cameras.size(), 1u);
  EXPECT_EQ(animation->scene().lights.size(), 3u);
}

TEST_F(Sequence, ReadsNoFileWhereFramesArePreloaded) {
  SequenceFiles files;
  files.still = path("still.obj");
  files.frames = files_like(path("f_*.obj"));
  LoadOptions options;
  options.preload = true;
  const auto kept = load_sequence(files, options), read = load_sequence(files);
  const auto same = [&] {
    ASSERT_EQ(kept->scene().meshes.size(), read->scene().meshes.size());
    for (std::size_t m = 0; m < kept->scene().meshes.size(); ++m)
      EXPECT_EQ(kept->scene().meshes[m].positions[0].x, read->scene().meshes[m].positions[0].x);
  };
  for (const std::size_t frame : {1, 2, 0, 2}) {
    const SceneChanges changes = kept->seek(frame_time(*kept, frame, 24));
    EXPECT_EQ(changes.deformed, read->seek(frame_time(*read, frame, 24)).deformed);
    same();
  }
  for (const std::string& name : files.frames) std::filesystem::remove(name);
  EXPECT_EQ(kept->seek(kept->start()).deformed, std::vector<std::uint32_t>{3});
  EXPECT_EQ(kept->scene().meshes[3].positions[0].x, 5);
  write("f_1.obj", triangles_at({0, 5}));
  write("f_2.obj", "v 0 0\n");
  files.frames.pop_back();
  EXPECT_THROW(static_cast<void>(load_sequence(files, options)), Error) << "at once";
}

json described() {
  const json camera = {{"eye", {0, 0, 5}}, {"direction", {0, 0, -1}}};
  return {{"static", "still.obj"},
          {"name", "moving"},
          {"camera_default",
           {{"eye", {0, 9, 0}},
            {"target", {0, 0, 0}},
            {"up", {0, 0, -1}},
            {"full_field_of_view_degrees", 90}}},
          {"lights", {{{"position", {1, 2, 3}}, {"color", {4, 5, 6}}}}},
          {"frames",
           {{{"file", "f_1.obj"}, {"time", 1.5}, {"camera", camera}},
            {{"file", "f_2.obj"}, {"time", 4}, {"camera", camera}}}}};
}

TEST_F(Sequence, IsDescribedByJson) {
  json description = described();
  description["frames"][1]["camera"]["eye"] = {0, 0, 7};
  const auto animation = load_animation(write("scene.json", description.dump()));
  const SceneDescription& scene = animation->scene();
  EXPECT_EQ(scene.name, "moving");
  EXPECT_EQ(animation->start(), 1.5);
  EXPECT_EQ(animation->frame_times(), (std::vector<double>{1.5, 4}));
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "moving");
  EXPECT_EQ(scene.cameras[0].to_world.m[2][3], 5);
  EXPECT_NEAR(scene.cameras[0].y_fov, 1.5707963f, 1e-6f);
  EXPECT_EQ(scene.cameras[1].name, "default");
  EXPECT_NEAR(scene.cameras[1].to_world.m[1][2], 1, 1e-6f) << "looks down";
  EXPECT_EQ(scene.lights.at(0).intensity.y, 5);
  EXPECT_TRUE(animation->seek(3.99).empty());
  EXPECT_FALSE(animation->seek(4).empty());
  EXPECT_EQ(scene.cameras[0].to_world.m[2][3], 7);
}

TEST_F(Sequence, SaysWhatIsWrongWithItsJson) {
  const auto with = [](auto change) {
    json description = described();
    change(description);
    return description;
  };
  refused(with([](json& d) { d["frames"] = json::array(); }), kInvalidData,
          {"frames", "no frames"});
  refused(with([](json& d) { d["frames"][1].erase("file"); }), kInvalidData,
          {"frames[1].file", "missing"});
  refused(with([](json& d) { d["frames"][1]["file"] = "none.obj"; }), kNotFound, {"none.obj"});
  refused(with([](json& d) { d["frames"][1]["file"] = "../f_1.obj"; }), kUnsupported,
          {"frames[1].file"});
  refused(with([](json& d) { d["frames"][1]["time"] = 1; }), kInvalidData,
          {"frames[1].time", "later"});
  refused(with([](json& d) { d["frames"][1].erase("camera"); }), kInvalidData,
          {"frames[1]", "either every frame"});
  refused(with([](json& d) {
            d["frames"][0]["camera"]["direction"] = {0, 0, 0};
          }),
          kInvalidData, {"frames[0].camera.direction", "no viewing direction"});
  refused(with([](json& d) {
            d["frames"][0]["camera"]["eye"] = {0, "x", 0};
          }),
          kInvalidData, {"frames[0].camera.eye[1]", "number"});
  refused(with([](json& d) {
            d["camera_default"]["up"] = {0, 3, 0};
          }),
          kInvalidData, {"camera_default.up"});
  refused(with([](json& d) { d["camera_default"]["full_field_of_view_degrees"] = 180; }),
          kInvalidData, {"camera_default.full_field_of_view_degrees"});
  refused(with([](json& d) { d["lights"][0].erase("color"); }), kInvalidData,
          {"lights[0].color", "missing"});
  refused(json::array(), kInvalidData, {"not an object"});
}

TEST_F(Sequence, PathsOfCamerasAreRead) {
  const CameraPath p = load_camera_path(write("path.json", R"({"smooth": false, "keys": [
      {"time": 0, "position": [0, 1, 2], "look_at": [0, 0, 0], "fov": 90},
      {"time": 2, "position": [3, 1, 2], "look_at": [0, 0, 0], "up": [0, 0, 1]}]})"));
  EXPECT_FALSE(p.smooth);
  ASSERT_EQ(p.keys.size(), 2u);
  EXPECT_NEAR(p.keys[0].y_fov, 1.5707963f, 1e-6f);
  EXPECT_EQ(p.keys[1].up.z, 1);
  const auto refused_path = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string file = write("path.json", text);
    try {
      static_cast<void>(load_camera_path(file));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(file)) << what;
      for (const std::string& word : words)
        EXPECT_NE(what.find(word), what.npos) << "no \"" << word << "\" in: " << what;
    }
  };
  refused_path("{", {"JSON"});
  refused_path("{}", {"keys", "missing"});
  refused_path(R"({"keys": [{"position": [0, 1, 2]}]})", {"keys[0].time", "missing"});
  refused_path(R"({"keys": [{"time": 0, "position": [0, 1], "look_at": [0, 0, 0]}]})",
               {"keys[0].position", "three numbers"});
  refused_path(
      R"({"keys": [{"time": 0, "position": [0, 1, 2], "look_at": [0, 0, 0], "fov": 200}]})",
      {"keys[0].fov"});
  EXPECT_THROW(static_cast<void>(load_camera_path(path("nothing.json"))), Error);
}

}  // namespace
}  // namespace raysheaf::test
