// Scene files that change while they are read: they are replaced, truncated, extended, overwritten
// or deleted between any two reads. The result is the complete old scene, the complete new scene,
// or one sentence.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <atomic>
#include <functional>
#include <set>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "support/process.h"

namespace {

/// While `on_read` is set, it is called before each read, and reads are short.
std::function<void()> on_read;
constexpr std::size_t kShort = 64;

}  // namespace

/// Replaces the C library's function in this program.
extern "C" ssize_t pread(int file, void* to, std::size_t bytes, off_t offset) {
  if (on_read) {
    on_read();
    bytes = std::min(bytes, kShort);
  }
  return syscall(SYS_pread64, file, to, bytes, offset);
}

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

/// Numbers that depend on every byte that matters.
using Content = std::vector<double>;

Content content_of(const SceneDescription& scene) {
  Content all;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3& p : mesh.positions) all.insert(all.end(), {p.x, p.y, p.z});
    for (const auto& t : mesh.triangles) all.insert(all.end(), t.begin(), t.end());
  }
  for (const Material& m : scene.materials)
    all.insert(all.end(), {m.base_color.x, m.base_color.y, m.base_color.z});
  for (const Image& image : scene.images)
    all.insert(all.end(), image.rgba.begin(), image.rgba.end());
  return all;
}

/// Names and contents of a scene's files. The first one is loaded.
using Files = std::vector<std::pair<std::string, std::string>>;

std::string bytes_of(std::initializer_list<float> numbers) {
  std::string bytes;
  for (const float x : numbers) bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
  return bytes;
}

std::string png(std::uint8_t grey) {
  const TemporaryFolder folder;
  Image image{"grey", 8, 8, {}};
  for (int i = 0; i < 64; ++i)
    for (int c = 0; c < 4; ++c)
      image.rgba.push_back(c == 3 ? 255 : static_cast<std::uint8_t>(grey + i));
  write_png(image, folder.file("a.png"));
  return read_file(folder.file("a.png"));
}

/// `z` distinguishes one version of a scene from another; `more` makes it longer.
Files glb(float z, bool more) {
  const TemporaryFolder folder;
  SceneDescription scene;
  Mesh mesh;
  mesh.positions = {{0, 0, z}, {1, 0, z}, {0, 1, z}};
  mesh.triangles = {{0, 1, 2}};
  if (more) mesh.triangles.push_back({1, 2, 0});
  scene.meshes.push_back(mesh);
  scene.instances.push_back({});
  save_glb(scene, folder.file("a.glb"));
  return {{"a.glb", read_file(folder.file("a.glb"))}};
}

Files gltf(float z, bool more) {
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],)"
      R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,1,)" +
      std::to_string(z / 4) +
      R"(,1],"baseColorTexture":{"index":0}}}],)"
      R"("textures":[{"source":0}],"images":[{"uri":"a.png"}],)"
      R"("buffers":[{"byteLength":36,"uri":"a.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
      R"("min":[0,0,)" +
      std::to_string(z) + R"(],"max":[1,1,)" + std::to_string(z) + "]}]}" +
      std::string(more ? 300 : 0, ' ');
  return {{"a.gltf", json},
          {"a.bin", bytes_of({0, 0, z, 1, 0, z, 0, 1, z}) + std::string(more ? 200 : 0, '\0')},
          {"a.png", png(more ? 100 : 3)}};
}

Files obj(float z, bool more) {
  std::string text = "mtllib a.mtl\n";
  for (int i = 0; i < (more ? 12 : 6); ++i)
    text += "v " + std::to_string(i) + " " + std::to_string(i * i) + " " + std::to_string(z) + "\n";
  text += more ? "usemtl a\nf 1 2 3\nf 4 5 6\nf 7 8 9\n" : "usemtl a\nf 1 2 3\nf 4 5 6\n";
  const std::string mtl = "newmtl a\nKd " + std::to_string(z / 4) + " 0.5 0.5\nmap_Kd a.png\n";
  return {{"a.obj", text}, {"a.mtl", mtl}, {"a.png", png(more ? 100 : 3)}};
}

Files ply(float z, bool more) {
  const int count = more ? 12 : 6;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                     "\nproperty float x\nproperty float y\nproperty float z\n"
                     "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < count; ++i)
    text += std::to_string(i) + " " + std::to_string(i * i) + " " + std::to_string(z) + "\n";
  return {{"a.ply", text + "3 0 1 2\n"}};
}

Files stl(float z, bool more) {
  const std::uint32_t count = more ? 9 : 4;
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    bytes += bytes_of({0, 0, 1, x, 0, z, x + 1, 0, z, x, 1, z}) + std::string(2, '\0');
  }
  return {{"a.stl", bytes}};
}

struct Format {
  const char* name;
  std::function<Files(float z, bool more)> make;
};

