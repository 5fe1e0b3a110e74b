// The peers of `raysheaf bench compare`: finding them, agreement of results, and batches of rays.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <set>

#include "lab/commands/compare/case.h"
#include "lab/commands/compare/compare.h"
#include "lab/commands/compare/frames.h"
#include "lab/commands/compare/peer.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "tests/app/peers.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using app::CompareFrames;
using app::CompareKind;
using app::CompareMode;

/// Sets or unsets an environment variable during its lifetime.
class Variable {
 public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value)
      setenv(name_, value->c_str(), 1);
    else
      unsetenv(name_);
  }

  const char* name_;
  std::optional<std::string> before_;
};

constexpr const char* kFiles = "RAYSHEAF_EMBREE";

Finished comparison(const TemporaryFolder& folder) {
  return raysheaf_app({"bench", "compare", "--scene", "builtin:cornell", "--size", "8x8", "--runs",
                       "1", "--mode", "static", "--kind", "shadow"},
                      folder);
}

TEST(ComparePeers, OneSentenceSaysThatThereIsNone) {
  const Variable none(kFiles, "");
  EXPECT_FALSE(has_peer());
  const TemporaryFolder folder;
  const Finished finished = comparison(folder);
  EXPECT_EQ(finished.code, 1);
  EXPECT_EQ(finished.err,
            "raysheaf: bench compare: no Embree is installed for the comparison: install Embree 4 "
            "or 3 or "
            "the Python wheel embreex, or name the library's file in RAYSHEAF_EMBREE\n");
}

TEST(ComparePeers, OneSentenceRefusesAFileThatIsNotEmbree) {
  const TemporaryFolder folder;
  write_file(folder.file("text.so"), "not a library");
  const auto refusal = [&](const std::string& file) {
    const Variable wrong(kFiles, file);
    const Finished finished = comparison(folder);
    EXPECT_EQ(finished.code, 1);
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    return finished.err;
  };
  EXPECT_TRUE(refusal("/nowhere/libembree4.so.4")
                  .starts_with("raysheaf: RAYSHEAF_EMBREE: '/nowhere/libembree4.so.4' cannot be "
                               "loaded: cannot open"));
  EXPECT_TRUE(refusal(folder.file("text.so")).find("text.so' cannot be loaded: ") !=
              std::string::npos);
  EXPECT_EQ(refusal("libc.so.6"),
            "raysheaf: RAYSHEAF_EMBREE: 'libc.so.6' is not Embree 3 or 4: it lacks some of their "
            "functions\n");
}

TEST(ComparePeers, TheVariableNamesAllPeers) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const std::string first = app::find_embree().front().file;
  const Variable twice(kFiles, ":" + first + ":" + first);
  const std::vector<app::EmbreeLibrary> found = app::find_embree();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].file, first);
}

/// The file that a library was loaded from.
std::string path_of(const app::EmbreeLibrary& library) {
  Dl_info info{};
  dladdr(reinterpret_cast<void*>(library.api.new_device), &info);
  return info.dli_fname;
}

TEST(ComparePeers, AWheelOfTheVirtualEnvironmentIsFound) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const std::filesystem::path libraries =
      folder.path() / "lib" / "python3.11" / "site-packages" / "embreex.libs";
  std::filesystem::create_directories(libraries);
  write_file(libraries / "libembree4-0.so.4", "not a library");
  const std::filesystem::path link = libraries / "libembree4-1.so.4";
  std::filesystem::create_symlink(path_of(app::find_embree().front()), link);
  const Variable no_files(kFiles, std::nullopt), environment("VIRTUAL_ENV", folder.path());
  const std::string file = app::find_embree().front().file;
  EXPECT_TRUE(file == link || file == "libembree4.so.4") << file;
}

