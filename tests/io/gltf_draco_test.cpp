// A glTF file with compressed primitives gives the same scene as the uncompressed file.
#include "tests/io/pack_support.h"

#ifdef RAYSHEAF_HAS_DRACO
#include <draco/compression/encode.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "support/pictures.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using enum ErrorCode;

/// A mesh to be compressed, attribute by attribute.
class Packed {
 public:
  explicit Packed(const Mesh& mesh) {
    points_ = static_cast<std::uint32_t>(mesh.positions.size());
    mesh_.set_num_points(points_);
    mesh_.SetNumFaces(mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      draco::Mesh::Face face;
      for (std::size_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(mesh.triangles[i][k]);
      mesh_.SetFace(draco::FaceIndex(i), face);
    }
    add(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, mesh.positions);
  }
  /// Returns the attribute's id. `values` has `width` components of `type` for each vertex.
  template <class Value>
  int add(draco::GeometryAttribute::Type kind, draco::DataType type, int width,
          const std::vector<Value>& values) {
    draco::GeometryAttribute attribute;
    const int stride = width * draco::DataTypeLength(type);
    attribute.Init(kind, nullptr, static_cast<std::uint8_t>(width), type, false, stride, 0);
    const int id = mesh_.AddAttribute(attribute, true, points_);
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    for (std::uint32_t i = 0; i < points_; ++i, bytes += stride)
      mesh_.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), bytes);
    return id;
  }
  struct Encoded {
    Bytes bytes;
    std::size_t points = 0;  ///< Edgebreaker omits vertices without a triangle
  };
  /// `bits` of quantisation for positions; 0: no quantisation.
  [[nodiscard]] Encoded encoded(draco::MeshEncoderMethod method, int bits = 0) const {
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetTrackEncodedProperties(true);
    for (const auto kind :
         {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::TEX_COORD})
      if (bits > 0) encoder.SetAttributeQuantization(kind, bits);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh_, &buffer).ok()) throw std::logic_error("not packed");
    return {{buffer.data(), buffer.data() + buffer.size()}, encoder.num_encoded_points()};
  }

 private:
  draco::Mesh mesh_;
  std::uint32_t points_ = 0;
};

using Corners = std::array<Vec3, 3>;

bool comes_before(Vec3 a, Vec3 b) {
  return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}
/// The triangles in a canonical order, because Draco reorders vertices and triangles.
std::vector<Corners> triangles_of(const Mesh& mesh) {
  std::vector<Corners> all;
  for (const auto& t : mesh.triangles) {
    Corners c{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end(), comes_before), c.end());
    all.push_back(c);
  }
  std::sort(all.begin(), all.end(), [](const Corners& a, const Corners& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), comes_before);
  });
  return all;
}

class Draco : public PackTest {
 protected:
  Draco() {
    file_.json["extensionsUsed"] =
        file_.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  }

  std::size_t accessor(std::size_t count, const char* type, int component) {
    return file_.add("accessors", {{"count", count}, {"type", type}, {"componentType", component}});
  }
  /// A primitive with positions and indices.
  json primitive(const Packed& packed, draco::MeshEncoderMethod method, int bits = 0,
                 int index_component = 5125) {
    const Packed::Encoded encoded = packed.encoded(method, bits);
    return {{"attributes", {{"POSITION", accessor(encoded.points, "VEC3", 5126)}}},
            {"indices", accessor(3 * ball_.triangles.size(), "SCALAR", index_component)},
            {"extensions",
             {{"KHR_draco_mesh_compression",
               {{"bufferView", file_.view(encoded.bytes)}, {"attributes", {{"POSITION", 0}}}}}}}};
  }
  static json& packing(json& primitive) {
    return primitive["extensions"]["KHR_draco_mesh_compression"];
  }
  /// Adds a compressed attribute.
  void add(json& primitive, const char* name, int id, const char* type, int component) {
    primitive["attributes"][name] = accessor(ball_.positions.size(), type, component);
    packing(primitive)["attributes"][name] = id;
  }
  SceneDescription loaded() { return load_scene(write("ball.gltf", file_.text())); }
  void show_ball() { file_.show(primitive(Packed(ball_), draco::MESH_EDGEBREAKER_ENCODING)); }
  json& shown() { return file_.json["meshes"][0]["primitives"][0]; }
  void expect_broken(const std::vector<std::string>& words, ErrorCode code = kInvalidData) {
    expect_refused(write("broken.gltf", file_.text()), code, words);
  }

