// The documents are correct: their commands run, their options exist, and their links have targets.
#include <gtest/gtest.h>

#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

const fs::path kDocumentRoot = RAYSHEAF_SOURCE_DIR;

std::string help_of_everything() {
  const TemporaryFolder folder;
  std::string text;
  const std::vector<std::vector<std::string>> calls = {{"--help"},
                                                       {"render", "--help"},
                                                       {"report", "--help"},
                                                       {"view", "--help"},
                                                       {"info", "--help"},
                                                       {"scene", "--help"},
                                                       {"pack", "--help"},
                                                       {"verify", "--help"},
                                                       {"bench", "--help"},
                                                       {"bench", "paper", "--help"},
                                                       {"bench", "ablation", "--help"},
                                                       {"bench", "compare", "--help"},
                                                       {"bench", "instances", "--help"},
                                                       {"bench", "plan", "--help"},
                                                       {"bench", "gpu", "--help"},
                                                       {"bench", "scale", "--help"}};
  for (const auto& call : calls) text += raysheaf_app(call, folder).out;
  return text;
}

std::set<std::string> options_of_the_program() {
  std::set<std::string> all;
  for (const std::string& option : found_in({help_of_everything()}, "(--[a-z][a-z-]*)")) {
    all.insert(option);
  }
  return all;
}

// The arguments of a line "raysheaf ..." or "./build/.../raysheaf ..."; empty for other lines.
std::string arguments_of(const std::string& line) {
  std::smatch match;
  static const std::regex kCommand(R"(^(?:\./build/\S*/)?raysheaf( .*)$)");
  return std::regex_match(line, match, kCommand) ? match[1].str() : "";
}

// The same command at a size that renders quickly.
std::string made_small(std::string arguments) {
  static const std::regex kSize(R"( --size \S+)"), kTriangles(R"( --triangles \S+)");
  arguments = std::regex_replace(arguments, kTriangles, " --triangles 20000");
  if (arguments.starts_with(" verify")) return arguments + " --rounds 1";
  for (const std::string command : {" render", " report", " bench paper"}) {
    if (arguments != command && !arguments.starts_with(command + " ")) continue;
    arguments = std::regex_replace(arguments, kSize, "");
    return arguments.insert(command.size(), " --size 48x48");
  }
  return arguments;
}

// Joins lines that end in a backslash with the next one.
std::vector<std::string> joined(const std::vector<std::string>& lines) {
  std::vector<std::string> all;
  bool open = false;
  for (const std::string& line : lines) {
    if (!open) all.emplace_back();
    open = line.ends_with('\\');
    all.back() += open ? line.substr(0, line.size() - 1) : line;
  }
  return all;
}

TEST(Documents, CommandsRun) {
  int commands = 0;
  for (const Document& document : all_documents(kDocumentRoot)) {
    // One per document: later commands read files that earlier ones wrote.
    const TemporaryFolder folder;
    for (const auto& block : document.sh_blocks) {
      for (const std::string& line : joined(block)) {
        const std::string arguments = arguments_of(line);
        if (arguments.empty()) continue;
        const std::string script = "'" RAYSHEAF_APP "'" + made_small(arguments);
        const Finished finished = run_program({"sh", "-c", script}, folder.path());
        EXPECT_EQ(finished.code, 0) << document.path << ": " << line << "\n" << finished.err;
        ++commands;
      }
    }
  }
  EXPECT_GE(commands, 10);
}

// A code span that begins with `--` must be an option of raysheaf. Options of other programs follow
// their program's name. Options of the tests and benchmarks are recognised by their form.
TEST(Documents, OptionsExist) {
  const std::set<std::string> known = options_of_the_program();
  ASSERT_TRUE(known.contains("--method"));
  for (const Document& document : all_documents(kDocumentRoot)) {
    for (const std::string& option : found_in(document.prose, "`(--[a-z][a-z-]*)")) {
      if (option.starts_with("--gtest") || option.starts_with("--benchmark")) continue;
      EXPECT_TRUE(known.contains(option)) << document.path << ": " << option;
    }
  }
}

TEST(Documents, EveryOptionIsDescribed) {
  const std::string page = read_file(kDocumentRoot / "docs/command-line.md") +
                           read_file(kDocumentRoot / "docs/bench.md");
  for (const std::string& option : options_of_the_program()) {
    EXPECT_NE(page.find("`" + option), std::string::npos) << option;
  }
}

TEST(Documents, EveryStatisticIsDescribed) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"render", "builtin:cornell", "--size", "16x16", "--stats", "s.json"}, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::string page = read_file(kDocumentRoot / "docs/statistics.md");
  for (const std::string& field : found_in({read_file(folder.file("s.json"))}, "\"([a-z_]+)\":")) {
    EXPECT_NE(page.find("`" + field + "`"), std::string::npos) << field;
  }
}

TEST(Documents, LinksLeadSomewhere) {
  int links = 0;
  for (const Document& document : all_documents(kDocumentRoot)) {
    for (const std::string& link : found_in(document.prose, R"(\]\(([^)\s]+)\))")) {
      if (link.find("://") != std::string::npos || link.starts_with("mailto:")) continue;
      const std::size_t hash = link.find('#');
      const std::string file = link.substr(0, hash);
      const fs::path target = file.empty() ? document.path : document.path.parent_path() / file;
      // Git keeps no empty folders: such a target is missing in every clone.
      EXPECT_TRUE(fs::exists(target) && !fs::is_empty(target)) << document.path << ": " << link;
      if (hash != std::string::npos && target.extension() == ".md") {
        EXPECT_TRUE(anchors(read_document(target)).contains(link.substr(hash + 1)))
            << document.path << ": " << link;
      }
      ++links;
    }
  }
  EXPECT_GE(links, 5);
}

// All string literals of the sources, with adjacent literals joined.
std::string messages_of_the_sources() {
  static const std::regex kSeam("\"\\s*\n\\s*f?\"");
  std::string all;
  for (const std::string folder : {"include", "src", "render", "paper", "emulated", "scenes", "lab",
                                   "io", "apps", "python", "cmake"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kDocumentRoot / folder)) {
      const fs::path ending = entry.path().extension();
      if (ending == ".h" || ending == ".cpp" || ending == ".cu" || ending == ".py" ||
          ending == ".sh")
        all += std::regex_replace(read_file(entry.path()), kSeam, "");
    }
  }
  return all;
}

TEST(Documents, MessagesAreThoseOfTheSources) {
  const std::string sources = messages_of_the_sources();
  int messages = 0;
  for (const std::string& message : found_in(
           read_document(kDocumentRoot / "docs/troubleshooting.md").prose, R"(^\| `([^`]+)` \|)")) {
    std::string rest = message;
    const std::string dots = "…";
    while (!rest.empty()) {
      const std::size_t end = rest.find(dots);
      std::string part = rest.substr(0, end);
      rest = end == std::string::npos ? "" : rest.substr(end + dots.size());
      while (part.starts_with(' ')) part.erase(0, 1);
      while (part.ends_with(' ')) part.pop_back();
      EXPECT_NE(sources.find(part), std::string::npos)
          << "docs/troubleshooting.md: no source says: " << part;
    }
    ++messages;
  }
  EXPECT_GE(messages, 20);
}

}  // namespace
}  // namespace raysheaf::test
