// Packs STL and PLY into blocks without holding them in memory.
#include "support/random.h"
#include "tests/io/pack_support.h"

namespace raysheaf::test {
namespace {

class Pack : public PackTest {
 protected:
  /// A binary STL of several kinds of triangles. With `ties`, corners lie on a coarse grid;
  /// without, triangles have colours.
  std::string stl(const std::string& name, std::uint32_t count, bool ties) {
    Random random(count);
    Bytes bytes(80, ' ');
    append(bytes, count);
    for (std::uint32_t t = 0; t < count; ++t) {
      const Vec3 at = random.in_box(ties ? 2.0f : 50.0f);
      for (int i = 0; i < 3; ++i) append(bytes, 0.0f);
      for (int k = 0; k < 3; ++k) {
        const Vec3 size = random.in_box(1);
        for (const float x : {at.x + size.x, at.y + size.y, 0.1f * (at.z + size.z)})
          append(bytes, ties ? std::round(x) : x);
      }
      append(bytes, static_cast<std::uint16_t>(ties ? 0 : 0x8000 | t / 3 * 37));
    }
    return write(name, bytes);
  }

  /// The numbers of a PLY file of either byte order.
  struct PlyBody {
    bool little = true;
    Bytes bytes;
    template <class T>
    void put(T value) {
      little ? append(bytes, value) : append_swapped(bytes, value);
    }
  };
  enum class Normals { kNone, kSome, kAll };

