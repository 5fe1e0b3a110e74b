// Packing files without holding them in memory gives the same block file as packing the loaded
// scene.
#pragma once

#include "raysheaf/block_file.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {

class PackTest : public IoTest {
 protected:
  /// Compares the block files that both ways make of a scene.
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

  /// Expects that both ways report the same error, which contains `part`.
  void expect_same_words(const std::string& scene, const std::string& part) {
    const auto words = [](const auto& read) {
      try {
        read();
      } catch (const Error& error) {
        return std::string(error.what());
      }
      return std::string();
    };
    const std::string held = words([&] { static_cast<void>(load_scene(scene)); });
    EXPECT_NE(held.find(part), held.npos) << held;
    BlockList sink;
    const PackOptions options{.triangles_at_once = 10, .beside = path("out.rsb")};
    EXPECT_EQ(words([&] { static_cast<void>(pack_file(scene, &sink, options)); }), held);
    EXPECT_TRUE(sink.blocks().empty());
  }

  /// Whether the scene is packed without being held, rather than left to `load_scene`.
  bool is_taken(const std::string& scene) {
    BlockList sink;
    PackOptions options;
    options.triangles_at_once = 10;
    options.beside = path("out.rsb");
    const bool taken = pack_file(scene, &sink, options).has_value();
    EXPECT_EQ(taken, !sink.blocks().empty());
    return taken;
  }
};

}  // namespace raysheaf::test
