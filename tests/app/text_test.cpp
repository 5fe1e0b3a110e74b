// `raysheaf completion` and `raysheaf manual` cover every command and option, and shells and roff
// accept them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/process.h"
#include "tests/support/scenes.h"
#include "text/command_text.h"

namespace raysheaf::test {
namespace {

using Words = std::vector<std::string>;

std::string help_of(Words command, const TemporaryFolder& folder) {
  command.emplace_back("--help");
  return raysheaf_app(command, folder).out;
}

/// Adds the commands that the help of `command` lists, recursively.
void add_commands_below(const Words& command, const TemporaryFolder& folder,
                        std::vector<Words>* commands) {
  std::istringstream lines(help_of(command, folder));
  bool listed = false;
  for (std::string line; std::getline(lines, line);) {
    if (listed && !line.starts_with("  ")) break;
    if (listed && line[2] != ' ') {  // not the rest of a long line
      Words below = command;
      below.push_back(line.substr(2, line.find(' ', 2) - 2));
      commands->push_back(below);
      add_commands_below(below, folder, commands);
    }
    listed |= line == "Commands:";
  }
}

/// Every command; the program itself comes first.
std::vector<Words> all_commands(const TemporaryFolder& folder) {
  std::vector<Words> commands = {{}};
  add_commands_below({}, folder, &commands);
  EXPECT_GT(commands.size(), 9u);
  return commands;
}

/// The long options that a command's help lists.
std::set<std::string> options_of(const Words& command, const TemporaryFolder& folder) {
  const std::string help = help_of(command, folder);
  std::set<std::string> options;
  const std::regex option("[ ,](--[a-z-]+)");
  const std::string list = help.substr(0, help.find("Examples:"));
  for (std::sregex_iterator it(list.begin(), list.end(), option), end; it != end; ++it)
    options.insert((*it)[1]);
  return options;
}

std::string completion(const std::string& shell, const TemporaryFolder& folder) {
  const Finished finished = raysheaf_app({"completion", shell}, folder);
  EXPECT_EQ(finished.code, 0) << finished.err;
  return finished.out;
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

/// Bash's completions for a command line whose last word is unfinished.
std::string bash_offers(const Words& words, const TemporaryFolder& folder) {
  const std::string script = folder.file("raysheaf.bash"), out = folder.file("offers");
  write_file(script, completion("bash", folder));
  std::string line = "source '" + script + "'; COMP_WORDS=(raysheaf";
  for (const std::string& word : words) line += " '" + word + "'";
  line += "); COMP_CWORD=" + std::to_string(words.size()) + "; _raysheaf; echo \"${COMPREPLY[*]}\"";
  write_file(folder.file("ask.bash"), line + "\n");
  EXPECT_EQ(std::system(("bash '" + folder.file("ask.bash") + "' > '" + out + "'").c_str()), 0);
  std::string offers = read_file(out);
  while (offers.ends_with('\n')) offers.pop_back();
  return offers;
}

TEST(Completion, NamesEveryOption) {
  const TemporaryFolder folder;
  const std::string bash = completion("bash", folder), zsh = completion("zsh", folder),
                    fish = completion("fish", folder);
  for (const Words& command : all_commands(folder)) {
    const std::set<std::string> options = options_of(command, folder);
    EXPECT_TRUE(options.count("--help") == 1);
    for (const std::string& option : options) {
      EXPECT_NE(bash.find(option), std::string::npos) << option;
      EXPECT_NE(zsh.find("*" + option + "["), std::string::npos) << option;
      EXPECT_NE(fish.find("-l " + option.substr(2)), std::string::npos) << option;
    }
  }
}

TEST(Completion, BashOffersWhatFits) {
  if (!has_program("bash")) GTEST_SKIP() << "there is no bash";
  const TemporaryFolder folder;
  EXPECT_EQ(bash_offers({"re"}, folder), "render report");
  EXPECT_EQ(bash_offers({"render", "--me"}, folder), "--method --mesh-culling --memory");
  EXPECT_EQ(bash_offers({"render", "--method", ""}, folder), "brute rah crsh gl10 dual");
  EXPECT_EQ(bash_offers({"render", "--size", ""}, folder), "");
  EXPECT_EQ(bash_offers({"render", "--key", "two"}, folder), "two-point-morton two-point-hilbert");
  EXPECT_EQ(bash_offers({"report", "--bound", ""}, folder),
            "sphere-cone finite-cone shaft frustum shaft-cone");
  EXPECT_EQ(bash_offers({"verify", "--only", ""}, folder),
            "brute-force determinism watertight bounds exact instances history");
  EXPECT_EQ(bash_offers({"bench", "compare", "--mode", "re"}, folder), "rebuild refit");
  EXPECT_EQ(bash_offers({"bench", "comp"}, folder), "compare");
  EXPECT_EQ(bash_offers({"bench", "compare", "--gro"}, folder), "--growth --ground");
  EXPECT_EQ(bash_offers({"completion", ""}, folder), "bash zsh fish");
}

TEST(Completion, OtherShellsTakeTheirs) {
  const TemporaryFolder folder;
  for (const char* shell : {"zsh", "fish"}) {
    const std::string script = folder.file(shell);
    write_file(script, completion(shell, folder));
    if (!has_program(shell)) continue;
    EXPECT_EQ(std::system((std::string(shell) + " -n '" + script + "'").c_str()), 0) << shell;
  }
  const Finished other = raysheaf_app({"completion", "tcsh"}, folder);
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("'tcsh' is neither bash nor zsh nor fish"), std::string::npos);
}

TEST(Manual, APageForEachCommandWithItsOptions) {
  const TemporaryFolder folder;
  ASSERT_EQ(raysheaf_app({"manual", "-o", "."}, folder).code, 0);
  for (const Words& command : all_commands(folder)) {
    std::string name = "raysheaf";
    for (const std::string& word : command) name += "-" + word;
    const std::string path = folder.file(name + ".1");
    ASSERT_TRUE(std::filesystem::exists(path)) << path;
    const std::string page = read_file(path);
    for (std::string option : options_of(command, folder)) {
      for (std::size_t at = 0; (at = option.find('-', at)) != std::string::npos; at += 2)
        option.insert(at, "\\");
      EXPECT_NE(page.find("\\fB" + option + "\\fR"), std::string::npos) << name << " " << option;
    }
    for (const char* section : {".SH NAME", ".SH SYNOPSIS", ".SH OPTIONS", ".SH EXIT STATUS"})
      EXPECT_NE(page.find(section), std::string::npos) << name;
    if (!has_program("groff")) continue;
    EXPECT_EQ(std::system(("test -z \"$(groff -man -ww -z '" + path + "' 2>&1)\"").c_str()), 0);
  }
  EXPECT_EQ(raysheaf_app({"manual", "-o", "no/such"}, folder).code, 1);
  EXPECT_EQ(raysheaf_app({"manual"}, folder).code, 2);
}

TEST(Manual, TextThatRoffWouldTakeForItsOwn) {
  app::CommandText command;
  command.name = "raysheaf odd";
  command.text = ".dots and back\\slashes";
  command.options.push_back({{"--odd"}, "X", "'quoted' first", false, false});
  const std::string page = app::manual_page(command, "1.2.3");
  EXPECT_NE(page.find("\\&.dots and back\\eslashes"), std::string::npos) << page;
  EXPECT_NE(page.find("\n\\&'quoted' first.\n"), std::string::npos) << page;
}

TEST(Completion, ChoicesAreWordsInLowerCase) {
  const auto choices = [](const std::string& value) {
    return app::OptionText{{"-x"}, value, "", false, false}.choices();
  };
  EXPECT_EQ(choices("cpu|cuda"), (std::vector<std::string>{"cpu", "cuda"}));
  EXPECT_EQ(choices("32|64"), (std::vector<std::string>{"32", "64"}));
  EXPECT_TRUE(choices("NAME|INDEX").empty());
  EXPECT_TRUE(choices("R,G,B|X").empty());
  EXPECT_TRUE(choices("FILE").empty());
  EXPECT_TRUE(choices("").empty());
}

}  // namespace
}  // namespace raysheaf::test
