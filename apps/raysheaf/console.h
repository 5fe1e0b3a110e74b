// What reaches the terminal: standard output and standard error, and their closed ends.
#pragma once

#include <string>
#include <string_view>

namespace raysheaf::app {

/// Writes to standard output. A reader that went away is no error; other failures throw `Error`.
void print(std::string_view text);

/// "raysheaf: SENTENCE" on standard error.
void tell_error(std::string_view sentence);

/// A line on standard error.
void tell(std::string_view line);

/// A process that speaks for no run: nothing of the above reaches the terminal.
void be_silent(bool silent);
[[nodiscard]] bool is_silent();

/// Names come from files: control characters become '?', so that none of them reaches a terminal.
[[nodiscard]] std::string printable(std::string_view text);

/// Ctrl-C, and the signals TERM and HUP, from here on set a flag instead of ending the program;
/// another one, half a second later or more, ends it.
void catch_interrupts();
[[nodiscard]] bool interrupted();
/// The exit code then: 128 and the signal.
[[nodiscard]] int interrupted_code();
/// Throws `Error` (kCancelled) then.
void stop_if_interrupted();

/// At the start: a write to a closed pipe, or beyond the limit on a file's size, fails instead of
/// ending the program; standard streams that are closed lead nowhere, so that no file which is
/// opened later gets their place, and to print is an error then.
void guard_streams();

}  // namespace raysheaf::app