TEST(ComparePeers, AllAnswersAgreeInEveryWay) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  CompareFrames frames(builtin_scene("cornell"), true);
  frames.make_rays({CompareKind::kMirror, CompareKind::kShadow}, 13, 11, 1);
  const std::vector<Ray>& mirror = frames.rays(1, CompareKind::kMirror);
  const std::vector<Ray>& shadow = frames.rays(1, CompareKind::kShadow);
  std::vector<Hit> expected;
  std::vector<std::uint8_t> expected_flags;
  const auto expect_alike = [&](app::PeerDevice& device, const app::PeerBuild& build) {
    app::PeerScene scene(device, build);
    scene.set_meshes(frames.meshes(0, true));
    scene.move_meshes(frames.meshes(1, true));
    const std::string way = device.version() + " " + build.name + ", ";
    for (const app::PeerCall& call : device.calls(false)) {
      std::vector<Hit> hits(mirror.size());
      scene.closest_hit(mirror, hits, call);
      if (expected.empty()) expected = hits;
      EXPECT_EQ(app::compare_hits(mirror, expected, hits, 1e-4f).mismatches, 0u)
          << way << call.name;
    }
    for (const app::PeerCall& call : device.calls(true)) {
      std::vector<std::uint8_t> flags(shadow.size());
      scene.any_hit(shadow, flags, call);
      if (expected_flags.empty()) expected_flags = flags;
      EXPECT_EQ(flags, expected_flags) << way << call.name;
    }
    EXPECT_GT(device.memory_bytes(), 0u);
  };
  for (const std::unique_ptr<app::PeerDevice>& device : app::open_peers(2))
    for (const CompareMode mode : app::all_compare_modes())
      for (const app::PeerBuild& build : app::peer_builds(mode)) expect_alike(*device, build);
}

TEST(CompareSizes, EachHasItsRows) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app(
      {"bench", "compare", "--scene", "builtin:cornell", "--size", "8x8", "--size", "16x24",
       "--runs", "1", "--mode", "refit", "--kind", "random", "--csv", "s.csv"},
      folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::vector<CsvRow> cases = csv_rows(read_file(folder.file("s.csv")));
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[0].at("size"), "8x8");
  EXPECT_EQ(cases[0].at("rays"), "64");
  EXPECT_EQ(cases[1].at("scene"), "cornell");
  EXPECT_EQ(cases[1].at("size"), "16x24");
  EXPECT_EQ(cases[1].at("rays"), "384");
  EXPECT_NE(finished.out.find("cornell 16x24"), std::string::npos) << finished.out;
}

TEST(ComparePlans, AreShortenedToWhatTheyChose) {
  EXPECT_EQ(app::short_plan({}), "");
  EXPECT_EQ(app::short_plan({"a sentence of another kind"}), "");
  Scene scene;
  const Vec3 corners[] = {{-1, -1, 4}, {1, -1, 4}, {0, 1, 4}};
  scene.add(corners, std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
  scene.commit();
  std::vector<Ray> rays(1000);
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays[i].direction = {0.001f * static_cast<float>(i % 50), 0.001f * static_cast<float>(i / 50),
                         1};
  QueryStatistics statistics;
  QueryOptions options;
  options.statistics = &statistics;
  (void)closest_hit(scene, rays, options);
  EXPECT_EQ(app::short_plan(statistics.plan), "tree built, streams, tiles");
  (void)closest_hit(scene, rays, options);
  EXPECT_EQ(app::short_plan(statistics.plan), "tree kept, streams, tiles");
  std::size_t finely = 0;
  for (int i = 0; i < 100; ++i) {
    (void)closest_hit(scene, rays, options);
    finely += app::short_plan(statistics.plan) == "tree built finely, streams, tiles" ? 1 : 0;
  }
  EXPECT_EQ(finely, 1u) << "after some slices";
  EXPECT_EQ(
      app::short_plan({"object tree: built finely, because so many", "rays: sixteen in a row",
                       "bundles: long streams, because only 3 %", "order: tiles of four by four"}),
      "tree built finely, long streams, tiles");
  EXPECT_EQ(app::short_plan({"object tree: refitted, because", "bundles: streams, because"}),
            "tree refitted, streams");
}

}  // namespace
}  // namespace raysheaf::test
