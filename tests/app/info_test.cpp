// `raysheaf info` lists the contents of a scene as text and as JSON.
#include <gtest/gtest.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "tests/support/gltf_triangle.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

TEST(Info, TextAndJsonAgree) {
  const TemporaryFolder folder;
  const Finished text = raysheaf_app({"info", "builtin:cornell"}, folder);
  const Finished json = raysheaf_app({"info", "builtin:cornell", "--json"}, folder);
  ASSERT_EQ(text.code, 0) << text.err;
  const Json info = Json::parse(json.out);
  EXPECT_EQ(info.at("triangles"), 792);
  EXPECT_EQ(info.at("meshes").size(), 7u);
  EXPECT_EQ(info.at("kind"), "built-in scene");
  EXPECT_EQ(info.at("unit"), nullptr);
  EXPECT_GE(info.at("geometry_bytes"), 792 * 12);
  EXPECT_NE(text.out.find("triangles  792\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("meshes     7, 7 instances\n"), std::string::npos) << text.out;
  for (const char* word : {"materials", "lights", "cameras", "size", "memory"}) {
    EXPECT_NE(text.out.find(word), std::string::npos) << word;
  }
}

TEST(Info, BeginsWithASummaryOfTenLines) {
  const TemporaryFolder folder;
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const Finished summary = raysheaf_app({"info", "builtin:office"}, folder);
  const Finished all = raysheaf_app({"info", "builtin:office", "--all"}, folder);
  EXPECT_EQ(lines(summary.out), 10) << summary.out;
  EXPECT_TRUE(all.out.starts_with(summary.out)) << all.out;
  EXPECT_GT(lines(all.out), 60);
  EXPECT_NE(summary.out.find("scene      office (built-in scene)\n"), std::string::npos);
  EXPECT_NE(summary.out.find(" units, from ("), std::string::npos) << summary.out;
  EXPECT_NE(summary.out.find("B of geometry"), std::string::npos) << summary.out;
  EXPECT_NE(summary.out.find("ignored    nothing\n"), std::string::npos) << summary.out;
}

TEST(Info, SummaryNamesWhatWasIgnoredAndWhatIsMissing) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 3 0\nf 1 2 3\n");
  const std::string text = raysheaf_app({"info", "a.obj"}, folder).out;
  EXPECT_NE(text.find("(OBJ file)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("size       1 x 3 x 0 units"), std::string::npos) << text;
  EXPECT_NE(text.find("ignored    1 warning\n           The material library \"none.mtl\""),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("memory     84 bytes of geometry\n"), std::string::npos) << text;
  EXPECT_NE(text.find("cameras    none; rendering adds"), std::string::npos) << text;
  EXPECT_NE(text.find("lights     none; rendering adds"), std::string::npos) << text;
  ASSERT_EQ(raysheaf_app({"scene", "cornell", "-o", "c.glb"}, folder).code, 0);
  const std::string glb = raysheaf_app({"info", "c.glb"}, folder).out;
  EXPECT_NE(glb.find("(binary glTF file)\n"), std::string::npos) << glb;
  EXPECT_NE(glb.find(" m, from ("), std::string::npos) << glb;
}

TEST(Info, SaysWhichGlassIsThin) {
  const TemporaryFolder folder;
  write_file(folder.file("c.bin"), gltf_triangle_corners());
  for (const bool thin : {false, true}) {
    Json gltf = Json::parse(kGltfTriangle);
    gltf.erase("images");
    Json& extensions = gltf["materials"][0]["extensions"];
    extensions["KHR_materials_transmission"]["transmissionFactor"] = 1;
    if (!thin) extensions["KHR_materials_volume"]["thicknessFactor"] = 1;
    write_file(folder.file("c.gltf"), gltf.dump());
    const Finished json = raysheaf_app({"info", "c.gltf", "--json"}, folder);
    EXPECT_EQ(Json::parse(json.out).at("materials").at(0).at("thin"), thin) << json.err;
    const Finished text = raysheaf_app({"info", "c.gltf", "--all"}, folder);
    EXPECT_EQ(text.out.find(" thin ") != std::string::npos, thin) << text.out;
  }
}

TEST(Info, ListsWhatCanBePlayed) {
  const TemporaryFolder folder;
  write_file(folder.file("m.bin"), moving_triangle_numbers(1.5f, 3));
  write_file(folder.file("m.gltf"), kMovingGltfTriangle);
  const Finished text = raysheaf_app({"info", "m.gltf", "--all"}, folder);
  EXPECT_NE(text.out.find("animations Walk, 1.5 s\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("1.5       -  Walk\n"), std::string::npos) << text.out << text.err;
  EXPECT_EQ(text.out.find("warning"), std::string::npos) << text.out;
  Json info = Json::parse(raysheaf_app({"info", "m.gltf", "--json"}, folder).out);
  EXPECT_EQ(info.at("animations"),
            Json::parse(R"([{"name": "Walk", "start": 0.0, "end": 1.5, "frames": null}])"));
  EXPECT_EQ(info.at("bounds").at("max").at(0), 1) << "at rest";

  for (const char* name : {"f_1.obj", "f_2.obj"})
    write_file(folder.file(name), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  info = Json::parse(raysheaf_app({"info", "f_*.obj", "--json"}, folder).out);
  EXPECT_EQ(info.at("animations").at(0).at("frames"), 2);
  EXPECT_EQ(info.at("triangles"), 1);
  info = Json::parse(raysheaf_app({"info", "f_1.obj", "--json"}, folder).out);
  EXPECT_TRUE(info.at("animations").empty());
}

}  // namespace
}  // namespace raysheaf::test
