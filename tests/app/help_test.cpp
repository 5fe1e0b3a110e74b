// Help: groups, the terminal's width, and suggestions for mistyped words.
#include <gtest/gtest.h>
#include <pty.h>

#include <sstream>

#include "apps/support/closest.h"
#include "apps/support/table.h"
#include "tests/support/process.h"
#include "text/command_text.h"

namespace raysheaf::test {
namespace {

using Words = std::vector<std::string>;

/// Runs `raysheaf WORDS` with COLUMNS=`columns`, or without COLUMNS if that is empty.
Finished raysheaf_in_columns(const std::string& columns, const Words& words) {
  const TemporaryFolder folder;
  Words arguments = {"env", "-u", "COLUMNS"};
  if (!columns.empty()) arguments.push_back("COLUMNS=" + columns);
  arguments.emplace_back(RAYSHEAF_APP);
  arguments.insert(arguments.end(), words.begin(), words.end());
  return run_program(arguments, folder.path());
}

std::vector<std::string> help_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  for (const std::string& line : help_lines(text)) longest = std::max(longest, line.size());
  return longest;
}

const std::vector<Words> kCommands = {{},
                                      {"render"},
                                      {"report"},
                                      {"view"},
                                      {"info"},
                                      {"scene"},
                                      {"pack"},
                                      {"verify"},
                                      {"bench"},
                                      {"bench", "paper"},
                                      {"bench", "ablation"},
                                      {"bench", "compare"},
                                      {"bench", "instances"},
                                      {"bench", "plan"},
                                      {"bench", "gpu"},
                                      {"bench", "scale"},
                                      {"completion"},
                                      {"manual"},
                                      {"help"}};

TEST(Help, NoLineIsLongerThanTheTerminal) {
  for (Words command : kCommands) {
    command.emplace_back("--help");
    for (const std::string columns : {"", "40", "60", "132"}) {
      const Finished help = raysheaf_in_columns(columns, command);
      EXPECT_EQ(help.code, 0) << help.err;
      const std::size_t room = columns.empty() ? 80 : std::stoul(columns);
      EXPECT_LE(longest_line(help.out), room) << help.out;
      EXPECT_GT(help.out.size(), 100u);
    }
  }
}

TEST(Help, TakesTheWidthOfTheTerminal) {
  winsize size{};
  size.ws_col = 57;
  size.ws_row = 24;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child < 0) GTEST_SKIP() << "no terminal is available";
  if (child == 0) {
    unsetenv("COLUMNS");
    execl(RAYSHEAF_APP, RAYSHEAF_APP, "render", "--help", static_cast<char*>(nullptr));
    _exit(127);
  }
  std::string shown;
  char buffer[4096];
  for (ssize_t got; (got = read(terminal, buffer, sizeof buffer)) > 0;)
    shown.append(buffer, static_cast<std::size_t>(got));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  EXPECT_EQ(status, 0) << shown;
  std::erase(shown, '\r');
  EXPECT_LE(longest_line(shown), 57u) << shown;
  EXPECT_GT(longest_line(shown), 50u) << shown;
}

TEST(Help, DailyOptionsOfRenderAreOnTheFirstScreen) {
  const std::vector<std::string> lines = help_lines(raysheaf_in_columns("", {"render", "-h"}).out);
  ASSERT_GT(lines.size(), 24u);
  std::string screen;
  for (std::size_t i = 0; i < 24; ++i) screen += lines[i] + "\n";
  for (const char* option : {"-o, --output", "--size", "--view", "--up", "--samples"})
    EXPECT_NE(screen.find(std::string("\n  ") + option + " "), std::string::npos) << screen;
}

TEST(Help, OptionsOfRenderAreInGroups) {
  const std::string help = raysheaf_in_columns("", {"render", "--help"}).out;
  std::size_t at = 0;
  for (const char* group : {"Common", "Output", "Camera", "Light", "Method", "Animation",
                            "Streaming", "Processes", "Other", "Examples"}) {
    const std::size_t next = help.find("\n" + std::string(group) + ":\n");
    ASSERT_NE(next, std::string::npos) << group;
    EXPECT_GT(next, at) << group;
    at = next;
  }
}

