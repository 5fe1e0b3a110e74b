// Parse, run, and turn whatever went wrong into one sentence and an exit code.
#include <exception>
#include <new>
#include <variant>

#include "console.h"
#include "options.h"
#include "parse.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return kUsage;
    case ErrorCode::kCancelled:
      return kInterrupted;
    default:
      return kFailed;
  }
}

int run_command_line(int argc, const char* const* argv) {
  const std::variant<Command, int> parsed = parse(argc, argv);
  if (const int* code = std::get_if<int>(&parsed)) return *code;
  return std::visit([](const auto& command) { return run(command); }, std::get<Command>(parsed));
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
    tell_error(std::string("an error that should not happen: ") + error.what());
  }
  return kFailed;
}

}  // namespace
}  // namespace raysheaf::app

int main(int argc, char** argv) {
  raysheaf::app::guard_streams();
  return raysheaf::app::guarded(argc, argv);
}