  const Mesh ball_ = ball(9, 1);
  GltfFile file_;
};

TEST_F(Draco, TrianglesOfBothMethodsAreUnpacked) {
  const Packed packed(ball_);
  for (const int component : {5123, 5125}) {
    for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
      file_.show(primitive(packed, method, 0, component));
  }
  const SceneDescription scene = loaded();
  ASSERT_EQ(scene.meshes.size(), 4u);
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_EQ(triangles_of(mesh), triangles_of(ball_));
  }
  EXPECT_TRUE(same_bits(scene.meshes[0].positions, ball_.positions));
  EXPECT_EQ(scene.meshes[0].triangles, ball_.triangles);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(Draco, FewerBitsGivePositionsNearby) {
  file_.show(primitive(Packed(ball_), draco::MESH_SEQUENTIAL_ENCODING, 14));
  const SceneDescription scene = loaded();
  for (std::size_t i = 0; i < ball_.positions.size(); ++i)
    ASSERT_LT(length(scene.meshes[0].positions[i] - ball_.positions[i]), 2e-4f);
}

TEST_F(Draco, AttributesOfAllTypesAreUnpacked) {
  Packed packed(ball_);
  std::vector<std::array<std::uint8_t, 4>> colors;
  std::vector<std::array<std::uint16_t, 2>> uvs;
  for (std::uint32_t i = 0; i < ball_.positions.size(); ++i) {
    const auto byte = static_cast<std::uint8_t>(i * 7);
    colors.push_back({byte, 255, 0, 128});
    uvs.push_back({static_cast<std::uint16_t>(i * 300), 65535});
  }
  using Attribute = draco::GeometryAttribute;
  const int normal = packed.add(Attribute::NORMAL, draco::DT_FLOAT32, 3, ball_.normals);
  const int uv = packed.add(Attribute::TEX_COORD, draco::DT_UINT16, 2, uvs);
  const int color = packed.add(Attribute::COLOR, draco::DT_UINT8, 4, colors);
  json made = primitive(packed, draco::MESH_SEQUENTIAL_ENCODING);
  add(made, "NORMAL", normal, "VEC3", 5126);
  add(made, "TEXCOORD_0", uv, "VEC2", 5123);
  file_.json["accessors"].back()["normalized"] = true;
  add(made, "COLOR_0", color, "VEC4", 5121);
  file_.json["accessors"].back()["normalized"] = true;
  file_.show(made);
  const SceneDescription scene = loaded();
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.normals.size(), ball_.normals.size());
  ASSERT_EQ(mesh.uvs.size(), uvs.size());
  ASSERT_EQ(mesh.colors.size(), colors.size());
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    EXPECT_LT(length(mesh.normals[i] - ball_.normals[i]), 1e-6f);
    EXPECT_EQ(mesh.uvs[i].x, static_cast<float>(uvs[i][0]) / 65535);
    EXPECT_EQ(mesh.colors[i].x, static_cast<float>(colors[i][0]) / 255);
    EXPECT_EQ(mesh.colors[i].y, 1);
  }
}

TEST_F(Draco, TextureCoordinatesAreUnpackedWithTheirTriangles) {
  std::vector<std::array<float, 2>> uvs;
  for (const Vec3 p : ball_.positions) uvs.push_back({p.x, p.y});
  Packed packed(ball_);
  const int uv = packed.add(draco::GeometryAttribute::TEX_COORD, draco::DT_FLOAT32, 2, uvs);
  json made = primitive(packed, draco::MESH_EDGEBREAKER_ENCODING, 14);
  add(made, "TEXCOORD_0", uv, "VEC2", 5126);
  file_.json["accessors"].back()["count"] = file_.json["accessors"][0]["count"];
  file_.show(made);
  const SceneDescription scene = loaded();
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    EXPECT_NEAR(mesh.uvs[i].x, mesh.positions[i].x, 3e-4f);
    EXPECT_NEAR(mesh.uvs[i].y, mesh.positions[i].y, 3e-4f);
  }
}

