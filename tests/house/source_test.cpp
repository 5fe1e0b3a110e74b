// The house rules that a program can check: the dependencies between rooms, the tables of
// HACKING.md (the one that is measured is in tests/way), and a single place for the version.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "raysheaf/version.h"
#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RAYSHEAF_SOURCE_DIR;

std::vector<fs::path> sources_under(const std::string& folder) {
  std::vector<fs::path> all;
  if (!fs::is_directory(kRoot / folder)) return all;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const fs::path ending = entry.path().extension();
    if (ending == ".h" || ending == ".cpp" || ending == ".cu") all.push_back(entry.path());
  }
  return all;
}

std::vector<std::string> included_by(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return found_in(lines, R"(^#include \"([^\"]+)\")");
}

// The rooms, each after those that it may include. No two stand at one place, so there is no
// circle.
const std::vector<std::string> kRooms = {
    "src/system",
    "src/base",
    "src/geom",
    "src/exec",
    "src/ranks",
    "src/intersect",
    "src/scene",
    "src/animation",
    "src/rays",
    "src/object_tree",
    "src/methods/dual",
    "src/levels",
    "src/nearest",
    "src/queries",
    "src/device",
    "src/out_of_core",
    "src/backends",
    "src/api/scene",
    "src/api",
    "render/surface",
    "render/rays",
    "render/raster",
    "render/shade",
    "render/device",
    "render/picture",
    "render/frame",
    "render/geometry",
    "render/backends",
    "render",
    "paper/base",
    "paper/bounds",
    "paper/order",
    "paper/ray_hierarchy",
    "paper/packets",
    "paper",
    "emulated",
    "scenes",
    "lab",
    "lab/verify",
    "apps/support",
    "lab/commands",
    "apps/raysheaf",
};

/// The room of a file, or of a header as it is included: the longest that its path begins with.
std::string room_of(const std::string& path) {
  std::string best;
  for (const std::string& room : kRooms)
    for (const std::string& seen : {room, room.starts_with("src/") ? room.substr(4) : room})
      if (path.starts_with(seen + "/") && room.size() > best.size()) best = room;
  return best;
}

TEST(Source, ArrowsPointOneWay) {
  const auto rank = [](const std::string& room) {
    return std::find(kRooms.begin(), kRooms.end(), room) - kRooms.begin();
  };
  for (const std::string folder :
       {"src", "render", "paper", "emulated", "scenes", "lab", "apps/support", "apps/raysheaf"}) {
    for (const fs::path& file : sources_under(folder)) {
      const std::string room = room_of(fs::relative(file, kRoot).string());
      ASSERT_FALSE(room.empty()) << file << " is in no room of this test's list";
      for (const std::string& header : included_by(file)) {
        const std::string other = room_of(header);
        if (other.empty()) continue;
        EXPECT_LE(rank(other), rank(room)) << file << " includes " << header;
      }
    }
  }
}

TEST(Source, RoomsAreSeenAtOneGlance) {
  std::map<std::string, int> sizes;
  for (const std::string folder : {"src", "render"})
    for (const fs::path& file : sources_under(folder))
      ++sizes[fs::relative(file, kRoot).parent_path().string()];
  for (const auto& [room, files] : sizes) EXPECT_LE(files, 30) << room;
}

/// The table below a heading of HACKING.md, "The way of a ray": file and function of each row.
std::vector<std::pair<std::string, std::string>> steps_of_the_way(const std::string& heading) {
  const std::string page = read_file(kRoot / "HACKING.md");
  const std::size_t begin = page.find("### " + heading);
  if (begin == page.npos) return {};
  std::istringstream part(page.substr(begin, page.find("\n#", begin + 1) - begin));
  static const std::regex kRow(R"(^\| \[`[^`]+`\]\(([^)]+)\) \| `([^`]+)` \|.*)");
  std::vector<std::pair<std::string, std::string>> steps;
  for (std::string line; std::getline(part, line);) {
    std::smatch row;
    if (std::regex_match(line, row, kRow)) steps.emplace_back(row[1], row[2]);
  }
  return steps;
}

/// Each step's function is in its file, and an earlier file of the way names it.
void expect_leads_on(const std::vector<std::pair<std::string, std::string>>& steps) {
  std::string before;
  for (const auto& [file, function] : steps) {
    const std::regex name("\\b" + function + "\\b");
    const std::string text = read_file(kRoot / file);
    EXPECT_TRUE(std::regex_search(text, name)) << file << " has no " << function;
    EXPECT_TRUE(before.empty() || std::regex_search(before, name))
        << "no earlier step calls " << function;
    before += text;
  }
}