std::ostream& operator<<(std::ostream& out, const Format& format) {
  return out << format.name;
}

/// Overwrites the same file in place.
void overwrite(const fs::path& file, const std::string& bytes, int flags) {
  const int descriptor = open(file.c_str(), O_WRONLY | flags);
  ASSERT_GE(descriptor, 0);
  EXPECT_EQ(write(descriptor, bytes.data(), bytes.size()), std::ssize(bytes));
  close(descriptor);
}

enum class Change { kRename, kCut, kGrow, kOverwrite, kRemove, kFolder };
constexpr std::array kChanges{Change::kRename,    Change::kCut,    Change::kGrow,
                              Change::kOverwrite, Change::kRemove, Change::kFolder};

void apply(Change change, const fs::path& file, const std::string& bytes) {
  const fs::path beside = file.string() + ".new";
  switch (change) {
    case Change::kRename:
      write_file(beside, bytes);
      return fs::rename(beside, file);
    case Change::kCut:
      return fs::resize_file(file, fs::file_size(file) / 2);
    case Change::kGrow:
      return overwrite(file, "0.25 0.25 0.25\n", O_APPEND);
    case Change::kOverwrite:
      return overwrite(file, bytes, O_TRUNC);
    case Change::kRemove:
      fs::remove(file);
      return;
    case Change::kFolder:
      fs::remove(file);
      fs::create_directory(file);
  }
}

/// Writes files with old modification times, so that any change gets a different time.
void put(const fs::path& folder, const Files& files) {
  for (const auto& [name, bytes] : files) {
    fs::remove_all(folder / name);
    write_file(folder / name, bytes);
    fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
}

class Replaced : public ::testing::TestWithParam<Format> {
 protected:
  void TearDown() override { on_read = nullptr; }

  /// The scene's content, or nothing if an error, or a warning about ignored materials or images,
  /// says what is wrong.
  [[nodiscard]] std::optional<Content> load() const {
    try {
      const SceneDescription scene = load_scene(folder_.file(old_[0].first));
      EXPECT_GT(scene.triangle_count(), 0u);
      if (scene.warnings.empty()) return content_of(scene);
      return std::nullopt;
    } catch (const Error& error) {
      EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
      EXPECT_FALSE(error.sentence().empty());
      EXPECT_EQ(error.sentence().find('\n'), std::string::npos) << error.what();
      return std::nullopt;
    }
  }

  TemporaryFolder folder_;
  Files old_ = GetParam().make(1, false), new_ = GetParam().make(2, true);
};

TEST_P(Replaced, BetweenAnyTwoReads) {
  for (std::size_t which = 0; which < old_.size(); ++which) {
    put(folder_.path(), old_);
    const auto before = load();
    ASSERT_TRUE(before);
    for (const Change change : kChanges) {
      put(folder_.path(), old_);
      apply(change, folder_.path() / old_[which].first, new_[which].second);
      const auto after = load();
      int points = 0;
      for (bool reached = true; reached; ++points) {
        put(folder_.path(), old_);
        int reads = 0;
        on_read = [&] {
          if (reads++ != points) return;
          const auto hook = std::exchange(on_read, nullptr);
          apply(change, folder_.path() / old_[which].first, new_[which].second);
          on_read = hook;
        };
        const auto got = load();
        on_read = nullptr;
        reached = reads > points;
        if (got) {
          EXPECT_TRUE(got == before || got == after)
              << old_[which].first << ", change " << static_cast<int>(change) << " before read "
              << points;
        }
        if (HasFailure()) return;
      }
      EXPECT_GT(points, 4);
    }
  }
}

/// A careful program replaces a file by renaming: the load must neither fail nor mix both versions.
TEST_P(Replaced, RenamedAllTheTime) {
  put(folder_.path(), old_);
  std::set<Content> right{load().value()};
  Files changed = old_;
  changed[0] = new_[0];
  put(folder_.path(), changed);
  right.insert(load().value());
  ASSERT_EQ(right.size(), 2u);
  std::atomic<bool> done = false;
  std::atomic<int> renamed = 0;
  std::thread other([&] {
    for (int i = 0; !done; ++i, ++renamed)
      apply(Change::kRename, folder_.path() / old_[0].first, (i % 2 == 0 ? old_ : new_)[0].second);
  });
  for (int round = 0; round < 300 || renamed < 200; ++round) {
    const auto got = load();
    EXPECT_TRUE(got && right.contains(*got)) << (got ? "mixed" : "refused");
  }
  done = true;
  other.join();
}

INSTANTIATE_TEST_SUITE_P(Formats, Replaced,
                         ::testing::Values(Format{"glb", glb}, Format{"gltf", gltf},
                                           Format{"obj", obj}, Format{"ply", ply},
                                           Format{"stl", stl}),
                         [](const auto& format) { return std::string(format.param.name); });

}  // namespace
}  // namespace raysheaf::test