  /// A bent sheet of `side` by `side` quads, some as triangles and some as strips; and fans with
  /// creases that have separate corners where other triangles share theirs.
  std::string ply(const std::string& name, std::uint32_t side, Normals normals, bool little) {
    Random random(side);
    const std::uint32_t across = side + 1, sheet = across * across, soup = 30 * side;
    PlyBody body{little, {}};
    const auto vertex = [&](float x, float y, float z, std::uint32_t number) {
      body.put(static_cast<double>(x)), body.put(y), body.put(std::uint8_t(number % 3));
      for (std::uint32_t i = 0; i < number % 3; ++i) body.put(std::int16_t(7));
      body.put(z);
      if (normals == Normals::kNone) return;
      const bool has = normals == Normals::kAll || number % 5 != 0;
      body.put(has ? 1.0f : 0.0f), body.put(0.0f), body.put(has ? 2.0f : 0.0f);
    };
    const auto height = [](std::uint32_t i, std::uint32_t k) {
      return i % 7 == 3 ? 4.0f : 0.25f * static_cast<float>(i * k % 5) - 0.0f;
    };
    for (std::uint32_t v = 0; v < sheet; ++v)
      vertex(static_cast<float>(v % across) - 3, static_cast<float>(v / across),
             height(v % across, v / across), v);
    for (std::uint32_t v = 0; v < soup; ++v) {
      const std::uint32_t i = v % 3 == 0 ? 2 : static_cast<std::uint32_t>(random.in_box(9).x + 9);
      vertex(static_cast<float>(i) - 3, i % 2 == 0 ? -0.0f : 0.0f, height(i, 0), v);
    }
    std::uint32_t faces = 0;
    const auto face = [&](std::initializer_list<std::uint32_t> corners) {
      body.put(std::uint8_t(corners.size()));
      for (const std::uint32_t v : corners) body.put(v);
      ++faces;
    };
    for (std::uint32_t i = 0; i < side; ++i) {
      for (std::uint32_t k = 0; k < side; ++k) {
        const std::uint32_t v = i + across * k;
        if ((i + k) % 3 == 0)
          face({v, v + 1, v + across + 1, v + across});
        else
          face({v, v + 1, v + across}), face({v + across, v + 1, v + across + 1});
      }
    }
    for (std::uint32_t v = 0; v + 2 < soup; v += 3) face({sheet + v, sheet + v + 1, sheet + v + 2});
    face({0, 1});
    for (const int v : {5, 4, 3, 2, -1, 9, 8, 7}) body.put(std::int32_t(v));
    std::string head = std::string("ply\nformat binary_") + (little ? "little" : "big") +
                       "_endian 1.0\nelement vertex " + std::to_string(sheet + soup) +
                       "\nproperty double x\nproperty float y\nproperty list uchar short ages\n"
                       "property float z\n";
    if (normals != Normals::kNone)
      head += "property float nx\nproperty float ny\nproperty float nz\n";
    head += "element face " + std::to_string(faces) +
            "\nproperty list uchar uint vertex_indices\nelement tristrips 1\n"
            "property list uchar int vertex_indices\nend_header\n";
    // The strip's count precedes its corners.
    Bytes all(head.begin(), head.end());
    all.insert(all.end(), body.bytes.begin(), body.bytes.end() - 32);
    all.push_back(8);
    all.insert(all.end(), body.bytes.end() - 32, body.bytes.end());
    return write(name, all);
  }
};

TEST_F(Pack, GivesTheBytesOfTheSceneInMemory) {
  for (const bool ties : {false, true}) {
    const std::string scene = stl("scene.stl", 7000, ties);
    for (const std::uint32_t most : {1u, 30u, 999u, 6999u}) {
      if (most == 1 && ties) continue;
      for (const std::uint32_t at_once : {10u, 500u, 6000u}) expect_same(scene, most, at_once);
    }
  }
}

TEST_F(Pack, GivesTheBytesOfPlyInMemory) {
  for (const Normals normals : {Normals::kNone, Normals::kSome, Normals::kAll}) {
    for (const bool little : {true, false}) {
      expect_same(ply("scene.ply", 7, normals, little), 1, 1);
      const std::string scene = ply("scene.ply", 60, normals, little);
      for (const std::uint32_t most : {30u, 999u, 65536u})
        expect_same(scene, most, little ? 90 : 3000);
    }
  }
}

/// The file is larger than a window.
TEST_F(Pack, ReadsPlyInWindows) {
  const std::string scene = ply("scene.ply", 190, Normals::kSome, true);
  ASSERT_GT(std::filesystem::file_size(scene), std::size_t{2} << 20);
  expect_same(scene, 9999, 20000);
}

/// Both ways report an invalid file with the same message.
TEST_F(Pack, RefusesWhatLoadSceneRefuses) {
  const std::string good = (ply("a.ply", 30, Normals::kAll, true), read("a.ply"));
  const auto spoiled = [&](std::size_t at, const std::string& by) {
    std::string bytes = good;
    return write("bad.ply", bytes.replace(at, by.size(), by));
  };
  const std::size_t body = good.find("end_header\n") + 11;
  expect_same_words(write("cut.ply", good.substr(0, good.size() - 1)), "tristrips[0]");
  expect_same_words(write("head.ply", good.substr(0, body - 20)), "end_header");
  expect_same_words(spoiled(good.find("double x"), "double w"), "x, y and z");
  expect_same_words(spoiled(good.size() - 4, std::string(4, '\x7f')), "out of range");
  expect_same_words(spoiled(good.size() - 33, "\xff"), "count");
}

TEST_F(Pack, LeavesOthersAlone) {
  EXPECT_TRUE(is_taken(stl("a.stl", 11, false)));
  EXPECT_FALSE(is_taken(stl("b.stl", 10, false))) << "few enough";
  EXPECT_FALSE(is_taken(path("none.stl")));
  EXPECT_FALSE(
      is_taken(write("c.stl", std::string("solid of words\n endsolid\n") + std::string(200, ' '))));
  std::string bytes = read("a.stl");
  EXPECT_FALSE(is_taken(write("short.stl", bytes.substr(0, bytes.size() - 1))));
  const float far = 2e18f;
  std::memcpy(bytes.data() + 84 + 7 * 50 + 12, &far, sizeof far);
  EXPECT_FALSE(is_taken(write("far.stl", bytes)));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + 84 + 7 * 50 + 12, &nan, sizeof nan);
  EXPECT_TRUE(is_taken(write("nan.stl", bytes))) << "without this triangle";
  EXPECT_FALSE(is_taken(write("a.ply", "ply\nformat ascii 1.0\n" + std::string(500, '\n') +
                                           "element vertex 0\nend_header\n")));
  PackOptions options;
  options.triangles_a_block = 0;
  BlockList sink;
  EXPECT_THROW(static_cast<void>(pack_file(path("a.stl"), &sink, options)), Error);
}

}  // namespace
}  // namespace raysheaf::test
