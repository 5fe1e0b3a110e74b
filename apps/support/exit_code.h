// The exit codes of the programs.
#pragma once

namespace raysheaf::app {

/// Exit codes, as docs/command-line.md documents them; `interrupted_code()` is that of an
/// interrupt.
enum ExitCode : int {
  kSuccess = 0,
  kFailed = 1,
  kUsage = 2,
};

}  // namespace raysheaf::app
