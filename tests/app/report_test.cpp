// `raysheaf report`: the page is complete and self-contained, and has the numbers of `--stats`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "apps/raysheaf/report/bundles.h"
#include "apps/raysheaf/report/commands.h"
#include "apps/raysheaf/report/page.h"
#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

Finished report(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"report", "--size", "24x20"});
  return raysheaf_app(arguments, folder);
}

Json data_in(const std::string& page) {
  const std::string start = "<script type=\"application/json\" id=\"raysheaf-data\">";
  const std::size_t begin = page.find(start) + start.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

/// The path of the first of these programs that is installed, or an empty string.
std::string found_program(const std::vector<std::string>& names) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const std::string& name : names)
      if (access((folder + "/" + name).c_str(), X_OK) == 0) return folder + "/" + name;
  return "";
}

TEST(Report, IsOnePageThatNeedsNothingElse) {
  const TemporaryFolder folder;
  const Finished finished = report(folder, {"builtin:cornell", "-o", "page.html"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.out, "");
  EXPECT_NE(finished.err.find("wrote page.html"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find('\r'), std::string::npos) << "a progress bar in a pipe";
  EXPECT_EQ(folder.names(), std::vector<std::string>{"page.html"});
  const std::string page = read_file(folder.file("page.html"));
  for (const char* const mark : {"{{", "}}", "http:", "https:", "@import", "url(", "src=\"/"})
    EXPECT_EQ(page.find(mark), std::string::npos) << mark;
  static const std::regex kTarget(R"((?:src|href)="([^"]{0,30}))");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), kTarget);
       it != std::sregex_iterator(); ++it) {
    const std::string target = (*it)[1];
    EXPECT_TRUE(target.starts_with("#") || target.starts_with("data:")) << target;
  }
  for (const char* const layer :
       {"beauty", "tests-brute", "tests-rah", "tests-crsh", "tests-gl10", "tests-dual", "shadow",
        "normal", "position", "diffuse", "specular", "instances", "triangles"})
    EXPECT_NE(page.find("id=\"layer-" + std::string(layer) + "\""), std::string::npos) << layer;
}

// Only the counts, because times differ from run to run.
Json counts_of(Json batch) {
  batch.erase("times_ms");
  return batch;
}

TEST(Report, ItsNumbersAreThoseOfTheStatistics) {
  const TemporaryFolder folder;
  const std::vector<std::string> options = {"builtin:cornell", "--bounces", "1", "--quiet",
                                            "--no-shadows"};
  const std::vector<std::string> of_hierarchies = {"--levels", "3", "--branching", "4"};
  std::vector<std::string> arguments = options;
  arguments.insert(arguments.end(), {"-o", "page.html"});
  arguments.insert(arguments.end(), of_hierarchies.begin(), of_hierarchies.end());
  const Finished finished = report(folder, arguments);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const Json data = data_in(read_file(folder.file("page.html")));
  EXPECT_EQ(data["scene"]["triangles"], 792);
  ASSERT_EQ(data["methods"].size(), 5u);
  for (const Json& method : data["methods"]) {
    arguments = {"render", "--size", "24x20", "--stats", "s.json", "--method", method["method"]};
    arguments.insert(arguments.end(), options.begin(), options.end());
    if (method["method"] == "rah" || method["method"] == "crsh")
      arguments.insert(arguments.end(), of_hierarchies.begin(), of_hierarchies.end());
    ASSERT_EQ(raysheaf_app(arguments, folder).code, 0);
    const Json expected = Json::parse(read_file(folder.file("s.json")));
    ASSERT_FALSE(expected["batches"].empty());
    for (const char* const run : {"counted", "timed"}) {
      EXPECT_EQ(method[run]["method"], expected["method"]);
      ASSERT_EQ(method[run]["batches"].size(), expected["batches"].size());
      for (std::size_t i = 0; i < expected["batches"].size(); ++i)
        EXPECT_EQ(counts_of(method[run]["batches"][i]), counts_of(expected["batches"][i]));
    }
  }
}

TEST(Report, RunsTheMethodsThatAreAskedFor) {
  const TemporaryFolder folder;
  const Finished finished =
      report(folder, {"builtin:cornell", "-o", "page.html", "--method", "dual", "--method", "rah"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Json data = data_in(read_file(folder.file("page.html")));
  ASSERT_EQ(data["methods"].size(), 2u);
  EXPECT_EQ(data["methods"][0]["method"], "rah");
  EXPECT_EQ(data["methods"][1]["method"], "dual");
  EXPECT_EQ(data["command"],
            "raysheaf report --size 24x20 builtin:cornell -o page.html --method dual --method rah");
  ASSERT_EQ(data["bundles"].size(), 2u) << "two levels of rah";
  for (const Json& level : data["bundles"])
    EXPECT_GE(level["looseness"]["low"], 1) << "no bound is tighter than the rays";
}

TEST(Report, NamesFromFilesAreTextAndNothingElse) {
  const TemporaryFolder folder;
  const std::string name = "<b onclick='x'>&\"{{scene}}.obj";
  write_file(folder.file(name), "o </script><i>\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Finished finished =
      report(folder, {name, "-o", "page.html", "--method", "dual", "--quiet"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::string page = read_file(folder.file("page.html"));
  EXPECT_EQ(page.find("<b onclick"), std::string::npos);
  EXPECT_EQ(page.find("</script><i>"), std::string::npos);
  EXPECT_NE(page.find("&lt;b onclick"), std::string::npos);
  const Json data = data_in(page);
  EXPECT_EQ(data["scene"]["triangles"], 1);
  EXPECT_NE(std::string(data["command"]).find(app::quoted(name)), std::string::npos);
}

TEST(Report, IsUtf8WhateverTheSceneIsCalled) {
  const TemporaryFolder folder;
  const std::string name = "Zo\xc3\xab\xff.glb";
  ASSERT_EQ(raysheaf_app({"scene", "cornell", "-o", name}, folder).code, 0);
  ASSERT_EQ(raysheaf_app({"report", name, "-o", "a.html", "--size", "16x16", "-q"}, folder).code,
            0);
  const std::string html = read_file(folder.file("a.html"));
  EXPECT_NO_THROW(static_cast<void>(Json(html).dump()));
  EXPECT_NE(html.find("Zo\xc3\xab\xef\xbf\xbd.glb"), std::string::npos);
}

TEST(Report, WhatGoesWrongIsOneSentenceAndNoFile) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& arguments, int code,
                           const std::string& words) {
    const Finished finished = report(folder, arguments);
    EXPECT_EQ(finished.code, code) << finished.err;
    EXPECT_NE(finished.err.find(words), std::string::npos) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  };
  refused({"builtin:cornell", "-o", "page.png"}, 2, "'page.png' does not end in .html");
  refused({"builtin:cornell"}, 2, "--output");
  refused({"missing.glb", "-o", "page.html"}, 1, "missing.glb");
  refused({"builtin:cornell", "-o", "no/such/page.html"}, 1, "no/such/page.html");
  refused({"builtin:cornell", "-o", "page.html", "--camera", "none"}, 1, "camera");
  refused({"builtin:cornell", "-o", "page.html", "--method", "best"}, 2, "--method");
  EXPECT_TRUE(folder.names().empty());
  const Finished stopped = raysheaf_app({"report", "builtin:atrium", "-o", "page.html"}, folder,
                                        std::chrono::milliseconds(300));
  EXPECT_EQ(stopped.code, 130) << stopped.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(Report, PassesAnHtmlValidator) {
  const std::string tidy = found_program({"tidy"});
  if (tidy.empty()) GTEST_SKIP() << "no tidy";
  const TemporaryFolder folder;
  for (const char* const method : {"dual", "crsh"}) {
    ASSERT_EQ(report(folder, {"builtin:cornell", "-o", "page.html", "--method", method}).code, 0);
    const Finished checked = run_program(
        {tidy, "-quiet", "-errors", "--drop-empty-elements", "no", "page.html"}, folder.path());
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_EQ(checked.err, "");
  }
}

/// A copy of the page whose user opened #view=normal,tests-rah,30, then swapped the layers and
/// moved the slider to 70.
std::string page_in_use(const TemporaryFolder& folder) {
  EXPECT_EQ(report(folder, {"builtin:cornell", "-o", "page.html"}).code, 0);
  std::string page = read_file(folder.file("page.html"));
  page.replace(page.find("</body>"), 7, R"(<script>
const by = (id) => document.getElementById(id);
console.info("came: " + by("left").value + " " + by("right").value + " " + by("place").value);
by("swap").click();
by("place").value = 70;
by("place").dispatchEvent(new Event("input"));
document.documentElement.dataset.used = by("over").alt + " | " + by("under").alt + " | " +
    by("stage").style.getPropertyValue("--place") + " | " + by("wipe").hidden;
console.info("used: " + document.documentElement.dataset.used);
</script></body>)");
  write_file(folder.file("page.html"), page);
  return "file://" + folder.file("page.html") + "#view=normal,tests-rah,30";
}

const char* const kUsed =
    "cornell: Tests per pixel, rah, in false colours | cornell: Shading normals | 70% | false";

// Errors of the page appear on the console, which must hold only the test's own output.
TEST(Report, WorksInChromium) {
  const std::string browser =
      found_program({"chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"});
  if (browser.empty()) GTEST_SKIP() << "no Chromium";
  const TemporaryFolder folder;
  const std::string address = page_in_use(folder);
  const Finished shown =
      run_program({browser, "--headless", "--no-sandbox", "--disable-gpu",
                   "--enable-logging=stderr", "--user-data-dir=" + folder.file("profile"),
                   "--virtual-time-budget=3000", "--dump-dom", address},
                  folder.path());
  ASSERT_EQ(shown.code, 0) << shown.err;
  EXPECT_NE(shown.out.find("data-used=\"" + std::string(kUsed)), std::string::npos);
  for (const std::string& line : found_in({shown.err}, "(CONSOLE.*)"))
    EXPECT_TRUE(line.find("\"came: ") != std::string::npos ||
                line.find("\"used: ") != std::string::npos)
        << line;
  EXPECT_NE(shown.err.find("came: normal tests-rah 30"), std::string::npos) << shown.err;
}

TEST(Report, WorksInFirefox) {
  const std::string browser = found_program({"firefox-esr", "firefox"});
  if (browser.empty()) GTEST_SKIP() << "no Firefox";
  const TemporaryFolder folder;
  const std::string address = page_in_use(folder), profile = folder.file("profile");
  std::filesystem::create_directory(profile);
  write_file(profile + "/user.js",
             "user_pref('browser.dom.window.dump.enabled', true);\n"
             "user_pref('devtools.console.stdout.content', true);\n"
             "user_pref('javascript.options.showInConsole', true);\n");
  const Finished shown = run_program(
      {"env", "HOME=" + folder.path().string(), "timeout", "120", browser, "--headless",
       "--no-remote", "--profile", profile, "--screenshot", folder.file("page.png"), address},
      folder.path());
  const std::string said = shown.out + shown.err;
  ASSERT_EQ(shown.code, 0) << said;
  EXPECT_NE(said.find(kUsed), std::string::npos) << said;
  EXPECT_EQ(said.find("JavaScript error: file:"), std::string::npos) << said;
  EXPECT_EQ(said.find("JavaScript warning: file:"), std::string::npos) << said;
}

TEST(ReportParts, Base64IsThatOfTheStandard) {
  const auto of = [](const std::string& text) { return app::base64({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(of("\xff\xfe\xfb"), "//77");
}

TEST(ReportParts, CommandsSurviveAShell) {
  for (const std::string word :
       {"a.glb", "it's a \"scene\" $HOME `x` \\ *.glb", "", "-o", "a\tb"}) {
    const TemporaryFolder folder;
    const Finished finished =
        run_program({"sh", "-c", "printf %s " + app::quoted(word)}, folder.path());
    EXPECT_EQ(finished.out, word);
  }
}

TEST(ReportParts, CommandsOfOneMethodKeepAllOptionsButOutputsAndMethods) {
  app::ReportCommand command;
  const auto of = [&](std::vector<std::string> words) {
    command.words = std::move(words);
    return app::stats_command_line(command, Method::kRah);
  };
  const std::string end = " --method rah -o rah.png --stats rah.json";
  EXPECT_EQ(of({"-o", "a.html", "my scene.glb", "--size", "9x9", "-q"}),
            "raysheaf render 'my scene.glb' --size 9x9" + end);
  EXPECT_EQ(of({"s.glb", "-oa.html", "--method=dual", "--method", "brute", "--no-shadows"}),
            "raysheaf render s.glb --no-shadows" + end);
  EXPECT_EQ(of({"s.glb", "-qo", "a.html", "--quiet"}), "raysheaf render s.glb" + end);
  EXPECT_EQ(of({"--output=a.html", "s.glb"}), "raysheaf render s.glb" + end);
}

// Runs the commands that the page shows.
TEST(Report, ItsCommandsRun) {
  const TemporaryFolder folder;
  ASSERT_EQ(report(folder, {"builtin:cornell", "-o", "page.html", "-q", "--method", "dual"}).code,
            0);
  const std::vector<std::string> commands =
      found_in({read_file(folder.file("page.html"))}, "<pre><code>raysheaf ([^<]*)</code>");
  ASSERT_EQ(commands.size(), 2u);
  for (const std::string& command : commands)
    EXPECT_EQ(run_program({"sh", "-c", "'" RAYSHEAF_APP "' " + command}, folder.path()).code, 0)
        << command;
  EXPECT_EQ(folder.names().size(), 3u);
}

TEST(ReportParts, DistributionsWeighRays) {
  app::Report report;
  report.methods.resize(1);
  BatchStatistics large, small;
  large.rays = 900;
  small.rays = 100;
  const auto bundle = [](std::uint64_t accepted, float degrees) {
    BundleSample sample;
    sample.rays = 10;
    sample.accepted = accepted;
    sample.needed = 2;
    sample.direction_spread = degrees;
    return sample;
  };
  large.bundles = {bundle(4, 1), bundle(8, 1)};
  small.bundles = {bundle(200, 40)};
  report.methods[0].counted.batches = {large, small};
  const std::vector<app::BundleLevel> levels = app::bundle_levels(report);
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_EQ(levels[0].samples, 3u);
  EXPECT_EQ(levels[0].mean_rays, 10);
  EXPECT_NEAR(levels[0].looseness, (0.45 * 4 + 0.45 * 8 + 0.1 * 200) / 2, 1e-9);
  EXPECT_EQ(levels[0].loose.median, 4);
  EXPECT_EQ(levels[0].loose.low, 2);
  EXPECT_EQ(levels[0].direction_degrees.high, 1);
  double sum = 0;
  for (const double share : levels[0].loose.shares) sum += share;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_NEAR(levels[0].loose.shares[static_cast<std::size_t>(1 - levels[0].loose.first)], 0.45,
              1e-12);
}

}  // namespace
}  // namespace raysheaf::test