TEST(Help, ComesInFourWays) {
  const TemporaryFolder folder;
  const Finished alone = raysheaf_app({}, folder);
  EXPECT_EQ(alone.code, 0);
  EXPECT_EQ(alone.err, "");
  EXPECT_EQ(alone.out, raysheaf_app({"--help"}, folder).out);
  EXPECT_EQ(alone.out, raysheaf_app({"help"}, folder).out);
  for (const Words& command : kCommands) {
    Words before = {"help"}, behind = command;
    before.insert(before.end(), command.begin(), command.end());
    behind.emplace_back("-h");
    EXPECT_EQ(raysheaf_app(before, folder).out, raysheaf_app(behind, folder).out);
  }
  const Finished wrong = raysheaf_app({"help", "bench", "compre"}, folder);
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.err,
            "raysheaf: 'compre' is not a command of bench; did you mean 'compare'? (see raysheaf "
            "bench --help)\n");
  EXPECT_EQ(raysheaf_app({"help", "render", "this"}, folder).code, 2);
}

TEST(Help, VersionHasAShortOption) {
  const TemporaryFolder folder;
  const Finished brief = raysheaf_app({"-V"}, folder);
  EXPECT_EQ(brief.code, 0);
  EXPECT_TRUE(brief.out.starts_with("raysheaf ")) << brief.out;
  EXPECT_EQ(brief.out, raysheaf_app({"--version"}, folder).out);
}

TEST(Suggestions, ForCommandsOptionsAndValues) {
  const TemporaryFolder folder;
  const auto expect = [&](const Words& arguments, const std::string& word) {
    const Finished finished = raysheaf_app(arguments, folder);
    EXPECT_EQ(finished.code, 2) << finished.err;
    EXPECT_NE(finished.err.find("did you mean '" + word + "'?"), std::string::npos) << finished.err;
    EXPECT_EQ(help_lines(finished.err).size(), 1u) << finished.err;
  };
  const std::string scene = "builtin:cornell";
  expect({"rendr"}, "render");
  expect({"bench", "papre"}, "paper");
  expect({"render", scene, "--smaples", "4"}, "--samples");
  expect({"render", scene, "--smaples=4"}, "--samples");
  expect({"bench", "compare", "--grwoth"}, "--growth");
  expect({"render", scene, "--method", "daul"}, "dual");
  expect({"render", scene, "--view", "tpo"}, "top");
  expect({"render", scene, "--share", "geometri"}, "geometry");
  expect({"render", scene, "--key", "two-point-mortn"}, "two-point-morton");
  expect({"bench", "ablation", scene, "--keys", "raster,published,corected"}, "corrected");
  expect({"verify", "--only", "watertigt"}, "watertight");
  expect({"render", "builtin:cornel"}, "cornell");
  expect({"completion", "bsh"}, "bash");
}

TEST(Suggestions, OnlyForWordsThatAreNear) {
  using app::closest;
  EXPECT_EQ(closest("render", {"report", "render"}), "render");
  EXPECT_EQ(closest("redner", {"report", "render"}), "render");
  EXPECT_EQ(closest("--out", {"--stats", "--output"}), "--output");
  EXPECT_EQ(closest("paint", {"report", "render", "view"}), "");
  EXPECT_EQ(closest("x", {"xyz"}), "");
  EXPECT_EQ(closest("", {"render"}), "");
  EXPECT_EQ(closest("render", {}), "");
  EXPECT_EQ(closest(std::string(100'000, 'r'), {"render"}), "");
}

TEST(Help, WordsThatAreLongerThanTheLineAreCut) {
  app::CommandText command;
  command.name = "raysheaf odd";
  command.text = std::string(95, 'x');
  command.options.push_back({{"--odd"}, "X", std::string(130, 'y') + " end", false, true});
  command.footer = "Examples:\n  raysheaf odd " + std::string(90, 'z');
  const std::string help = app::help_text(command, 80);
  EXPECT_LE(longest_line(help), 80u) << help;
  EXPECT_NE(help.find("end (required)"), std::string::npos) << help;
}

TEST(Counts, PluralsAreRight) {
  EXPECT_EQ(app::count_text(0, "mesh", "meshes"), "0 meshes");
  EXPECT_EQ(app::count_text(1, "mesh", "meshes"), "1 mesh");
  EXPECT_EQ(app::count_text(2, "mesh", "meshes"), "2 meshes");
  EXPECT_EQ(app::count_text(12345, "mesh", "meshes"), "12 345 meshes");
}

}  // namespace
}  // namespace raysheaf::test
