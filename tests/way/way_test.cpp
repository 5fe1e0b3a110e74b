// HACKING.md, "The way of a ray": the files whose code runs for a batch, and the calls down to the
// test of a triangle. The library's rooms are compiled here with `-finstrument-functions` (see
// tests/CMakeLists.txt), which calls the two functions below wherever a function begins and ends.
#include <cxxabi.h>
#include <gtest/gtest.h>
#include <link.h>

#include <algorithm>
#include <map>
#include <regex>
#include <unordered_map>

#include "raysheaf/points.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "tests/support/process.h"
#include "tests/support/random.h"

namespace raysheaf::test {
namespace {

const std::filesystem::path kRoot = RAYSHEAF_SOURCE_DIR;

/// The measures of the longer way to a closest hit: they may shrink.
constexpr std::size_t kMostFiles = 46, kMostCalls = 16;

using Calls = std::vector<void*>;

/// The functions that have run, in the order of their first calls, and each one's longest chain of
/// callers, itself included.
struct Recorder {
  bool on = false;
  Calls stack, order;
  std::unordered_map<void*, Calls> chains;
};
Recorder recorder;

/// A function of the library. A lambda belongs to the function that contains it.
struct Function {
  std::string file, name;
  bool is_lambda = false;
};

/// `Class::function` or `function`, without namespaces, arguments and the return type.
Function named(const std::string& symbol, const std::string& file) {
  int status = 0;
  char* const whole = abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status);
  const std::string from = std::regex_replace(whole != nullptr ? whole : symbol,
                                              std::regex(R"(operator[^\w\s]+\()"), "operator(");
  std::free(whole);
  std::string name;
  int depth = 0;
  for (const char c : from) {
    depth -= c == '>' || c == ')' ? 1 : 0;
    if (depth == 0 && c != '>' && c != ')' && c != '<' && c != '(') name += c;
    depth += c == '<' || c == '(' ? 1 : 0;
  }
  static const std::regex kParts(R"((?:(\w+)::)?(~?\w+)(?: const)?(?:\[.*)?$)");
  std::smatch parts;
  if (!std::regex_search(name, parts, kParts)) return {file, name, true};
  const std::string in = parts[1], last = parts[2];
  const bool in_class = !in.empty() && std::isupper(static_cast<unsigned char>(in[0])) != 0 &&
                        in.find('_') == in.npos;
  return {file, in_class ? in + "::" + last : last, name.find("{lambda") != name.npos};
}

/// The difference between an address and its place in the program's file.
std::uintptr_t load_address() {
  std::uintptr_t first = 0;
  const auto take = [](dl_phdr_info* info, std::size_t /*size*/, void* to) {
    *static_cast<std::uintptr_t*>(to) = info->dlpi_addr;
    return 1;  // the program itself comes first
  };
  dl_iterate_phdr(take, &first);
  return first;
}

/// Whether the line declares a class: debug information has it for functions made by the compiler.
bool declares_class(const std::filesystem::path& file, int line) {
  std::ifstream stream(file);
  std::string text;
  while (line-- > 0) std::getline(stream, text);
  static const std::regex kClass(R"(^\s*(struct|class)\b.*)");
  return std::regex_match(text, kClass);
}

/// The functions written in include/ and src/, by their addresses, from debug information.
std::map<void*, Function> names_of(const Calls& functions) {
  std::vector<std::string> arguments{"addr2line", "-f", "-e",
                                     std::filesystem::read_symlink("/proc/self/exe").string()};
  for (void* const function : functions) {
    std::ostringstream place;
    place << std::hex << reinterpret_cast<std::uintptr_t>(function) - load_address();
    arguments.push_back(place.str());
  }
  std::istringstream lines(run_program(arguments, kRoot).out);
  std::map<void*, Function> names;
  std::string symbol, place;
  for (void* const function : functions) {
    if (!std::getline(lines, symbol) || !std::getline(lines, place)) break;
    const auto path = std::filesystem::path(place.substr(0, place.rfind(':'))).lexically_normal();
    const std::string file = path.lexically_relative(kRoot).string();
    if ((file.starts_with("include/") || file.starts_with("src/")) &&
        !declares_class(path, std::atoi(place.c_str() + place.rfind(':') + 1)))
      names[function] = named(symbol, file);
  }
  return names;
}

struct Way {
  std::vector<std::string> files;  ///< in the order of their first functions
  std::map<std::string, std::vector<std::string>> functions;  ///< by file
  std::vector<std::string> calls;                             ///< down to `end`
};

/// The files and functions that `query` runs, and the longest chain of calls to the function `end`.
template <class Query>
Way way_of(const Query& query, const std::string& end) {
  recorder = {};
  recorder.on = true;
  query();
  recorder.on = false;
  const std::map<void*, Function> names = names_of(recorder.order);
  Way way;
  for (void* const function : recorder.order) {
    const auto at = names.find(function);
    if (at == names.end()) continue;
    const Function& f = at->second;
    if (!way.functions.contains(f.file)) way.files.push_back(f.file);
    if (!f.is_lambda) way.functions[f.file].push_back(f.name);
    if (f.is_lambda || f.name != end) continue;
    std::vector<std::string> calls;
    for (void* const call : recorder.chains[function]) {
      const auto caller = names.find(call);
      if (caller != names.end() && !caller->second.is_lambda) calls.push_back(caller->second.name);
    }
    if (calls.size() > way.calls.size()) way.calls = calls;
  }
  return way;
}

}  // namespace
}  // namespace raysheaf::test

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the compiler calls them by these names.
void __cyg_profile_func_enter(void* function, void* /*caller*/) {
  auto& r = raysheaf::test::recorder;
  if (!r.on) return;
  r.stack.push_back(function);
  auto& chain = r.chains[function];
  if (chain.empty()) r.order.push_back(function);
  if (chain.size() < r.stack.size()) chain = r.stack;
}
void __cyg_profile_func_exit(void* /*function*/, void* /*caller*/) {
  auto& r = raysheaf::test::recorder;
  if (r.on && !r.stack.empty()) r.stack.pop_back();
}
// NOLINTEND(bugprone-reserved-identifier)
}

