// raysheaf: everything except the window.
#include <filesystem>
#include <string>
#include <string_view>

#include "entry/entry.h"
#include "options.h"
#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

constexpr const char* kViewer = "raysheaf-view";

/// Returns only if that fails.
void become_viewer(const std::vector<const char*>& arguments) {
  const std::filesystem::path program = system::program_path();
  if (program.empty()) return;
  // The system's messages about missing libraries begin with the first of these.
  std::vector<std::string> given = {"raysheaf view"};
  given.insert(given.end(), arguments.begin() + 2, arguments.end());
  system::become((program.parent_path() / kViewer).string(), given);
}

}  // namespace

std::vector<const char*> command_line(int argc, const char* const* argv) {
  std::vector<const char*> arguments(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "view") become_viewer(arguments);
  return arguments;
}

int run(const ViewCommand& /*command*/) {
  throw Error(ErrorCode::kUnsupported,
              std::string("the viewer is not available: ") + kViewer +
                  " is not in the folder of this program; it was switched off, or GLFW or Dear "
                  "ImGui was missing, when this program was built");
}

}  // namespace raysheaf::app
