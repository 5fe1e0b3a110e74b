// Parses, runs, and turns every error into one sentence and an exit code.
#include <exception>
#include <new>
#include <variant>
#include <vector>

#include "apps/support/console.h"
#include "entry/entry.h"
#include "options.h"
#include "parse.h"
#include "ranks/ranks.h"
#include "raysheaf/error.h"
#include "raysheaf/paper.h"
#include "system/terminal.h"

namespace raysheaf::app {
namespace {

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return kUsage;
    case ErrorCode::kCancelled:
      return interrupted_code();
    default:
      return kFailed;
  }
}

/// Several processes share the work of `render`, or run independently.
void look_at_launch(const Command& command) {
  if (launch().size == 1) return;
  const RenderCommand* render = std::get_if<RenderCommand>(&command);
  if (render == nullptr)
    throw Error(
        ErrorCode::kInvalidArgument,
        "several processes can share the work only of render: start this command without mpirun");
  if (render->share == Share::kNone) be_silent(false);
}

int run_command_line(int argc, const char* const* argv) {
  be_silent(launch().rank > 0);
  const std::variant<Command, int> parsed = parse(argc, argv);
  if (const int* code = std::get_if<int>(&parsed)) return *code;
  const Command& command = std::get<Command>(parsed);
  look_at_launch(command);
  return std::visit([](const auto& one) { return run(one); }, command);
}

int guarded(int argc, const char* const* argv) {
  try {
    return run_command_line(argc, argv);
  } catch (const Error& error) {
    tell_error(error.code() == ErrorCode::kCancelled ? "interrupted" : error.what());
    return exit_code(error.code());
  } catch (const std::bad_alloc&) {
    tell_error("out of memory");
  } catch (const std::exception& error) {
    tell_error(std::string("an internal error: ") + error.what());
  }
  return kFailed;
}

}  // namespace
}  // namespace raysheaf::app

int main(int argc, char** argv) {
  using namespace raysheaf::app;
  raysheaf::system::guard_streams();
  raysheaf::use_paper_methods();
  const std::vector<const char*> line = command_line(argc, argv);
  const int code = guarded(static_cast<int>(line.size()), line.data());
  return is_silent() ? kSuccess : code;
}
