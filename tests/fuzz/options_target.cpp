// Parses a command line whose words are separated by line ends: the options of scenes, cameras,
// images and methods. It checks the results and runs nothing.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "apps/raysheaf/parse.h"
#include "fuzz/targets.h"

namespace raysheaf::fuzz {
namespace {

[[noreturn]] void wrong(const char* what) {
  std::fprintf(stderr, "the options make no sense: %s\n", what);
  std::abort();
}

struct Look {
  void operator()(const app::RenderCommand& command) const {
    const RenderOptions& options = command.options;
    if (options.width < 1 || options.width > 16384 || options.height < 1 || options.height > 16384)
      wrong("--size");
    if (options.exposure && !(*options.exposure > 0)) wrong("--exposure");
    if (options.ambient && !(options.ambient->x >= 0)) wrong("--ambient");
    if (options.bounces > 32) wrong("--bounces");
  }
  template <class Other>
  void operator()(const Other& /*command*/) const {}
};

}  // namespace

void run_options(Input input) {
  std::vector<std::string> words{"raysheaf"};
  for (const std::uint8_t byte : input) {
    if (byte == '\n')
      words.emplace_back();
    else if (byte != 0)  // arguments cannot contain zero bytes
      words.back() += static_cast<char>(byte);
  }
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  const auto parsed = app::parse(static_cast<int>(argv.size()), argv.data());
  if (const int* code = std::get_if<int>(&parsed)) {
    if (*code != app::kSuccess && *code != app::kUsage) wrong("exit code");
    return;
  }
  std::visit(Look(), std::get<app::Command>(parsed));
}

}  // namespace raysheaf::fuzz
