// raysheaf: everything except the window.
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "entry/entry.h"
#include "options.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

constexpr const char* kViewer = "raysheaf-view";

/// Returns only if that fails.
void become_viewer(const std::vector<const char*>& arguments) {
  std::error_code unknown;
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return;
  program.replace_filename(kViewer);
  // The system's messages about missing libraries begin with the first of these.
  std::vector<const char*> given = {"raysheaf view"};
  given.insert(given.end(), arguments.begin() + 2, arguments.end());
  given.push_back(nullptr);
  execv(program.c_str(), const_cast<char* const*>(given.data()));
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
