// A glTF file with compressed buffer views gives the same scene as the uncompressed file.
#include "tests/io/io_support.h"

#ifdef RAYSHEAF_HAS_MESHOPT
#include <meshoptimizer.h>

#include <cmath>

#include "support/pictures.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using enum ErrorCode;

template <class T>
Bytes packed_attributes(const std::vector<T>& values, std::size_t stride) {
  const std::size_t count = values.size() * sizeof(T) / stride;
  Bytes bytes(meshopt_encodeVertexBufferBound(count, stride));
  bytes.resize(
      meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), count, stride));
  return bytes;
}
Bytes packed_triangles(const std::vector<std::uint32_t>& indices) {
  Bytes bytes(meshopt_encodeIndexBufferBound(indices.size(), 1u << 16));
  bytes.resize(
      meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}
Bytes packed_indices(const std::vector<std::uint32_t>& indices) {
  Bytes bytes(meshopt_encodeIndexSequenceBound(indices.size(), 1u << 16));
  bytes.resize(
      meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

class Meshopt : public IoTest {
 protected:
  Meshopt() {
    for (const Vec3 p : ball_.positions)
      for (const float x : {p.x, p.y, p.z}) positions_.push_back(x);
    for (const auto& t : ball_.triangles) indices_.insert(indices_.end(), t.begin(), t.end());
    vertices_ = ball_.positions.size();
    file_.json["extensionsUsed"] = file_.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  }

  /// An accessor of a compressed view; `packing`: mode, count, stride, filter.
  std::size_t accessor(const Bytes& bytes, json packing, json accessor) {
    const std::size_t count = packing["count"], stride = packing["byteStride"];
    const json packed = file_.json["bufferViews"][file_.view(bytes)];
    packing["buffer"] = 0;
    packing["byteOffset"] = packed["byteOffset"];
    packing["byteLength"] = packed["byteLength"];
    const std::size_t offset = fallback_;
    fallback_ += count * stride;
    accessor["bufferView"] =
        file_.add("bufferViews", {{"buffer", 1},
                                  {"byteOffset", offset},
                                  {"byteLength", count * stride},
                                  {"extensions", {{"EXT_meshopt_compression", packing}}}});
    accessor["count"] = accessor.value("count", count);
    return file_.add("accessors", accessor);
  }
  std::size_t packed_positions() {
    return accessor(packed_attributes(positions_, 12),
                    {{"mode", "ATTRIBUTES"}, {"count", vertices_}, {"byteStride", 12}},
                    {{"componentType", 5126}, {"type", "VEC3"}});
  }
  std::size_t index_accessor(const char* mode, const Bytes& bytes, std::size_t width) {
    return accessor(bytes, {{"mode", mode}, {"count", indices_.size()}, {"byteStride", width}},
                    {{"componentType", width == 2 ? 5123 : 5125}, {"type", "SCALAR"}});
  }
  /// The file as text; callers may change its compression extension first.
  std::string text() {
    json fallback = {{"byteLength", fallback_},
                     {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
    file_.json["buffers"] = {{{"byteLength", file_.buffer.size()}}, fallback};
    return file_.text();
  }
  json& packing() {
    for (json& view : file_.json["bufferViews"])
      if (view.contains("extensions")) return view["extensions"]["EXT_meshopt_compression"];
    throw std::logic_error("nothing is packed");
  }
  void show_ball() {
    file_.show({{"attributes", {{"POSITION", packed_positions()}}},
                {"indices", index_accessor("TRIANGLES", packed_triangles(indices_), 4)}});
  }
  void expect_broken(const std::vector<std::string>& words) {
    expect_refused(write("broken.gltf", text()), kInvalidData, words);
  }

  const Mesh ball_ = ball(9, 1);
  std::vector<float> positions_;
  std::vector<std::uint32_t> indices_;
  std::size_t vertices_ = 0, fallback_ = 0;
  GltfFile file_;
};

/// Triangles may begin at another of their corners.
void expect_same_triangles(const Mesh& mesh, const Mesh& expected) {
  ASSERT_EQ(mesh.triangles.size(), expected.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    auto t = mesh.triangles[i], e = expected.triangles[i];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::rotate(e.begin(), std::min_element(e.begin(), e.end()), e.end());
    ASSERT_EQ(t, e) << i;
  }
}

TEST_F(Meshopt, VerticesAndIndicesOfAllKindsAreUnpacked) {
  const std::size_t positions = packed_positions();
  for (const std::size_t width : {2u, 4u}) {
    for (const bool triangles : {true, false}) {
      const Bytes bytes = triangles ? packed_triangles(indices_) : packed_indices(indices_);
      const std::size_t indices = index_accessor(triangles ? "TRIANGLES" : "INDICES", bytes, width);
      file_.show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    }
  }
  file_.json["scenes"] = {{{"nodes", file_.roots}}};
  const SceneDescription scene = load_scene(write("ball.gltf", text()));
  ASSERT_EQ(scene.meshes.size(), 4u);
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_TRUE(same_bits(mesh.positions, ball_.positions));
    expect_same_triangles(mesh, ball_);
  }
}

TEST_F(Meshopt, FiltersRestoreNormals) {
  std::vector<float> normals;
  for (const Vec3 n : ball_.normals)
    for (const float x : {n.x, n.y, n.z, 0.0f}) normals.push_back(x);
  for (const std::size_t stride : {4u, 8u}) {
    Bytes filtered(vertices_ * stride);
    meshopt_encodeFilterOct(filtered.data(), vertices_, stride, stride == 4 ? 8 : 15,
                            normals.data());
    const std::size_t accessor_number = accessor(
        packed_attributes(filtered, stride),
        {{"mode", "ATTRIBUTES"},
         {"count", vertices_},
         {"byteStride", stride},
         {"filter", "OCTAHEDRAL"}},
        {{"componentType", stride == 4 ? 5120 : 5122}, {"type", "VEC3"}, {"normalized", true}});
    file_.json["bufferViews"].back()["byteStride"] = stride;
    file_.show({{"attributes", {{"POSITION", packed_positions()}, {"NORMAL", accessor_number}}},
                {"indices", index_accessor("TRIANGLES", packed_triangles(indices_), 4)}});
  }
  const SceneDescription scene = load_scene(write("ball.gltf", text()));
  ASSERT_EQ(scene.meshes.size(), 2u);
  for (std::size_t m = 0; m < 2; ++m) {
    ASSERT_EQ(scene.meshes[m].normals.size(), vertices_);
    for (std::size_t i = 0; i < vertices_; ++i)
      ASSERT_LT(length(scene.meshes[m].normals[i] - ball_.normals[i]), m == 0 ? 0.03f : 0.001f);
  }
}

TEST_F(Meshopt, PackedExponentsRestorePositions) {
  std::vector<std::uint32_t> filtered(positions_.size());
  meshopt_encodeFilterExp(filtered.data(), vertices_, 12, 20, positions_.data());
  const std::size_t accessor_number = accessor(
      packed_attributes(filtered, 12),
      {{"mode", "ATTRIBUTES"}, {"count", vertices_}, {"byteStride", 12}, {"filter", "EXPONENTIAL"}},
      {{"componentType", 5126}, {"type", "VEC3"}});
  file_.show({{"attributes", {{"POSITION", accessor_number}}},
              {"indices", index_accessor("TRIANGLES", packed_triangles(indices_), 4)}});
  const SceneDescription scene = load_scene(write("ball.gltf", text()));
  for (std::size_t i = 0; i < vertices_; ++i)
    ASSERT_LT(length(scene.meshes[0].positions[i] - ball_.positions[i]), 1e-5f);
}

TEST_F(Meshopt, TheFallbackBufferNeedsNoExtension) {
  show_ball();
  json whole = json::parse(text());
  whole["buffers"][1].erase("extensions");
  EXPECT_EQ(load_scene(write("a.gltf", whole.dump())).triangle_count(), ball_.triangles.size());
}

TEST_F(Meshopt, ErrorsNameTheirPlace) {
  show_ball();
  const json good = packing();
  const std::string place = "bufferViews[1].extensions.EXT_meshopt_compression";
  packing()["mode"] = "FAST";
  expect_broken({place + ".mode", "FAST"});
  packing() = good;
  packing()["filter"] = "QUATERNION";
  expect_broken({place + ".byteStride", "12"});
  packing()["filter"] = "SOFT";
  expect_broken({place + ".filter", "SOFT"});
  packing() = good;
  packing()["count"] = vertices_ + 1;
  expect_broken({place, "12 bytes"});
  packing() = good;
  packing()["byteLength"] = file_.buffer.size() + 1;
  expect_broken({place, "buffers[0]"});
  packing() = good;
  packing()["buffer"] = 1;
  expect_broken({place + ".buffer", "without data"});
  packing() = good;
  packing().erase("count");
  expect_broken({place + ".count", "missing"});
  packing() = good;
  packing()["byteLength"] = 8;
  expect_broken({place + ".byteLength", "too few"});
  packing() = good;
  packing()["byteLength"] = good["byteLength"].get<std::size_t>() - 1;
  expect_broken({"bufferViews[1]", "damaged"});
  packing() = good;
  file_.json["bufferViews"][1].erase("extensions");
  expect_broken({"bufferViews[1].buffer", "without data"});
}

TEST_F(Meshopt, TheSuccessorIsReadAsFarAsTheLibraryGoes) {
  show_ball();
  const auto as_khr = [&] {
    std::string renamed = text();
    for (std::size_t at; (at = renamed.find("EXT_meshopt")) != renamed.npos;)
      renamed.replace(at, 3, "KHR");
    return renamed;
  };
  const SceneDescription scene = load_scene(write("khr.gltf", as_khr()));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(same_bits(scene.meshes[0].positions, ball_.positions));
  const json good = packing();
  packing()["filter"] = "COLOR";
  expect_broken({".filter", "COLOR"});  // only the newer extension has it
  packing() = good;
  if (MESHOPTIMIZER_VERSION < 230) {
    file_.buffer[packing()["byteOffset"].get<std::size_t>()] = 0xa1;
    expect_refused(write("new.gltf", as_khr()), kUnsupported,
                   {"KHR_meshopt_compression", "meshoptimizer 0.23"});
  }
}

TEST_F(Meshopt, DamagedBytesAreRefusedOrRead) {
  show_ball();
  Random random(5);
  const Bytes whole = file_.buffer;
  for (int i = 0; i < 300; ++i) {
    file_.buffer = whole;
    for (std::uint32_t k = 0; k <= random.below(4); ++k)
      file_.buffer[random.below(static_cast<std::uint32_t>(whole.size()))] =
          static_cast<std::uint8_t>(random.below(256));
    try {
      static_cast<void>(load_scene(write("damaged.gltf", text())));
    } catch (const Error& error) {
      EXPECT_NE(error.code(), kOutOfMemory) << error.what();
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
#endif
