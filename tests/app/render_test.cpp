// The program as a user runs it: images, statistics, lists.
#include <gtest/gtest.h>
#include <pty.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

const char* const kBuiltinScenes[] = {"office", "cornell", "atrium"};

Finished run_render(const TemporaryFolder& folder, std::vector<std::string> arguments,
                    const std::string& size = "48x48") {
  arguments.insert(arguments.begin(), {"render", "--size", size});
  return raysheaf_app(arguments, folder);
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Width and height of a PNG, from its first chunk.
std::pair<std::uint32_t, std::uint32_t> png_size(const std::string& bytes) {
  if (bytes.size() < 24 || bytes.compare(1, 3, "PNG") != 0) return {0, 0};
  return {big_endian(bytes, 16), big_endian(bytes, 20)};
}

std::set<std::string> keys(const Json& object) {
  std::set<std::string> all;
  for (const auto& [key, value] : object.items()) all.insert(key);
  return all;
}

TEST(Render, StatisticsOnStandardOutputAccompanyTheImage) {
  const TemporaryFolder folder;
  const Finished finished = run_render(folder, {"builtin:cornell", "--stats", "-"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(Json::parse(finished.out).at("width"), 48);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"cornell.png"});
  EXPECT_NE(finished.err.find("wrote the statistics to standard output"), std::string::npos);
}

TEST(Render, WritesAllThatIsAskedFor) {
  const TemporaryFolder folder;
  const Finished finished = run_render(
      folder,
      {"builtin:cornell", "-o", "a.png", "-o", "a.exr", "--heatmap", "h.png", "--stats", "s.json"},
      "60x40");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.out, "");
  EXPECT_EQ(folder.names().size(), 4u);
  EXPECT_EQ(png_size(read_file(folder.file("a.png"))),
            (std::pair<std::uint32_t, std::uint32_t>(60, 40)));
  EXPECT_GT(png_size(read_file(folder.file("h.png"))).second, 40u);
  const std::string exr = read_file(folder.file("a.exr"));
  EXPECT_TRUE(exr.starts_with("\x76\x2f\x31\x01"));
  for (const char* channel :
       {"R", "G", "B", "position.X", "position.Y", "position.Z", "normal.X", "normal.Y", "normal.Z",
        "albedo.R", "albedo.G", "albedo.B", "specular.R", "shadow.V", "tests.V"}) {
    EXPECT_NE(exr.find(std::string(channel) + '\0'), std::string::npos) << channel;
  }
}