namespace raysheaf::test {
namespace {

/// An uneven wall of 2 x 64 x 64 triangles.
Scene wall() {
  constexpr int kSide = 64;
  Random random(3);
  std::vector<Vec3> heights((kSide + 1) * (kSide + 1));
  const auto at = [&](int x, int y) -> Vec3& { return heights[y * (kSide + 1) + x]; };
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      at(x, y) = {static_cast<float>(x - kSide / 2), static_cast<float>(y - kSide / 2),
                  random.below(2) == 0 ? 0.0f : random.unit()};
  std::vector<Vec3> corners;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (const Vec3 corner :
           {at(x, y), at(x + 1, y), at(x, y + 1), at(x, y + 1), at(x + 1, y), at(x + 1, y + 1)})
        corners.push_back(corner);
  Scene scene(Context({.threads = 1}));
  scene.add_soup(corners);
  scene.commit();
  return scene;
}

std::vector<Ray> rays_of_one_origin() {
  std::vector<Ray> rays;
  for (int y = -64; y < 64; ++y)
    for (int x = -64; x < 64; ++x)
      rays.push_back({{0.3f, 0.1f, -32}, 0, {static_cast<float>(x), static_cast<float>(y), 64}});
  return rays;
}

std::vector<Ray> random_rays() {
  Random random(5);
  std::vector<Ray> rays(4000);
  for (Ray& ray : rays) ray = {random.in_box(32), 0, random.direction()};
  return rays;
}

std::vector<Vec3> random_points() {
  Random random(7);
  std::vector<Vec3> points(2000);
  for (Vec3& point : points) point = random.in_box(32);
  return points;
}

/// The three ways, on a scene whose tree has been built.
std::vector<Way> all_ways() {
  const Scene scene = wall();
  const std::vector<Ray> camera = rays_of_one_origin(), random = random_rays();
  const std::vector<Vec3> points = random_points();
  std::vector<Hit> hits(camera.size()), hits_of_random(random.size());
  std::vector<ClosestPoint> nearest(points.size());
  closest_hit(scene, camera, hits);
  return {way_of([&] { closest_hit(scene, camera, hits); }, "test_from_origin"),
          way_of([&] { closest_hit(scene, random, hits_of_random); }, "finish_lanes"),
          way_of([&] { closest_point(scene, std::span<const Vec3>(points), nearest); },
                 "squared_to_triangles")};
}
const std::vector<std::string> kNames = {"One origin", "Random", "Points"};

/// The files of all ways, each after those that come before it on some way.
std::vector<std::string> files_of(const std::vector<Way>& ways) {
  std::vector<std::string> files;
  for (const Way& way : ways) {
    std::size_t next = 0;
    for (const std::string& file : way.files) {
      auto at = std::find(files.begin(), files.end(), file);
      if (at == files.end()) at = files.insert(files.begin() + std::ptrdiff_t(next), file);
      next = std::size_t(at - files.begin()) + 1;
    }
  }
  return files;
}

/// The text below a heading, up to the next.
std::string part_of(const std::string& page, const std::string& heading) {
  const std::size_t begin = page.find(heading + "\n\n");
  if (begin == page.npos) return {};
  const std::size_t first = begin + heading.size() + 2;
  return page.substr(first, page.find("\n\n#", first) - first);
}

/// The part as it should be: the last column is its own, everything else is from the ways.
std::string part_for(const std::vector<Way>& ways, const std::string& part) {
  std::ostringstream out;
  out << "| File | Function |";
  for (const std::string& name : kNames) out << " " << name << " |";
  out << " What happens |\n|---|---|:-:|:-:|:-:|---|\n";
  for (const std::string& file : files_of(ways)) {
    const std::string link = "| [`" + file + "`](" + file + ") | `";
    std::smatch row;
    const std::regex pattern(std::regex_replace(link, std::regex(R"([.\[\]()|])"), "\\$&") +
                             R"(([^`]+)` \|[^|]*\|[^|]*\|[^|]*\| ([^|]+) \|)");
    const bool is_old = std::regex_search(part, row, pattern);
    std::string function, first, marks;
    for (const Way& way : ways) {
      const auto at = way.functions.find(file);
      marks += at != way.functions.end() ? " • |" : " |";
      if (at == way.functions.end() || at->second.empty()) continue;
      if (first.empty()) first = at->second.front();
      if (is_old && std::count(at->second.begin(), at->second.end(), row[1]) != 0)
        function = row[1];
    }
    out << link << (function.empty() ? first : function) << "` |" << marks << " "
        << (is_old ? row[2].str() : "(to be written)") << " |\n";
  }
  for (std::size_t i = 0; i < ways.size(); ++i) {
    out << "\n"
        << kNames[i] << ", " << ways[i].files.size() << " files and " << ways[i].calls.size()
        << " calls:";
    for (std::size_t k = 0; k < ways[i].calls.size(); ++k)
      out << (k == 0 ? " `" : " → `") << ways[i].calls[k] << "`";
    out << "\n";
  }
  std::string text = out.str();
  text.pop_back();
  return text;
}

TEST(Way, StandsInHacking) {
  const std::vector<Way> ways = all_ways();
  const std::string page = read_file(kRoot / "HACKING.md");
  const std::string part = part_of(page, "### `dual`, on the CPU");
  const std::string expected = part_for(ways, part);
  if (std::getenv("RAYSHEAF_UPDATE_WAY") != nullptr && !part.empty())
    write_file(kRoot / "HACKING.md",
               std::string(page).replace(page.find(part), part.size(), expected));
  EXPECT_EQ(part, expected) << "RAYSHEAF_UPDATE_WAY=1 build/dev/tests/test_way writes HACKING.md";
  EXPECT_EQ(part.find("(to be written)"), part.npos);
  for (const Way& way : {ways[0], ways[1]}) {
    EXPECT_LE(way.files.size(), kMostFiles);
    EXPECT_LE(way.calls.size(), kMostCalls);
    EXPECT_GT(way.calls.size(), 5u);
  }
}

}  // namespace
}  // namespace raysheaf::test