TEST(Source, StepsOfTheWayLeadOn) {
  for (const std::string heading : {"`crsh`, on the CPU", "`dual`, on a device"}) {
    const auto steps = steps_of_the_way(heading);
    EXPECT_GE(steps.size(), 5u) << heading;
    expect_leads_on(steps);
  }
}

TEST(Source, OutsideIncludesOnlyPublicHeaders) {
  for (const std::string folder : {"io", "apps", "lab/commands", "python"}) {
    for (const fs::path& file : sources_under(folder)) {
      for (const std::string& header : included_by(file)) {
        const bool is_inside = fs::exists(kRoot / "src" / header) && !header.starts_with("system/");
        EXPECT_FALSE(is_inside ||
                     (header.starts_with("lab/") && !header.starts_with("lab/commands/")) ||
                     header.starts_with("paper/") || header.starts_with("scenes/") ||
                     (header.starts_with("render/") && fs::exists(kRoot / header)) ||
                     header.starts_with("emulated/"))
            << file << " includes " << header;
      }
    }
  }
  for (const fs::path& file : sources_under("include")) {
    for (const std::string& header : included_by(file)) {
      EXPECT_TRUE(header.starts_with("raysheaf/")) << file << " includes " << header;
    }
  }
}

TEST(Source, NothingBelowTheAppsPrintsOrExits) {
  static const std::regex kForbidden(
      R"((^|[^\w:.])(std::)?(printf|puts|exit|abort|_exit|quick_exit|terminate)\(|std::(cout|cerr|clog)\b)");
  for (const std::string folder :
       {"include", "src", "render", "paper", "emulated", "scenes", "lab", "io", "python"}) {
    for (const fs::path& file : sources_under(folder)) {
      std::ifstream stream(file);
      int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        const std::string code = line.substr(0, line.find("//"));
        EXPECT_FALSE(std::regex_search(code, kForbidden)) << file << ":" << number << ": " << line;
      }
    }
  }
}

/// Each constant of a library's sources has a name of its own; `least`: how many there are.
void expect_names_of_their_own(const std::string& library, std::size_t least) {
  static const std::regex kNamed(R"((?:^constexpr [\w:]+ |, )(k[A-Z]\w*)(?:\[\w*\])? = )");
  std::map<std::string, fs::path> owners;
  for (const fs::path& file : sources_under(library)) {
    const std::string name = file.filename().string();
    if (file.extension() != ".cpp" || name.ends_with("_simd.cpp")) continue;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
      if (!line.starts_with("constexpr ")) continue;
      for (std::sregex_iterator it(line.begin(), line.end(), kNamed), end; it != end; ++it) {
        const auto [owner, is_new] = owners.emplace((*it)[1], file);
        EXPECT_TRUE(is_new) << file << " and " << owner->second << " have " << (*it)[1];
      }
    }
  }
  EXPECT_GE(owners.size(), least);
}

// Sources of a library are compiled in groups (cmake/Unity.cmake), each in another group in
// another build: a name that two sources share compiles here and fails there.
TEST(Source, ConstantsOfALibraryHaveNamesOfTheirOwn) {
  expect_names_of_their_own("src", 40);
  expect_names_of_their_own("render", 10);
}

TEST(Source, PackagesHaveTheProjectsVersion) {
  const std::string version = RAYSHEAF_VERSION;
  const std::pair<const char*, std::string> places[] = {
      {"packaging/vcpkg/raysheaf/vcpkg.json", "\"version\": \"" + version + "\""},
      {"packaging/conda/recipe.yaml", "\n  version: " + version + "\n"},
      {"CITATION.cff", "\nversion: " + version + "\n"},
      {"CHANGELOG.md", "\n## " + version}};
  for (const auto& [file, sentence] : places)
    EXPECT_NE(read_file(kRoot / file).find(sentence), std::string::npos)
        << file << " lacks " << sentence;
}

TEST(Source, HeadersAreIncludedOnce) {
  for (const std::string folder : {"include", "src", "render", "paper", "emulated", "scenes", "lab",
                                   "io", "apps", "python", "tests"}) {
    for (const fs::path& file : sources_under(folder)) {
      const std::string name = file.filename().string();
      if (file.extension() != ".h" || name.ends_with("-inl.h")) continue;
      EXPECT_NE(read_file(file).find("#pragma once\n"), std::string::npos) << file;
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
