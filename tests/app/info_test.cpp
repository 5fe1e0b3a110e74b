// `raysheaf info` lists the contents of a scene as text and as JSON.
#include <gtest/gtest.h>

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
  EXPECT_NE(text.out.find("triangles  792\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("meshes     7\n"), std::string::npos) << text.out;
  for (const char* word : {"materials", "lights", "cameras", "bounds"}) {
    EXPECT_NE(text.out.find(word), std::string::npos) << word;
  }
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
    const Finished text = raysheaf_app({"info", "c.gltf"}, folder);
    EXPECT_EQ(text.out.find(" thin ") != std::string::npos, thin) << text.out;
  }
}

TEST(Info, ListsWhatCanBePlayed) {
  const TemporaryFolder folder;
  write_file(folder.file("m.bin"), moving_triangle_numbers(1.5f, 3));
  write_file(folder.file("m.gltf"), kMovingGltfTriangle);
  const Finished text = raysheaf_app({"info", "m.gltf"}, folder);
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
