// Files cut into blocks without being held: the same file as of the scene in memory.
#include "raysheaf/pack.h"

#include "raysheaf/block_file.h"
#include "support/random.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

class Pack : public IoTest {
 protected:
  /// A binary STL of triangles of a few kinds; corners are on a coarse grid where `ties`.
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
      append(bytes, std::uint16_t{0});
    }
    return write(name, bytes);
  }

  /// The block files that the two ways give of one scene.
  void expect_same(const std::string& scene, std::uint32_t most, std::uint32_t at_once) {
    BlockFileWriter held(path("held.rsb"));
    held.finish(cut_into_blocks(load_scene(scene), &held, most));
    BlockFileWriter outer(path("outer.rsb"));
    PackOptions options;
    options.triangles_a_block = most;
    options.triangles_at_once = at_once;
    options.beside = path("outer.rsb");
    const auto rest = pack_file(scene, &outer, options);
    ASSERT_TRUE(rest.has_value());
    outer.finish(*rest);
    EXPECT_TRUE(read("held.rsb") == read("outer.rsb")) << most << ", " << at_once;
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

TEST_F(Pack, LeavesOthersAlone) {
  const auto is_taken = [&](const std::string& scene) {
    BlockList sink;
    PackOptions options;
    options.triangles_at_once = 10;
    options.beside = path("out.rsb");
    const bool taken = pack_file(scene, &sink, options).has_value();
    EXPECT_EQ(taken, !sink.blocks().empty());
    return taken;
  };
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
  EXPECT_THROW(is_taken(write("nan.stl", bytes)), Error);
  PackOptions options;
  options.triangles_a_block = 0;
  BlockList sink;
  EXPECT_THROW(static_cast<void>(pack_file(path("a.stl"), &sink, options)), Error);
}

}  // namespace
}  // namespace raysheaf::test