TEST(Render, GbufferIsInOpenExrAndExplained) {
  const TemporaryFolder folder;
  const Finished finished = run_render(
      folder, {"builtin:cornell", "-o", "a.exr", "-o", "a.png", "--gbuffer", "--explain"});
  if (finished.err.find("OpenGL") != std::string::npos && finished.code != 0)
    GTEST_SKIP() << finished.err;
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.out.find("four RGBA32F targets, 64 bytes a pixel in place of 4, of "),
            std::string::npos)
      << finished.out;
  const std::string exr = read_file(folder.file("a.exr"));
  for (const char* channel :
       {"gbuffer_position.X", "gbuffer_normal.Z", "gbuffer_diffuse.R", "gbuffer_specular.B"}) {
    EXPECT_NE(exr.find(std::string(channel) + '\0'), std::string::npos) << channel;
  }
  ASSERT_EQ(run_render(folder, {"builtin:cornell", "-o", "b.png"}).code, 0);
  EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")));
  const Finished refused =
      run_render(folder, {"builtin:cornell", "-o", "c.png", "--gbuffer", "--primary", "trace"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(refused.err.starts_with("raysheaf: gbuffer: ")) << refused.err;
}

TEST(Render, SummaryNamesWhatWasDone) {
  const TemporaryFolder folder;
  const Finished finished = run_render(folder, {"builtin:cornell", "-o", "a.png"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  for (const char* word : {"792 triangles, 7 meshes, ", "48x48, 1 sample per pixel: ", " rays in ",
                           " rays/s (dual, ", "wrote a.png"}) {
    EXPECT_NE(finished.err.find(word), std::string::npos) << word << " in " << finished.err;
  }
  EXPECT_EQ(finished.err.find("test"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find('\r'), std::string::npos) << "a progress bar in a pipe";
  EXPECT_EQ(finished.err.find('\x1b'), std::string::npos) << "a progress bar in a pipe";
}

TEST(Render, QuietIsSilent) {
  const TemporaryFolder folder;
  const Finished finished = run_render(folder, {"builtin:cornell", "-o", "a.png", "--quiet"});
  EXPECT_EQ(finished.code, 0);
  EXPECT_EQ(finished.out + finished.err, "");
}

TEST(Render, ProgressBarOnATerminal) {
  const TemporaryFolder folder;
  const std::string output = folder.file("a.png");
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child < 0) GTEST_SKIP() << "there is no terminal";
  if (child == 0) {
    execl(RAYSHEAF_APP, RAYSHEAF_APP, "render", "builtin:office", "-o", output.c_str(), "--size",
          "128x128", static_cast<char*>(nullptr));
    _exit(127);
  }
  std::string shown;
  char buffer[4096];
  for (ssize_t got; (got = read(terminal, buffer, sizeof buffer)) > 0;) {
    shown.append(buffer, static_cast<std::size_t>(got));
  }
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  EXPECT_EQ(status, 0) << shown;
  EXPECT_NE(shown.find("\r\033[K"), std::string::npos) << shown;
  EXPECT_NE(shown.find(" %"), std::string::npos) << shown;
}

TEST(Render, EveryMethodGivesTheSameFile) {
  for (const std::string name : kBuiltinScenes) {
    const TemporaryFolder folder;
    for (const char* method : {"brute", "rah", "crsh", "gl10", "dual"}) {
      const Finished finished = run_render(
          folder, {"builtin:" + name, "--method", method, "-o", std::string(method) + ".png"});
      ASSERT_EQ(finished.code, 0) << finished.err;
    }
    const std::string truth = read_file(folder.file("brute.png"));
    EXPECT_GT(truth.size(), 200u);
    EXPECT_TRUE(read_file(folder.file("rah.png")) == truth) << name;
    EXPECT_TRUE(read_file(folder.file("crsh.png")) == truth) << name;
    EXPECT_TRUE(read_file(folder.file("gl10.png")) == truth) << name;
    EXPECT_TRUE(read_file(folder.file("dual.png")) == truth) << name;
  }
}

TEST(Render, ThreadsDoNotShowInThePicture) {
  const TemporaryFolder folder;
  for (const char* threads : {"1", "2", "5"}) {
    const Finished finished = run_render(
        folder, {"builtin:cornell", "--threads", threads, "-o", std::string(threads) + ".png"});
    ASSERT_EQ(finished.code, 0) << finished.err;
  }
  const std::string one = read_file(folder.file("1.png"));
  EXPECT_TRUE(read_file(folder.file("2.png")) == one);
  EXPECT_TRUE(read_file(folder.file("5.png")) == one);
}

Json statistics_of(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--stats", "s.json"});
  const Finished finished = run_render(folder, arguments);
  EXPECT_EQ(finished.code, 0) << finished.err;
  return Json::parse(read_file(folder.file("s.json")));
}

TEST(Render, StatisticsHaveTheDocumentedFields) {
  const TemporaryFolder folder;
  const Json frame = statistics_of(folder, {"builtin:cornell", "--method", "crsh"});
  EXPECT_EQ(keys(frame), (std::set<std::string>{"scene", "triangles", "meshes", "width", "height",
                                                "method", "key", "bound", "device", "primary",
                                                "threads", "batches", "samples", "times_ms"}));
  EXPECT_EQ(keys(frame.at("times_ms")),
            (std::set<std::string>{"load", "raster", "shade", "total"}));
  EXPECT_EQ(frame.at("triangles"), 792);
  EXPECT_EQ(frame.at("meshes"), 7);
  EXPECT_EQ(frame.at("width"), 48);
  EXPECT_EQ(frame.at("method"), "crsh");
  EXPECT_EQ(frame.at("device"), "cpu");
  ASSERT_FALSE(frame.at("batches").empty());
  for (const Json& batch : frame.at("batches")) {
    EXPECT_EQ(keys(batch),
              (std::set<std::string>{"kind", "bounce", "rays", "triangles", "chunks",
                                     "mesh_sphere_tests", "levels", "bound_tests",
                                     "ray_bound_tests", "final_tests", "total_tests",
                                     "brute_force_tests", "relative", "hits", "times_ms", "plan"}));
    EXPECT_TRUE(batch.at("plan").empty());
    EXPECT_EQ(keys(batch.at("times_ms")),
              (std::set<std::string>{"raygen", "order", "hierarchy", "traverse", "intersect"}));
    for (const Json& level : batch.at("levels")) {
      EXPECT_EQ(keys(level), (std::set<std::string>{"level", "tests", "hits", "misses"}));
    }
  }
}

// The output follows the counting rule of docs/statistics.md.
TEST(Render, CountsFollowTheRule) {
  for (const char* method : {"brute", "rah", "crsh"}) {
    const TemporaryFolder folder;
    const Json frame = statistics_of(folder, {"builtin:cornell", "--method", method});
    for (const Json& batch : frame.at("batches")) {
      const auto rays = batch.at("rays").get<std::uint64_t>();
      std::uint64_t total = batch.at("final_tests").get<std::uint64_t>(), hits_above = 0;
      for (std::size_t i = 0; i < batch.at("levels").size(); ++i) {
        const Json& level = batch.at("levels")[i];
        const auto tests = level.at("tests").get<std::uint64_t>();
        EXPECT_EQ(level.at("level"), batch.at("levels").size() - i);
        EXPECT_EQ(level.at("hits").get<std::uint64_t>() + level.at("misses").get<std::uint64_t>(),
                  tests);
        if (i > 0) {
          EXPECT_EQ(tests, 8 * hits_above);
        }
        hits_above = level.at("hits").get<std::uint64_t>();
        total += tests;
      }
      if (!batch.at("levels").empty()) {
        EXPECT_EQ(batch.at("final_tests"), 8 * hits_above);
      }
      EXPECT_EQ(batch.at("total_tests"), total);
      EXPECT_EQ(batch.at("brute_force_tests"), rays * batch.at("triangles").get<std::uint64_t>());
      if (rays == 0) continue;
      if (method == std::string("brute")) {
        EXPECT_EQ(batch.at("relative"), 1.0);
      }
      if (method == std::string("rah")) {
        ASSERT_EQ(batch.at("levels").size(), 2u);
        const std::uint64_t nodes = ((rays + 7) / 8 + 7) / 8;
        EXPECT_EQ(batch.at("levels")[0].at("tests"), nodes * 792);
      }
    }
  }
}

TEST(Render, DualIsTheDefaultAndSaysWhatItDid) {
  const TemporaryFolder folder;
  const Json frame = statistics_of(folder, {"builtin:office"});
  EXPECT_EQ(frame.at("method"), "dual");
  EXPECT_EQ(frame.at("key"), "plan");
  EXPECT_EQ(frame.at("bound"), "plan");
  for (const Json& batch : frame.at("batches")) {
    if (batch.at("rays") == 0) continue;
    ASSERT_FALSE(batch.at("plan").empty());
    EXPECT_TRUE(batch.at("plan")[0].is_string());
    EXPECT_TRUE(batch.at("levels").empty());
    EXPECT_EQ(batch.at("total_tests").get<std::uint64_t>(),
              batch.at("bound_tests").get<std::uint64_t>() +
                  batch.at("ray_bound_tests").get<std::uint64_t>() +
                  batch.at("final_tests").get<std::uint64_t>());
  }
}

// The explanation goes to standard output, with or without --quiet and -o.
TEST(Render, ExplainsItself) {
  const TemporaryFolder folder;
  const Finished finished =
      run_render(folder, {"builtin:cornell", "--explain", "--quiet", "--stats", "s.json"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const Json frame = Json::parse(read_file(folder.file("s.json")));
  std::size_t at = 0;
  for (const Json& batch : frame.at("batches")) {
    std::vector<std::string> lines{batch.at("kind").get<std::string>() + ", bounce " +
                                   batch.at("bounce").dump() + ": " + batch.at("rays").dump() +
                                   " rays, 792 triangles\n"};
    for (const Json& sentence : batch.at("plan"))
      lines.push_back("  " + sentence.get<std::string>() + "\n");
    lines.push_back("  tests: " + batch.at("bound_tests").dump() + " of bundles with bounds, " +
                    batch.at("ray_bound_tests").dump() + " of rays with bounds, " +
                    batch.at("final_tests").dump() + " of rays with triangles; ");
    lines.push_back("  hits: " + batch.at("hits").dump() + " rays; ms: order ");
    for (const std::string& line : lines) {
      const std::size_t found = finished.out.find(line, at);
      ASSERT_NE(found, std::string::npos) << line << " in " << finished.out;
      at = found + line.size();
    }
  }
  const Finished other =
      run_render(folder, {"builtin:cornell", "--explain", "--quiet", "--method", "rah"});
  ASSERT_EQ(other.code, 0) << other.err;
  EXPECT_NE(other.out.find("  no plan: rah treats every batch in the same way\n"),
            std::string::npos);
  const Finished nothing = run_render(
      folder, {"builtin:cornell", "--explain", "--quiet", "--bounces", "0", "--no-shadows"});
  EXPECT_EQ(nothing.out, "no rays were traced\n");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"s.json"}));
}

TEST(Render, SwitchesRemoveTheirRays) {
  const TemporaryFolder folder;
  const auto kinds = [&](const std::vector<std::string>& arguments) {
    std::set<std::string> all;
    const Json frame = statistics_of(folder, arguments);
    for (const Json& batch : frame.at("batches")) {
      if (batch.at("rays") > 0) all.insert(batch.at("kind").get<std::string>());
    }
    return all;
  };
  EXPECT_EQ(kinds({"builtin:office"}),
            (std::set<std::string>{"shadow", "reflection", "refraction"}));
  EXPECT_EQ(kinds({"builtin:office", "--no-shadows"}),
            (std::set<std::string>{"reflection", "refraction"}));
  EXPECT_EQ(kinds({"builtin:office", "--no-reflections", "--no-refractions"}),
            (std::set<std::string>{"shadow"}));
  EXPECT_EQ(kinds({"builtin:office", "--bounces", "0"}), (std::set<std::string>{"shadow"}));
}

TEST(Render, TracedPrimaryRaysNeedNoGraphics) {
  const TemporaryFolder folder;
  const Json frame = statistics_of(folder, {"builtin:cornell", "--primary", "trace"});
  EXPECT_EQ(frame.at("primary"), "trace");
  const Json& first = frame.at("batches").at(0);
  EXPECT_EQ(first.at("kind"), "primary");
  EXPECT_EQ(first.at("bounce"), 0);
  EXPECT_EQ(first.at("rays"), 48 * 48);
}

TEST(Scene, ListedScenesCanBeWrittenAndReadBack) {
  const TemporaryFolder folder;
  const Finished list = raysheaf_app({"scene", "--list"}, folder);
  ASSERT_EQ(list.code, 0) << list.err;
  for (const std::string name : kBuiltinScenes) {
    EXPECT_NE(list.out.find(name + "\n"), std::string::npos);
    const std::string file = name + ".glb";
    ASSERT_EQ(raysheaf_app({"scene", name, "-o", file}, folder).code, 0);
    const Finished ours = raysheaf_app({"info", "builtin:" + name, "--json"}, folder);
    const Finished read = raysheaf_app({"info", file, "--json"}, folder);
    ASSERT_EQ(ours.code, 0) << ours.err;
    ASSERT_EQ(read.code, 0) << read.err;
    const Json a = Json::parse(ours.out), b = Json::parse(read.out);
    for (const char* field : {"triangles", "instances", "bounds"}) {
      EXPECT_EQ(a.at(field), b.at(field)) << name << " " << field;
    }
    for (const char* field : {"meshes", "materials", "lights", "cameras"}) {
      EXPECT_EQ(a.at(field).size(), b.at(field).size()) << name << " " << field;
    }
    for (std::size_t i = 0; i < a.at("materials").size(); ++i)
      EXPECT_EQ(a["materials"][i].at("thin"), b["materials"][i].at("thin")) << name << i;
    EXPECT_EQ(b.at("files"), Json::array({file}));
  }
}

TEST(Help, EverywhereAndWithExamples) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> calls = {
      {"--help"}, {"render", "--help"}, {"info", "--help"}, {"scene", "--help"}};
  for (const auto& call : calls) {
    const Finished help = raysheaf_app(call, folder);
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_NE(help.out.find("Examples:\n  raysheaf "), std::string::npos) << help.out;
  }
  const Finished version = raysheaf_app({"--version"}, folder);
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(version.out.starts_with("raysheaf ")) << version.out;
}

}  // namespace
}  // namespace raysheaf::test