TEST_F(Draco, PrimitivesMayShareCompressedData) {
  show_ball();
  json& primitives = file_.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const SceneDescription scene = loaded();
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2 * ball_.triangles.size());
  EXPECT_LE(scene.meshes[0].positions.size(), ball_.positions.size());
}

TEST_F(Draco, WhereItIsNotRequiredItStillCounts) {
  show_ball();
  file_.json.erase("extensionsRequired");
  file_.json["accessors"][0]["bufferView"] = file_.view(std::vector<float>(3, 7.0f));
  EXPECT_EQ(triangles_of(loaded().meshes[0]), triangles_of(ball_));
}

TEST_F(Draco, SuchFilesAreNotPackedInWindows) {
  show_ball();
  EXPECT_FALSE(is_taken(write("ball.glb", file_.glb())));
}

TEST_F(Draco, ErrorsNameTheirPlace) {
  show_ball();
  const json good = file_.json;
  const std::string place = "meshes[0].primitives[0]";
  const std::string here = place + ".extensions.KHR_draco_mesh_compression";
  const auto with = [&](const auto& change, const std::vector<std::string>& words,
                        ErrorCode code = kInvalidData) {
    change();
    expect_broken(words, code);
    file_.json = good;
  };
  with([&] { packing(shown()).erase("bufferView"); }, {here + ".bufferView", "missing"});
  with([&] { packing(shown())["bufferView"] = 1; }, {here + ".bufferView", "1 bufferViews"});
  with([&] { packing(shown())["attributes"] = json::object(); }, {here + ".attributes", "empty"});
  with([&] { packing(shown())["attributes"]["POSITION"] = -1; }, {here + ".attributes.POSITION"});
  with([&] { packing(shown())["attributes"]["POSITION"] = 3; },
       {here + ".attributes.POSITION", "not among the compressed"});
  with([&] { packing(shown())["attributes"]["NORMAL"] = 1; },
       {here + ".attributes.NORMAL", "not an attribute of the primitive"});
  with([&] { shown().erase("indices"); }, {place + ".indices", "missing"});
  with([&] { shown()["mode"] = 5; }, {place + ".mode", "strips"}, kUnsupported);
  with([&] { file_.json["accessors"][0]["count"] = 4; }, {here, "accessors[0]", "4 vertices"});
  with([&] { file_.json["accessors"][1]["count"] = 6; }, {here, "accessors[1]", "2 triangles"});
  with([&] { file_.json["accessors"][0]["type"] = "VEC2"; },
       {here + ".attributes.POSITION", "3 numbers", "of 2"});
  with([&] { file_.json["accessors"][1]["componentType"] = 5126; }, {"unsigned"});
  with([&] { file_.json["accessors"][1]["componentType"] = 5120; },
       {"accessors[1].componentType", "not of its type"});
  with([&] { file_.json["accessors"][0]["count"] = 1u << 28; }, {"accessors[0].count", "too many"},
       kOutOfMemory);
  with(
      [&] {
        json second = shown();
        packing(second)["bufferView"] =
            file_.view(Packed(ball_).encoded(draco::MESH_SEQUENTIAL_ENCODING).bytes);
        file_.json["meshes"][0]["primitives"].push_back(second);
      },
      {"meshes[0].primitives[1]", "accessors[1]", "another"}, kUnsupported);
}

TEST_F(Draco, DamagedBytesAreRefusedOrRead) {
  for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    file_ = GltfFile();
    file_.show(primitive(Packed(ball_), method, 11));
    Random random(5);
    const Bytes whole = file_.buffer;
    for (int i = 0; i < 300; ++i) {
      file_.buffer = whole;
      for (std::uint32_t k = 0; k <= random.below(4); ++k)
        file_.buffer[random.below(static_cast<std::uint32_t>(whole.size()))] =
            static_cast<std::uint8_t>(random.below(256));
      try {
        static_cast<void>(load_scene(write("damaged.gltf", file_.text())));
      } catch (const Error& error) {
        EXPECT_NE(error.code(), kOutOfMemory) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
#endif
