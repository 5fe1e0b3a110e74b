// Output to the terminal: standard output and standard error, and their closed ends.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace raysheaf::app {

/// Writes to standard output. A reader that closed the pipe is not an error; other failures throw
/// `Error`.
void print(std::string_view text);

/// Writes "raysheaf: SENTENCE" to standard error.
void tell_error(std::string_view sentence);

/// Writes a line to standard error.
void tell(std::string_view line);

/// Writes the first few warnings about a scene, and how many more there are.
void tell_warnings(const std::vector<std::string>& warnings);

/// Silences a process whose output another one repeats: nothing of the above reaches the terminal.
void be_silent(bool silent);
[[nodiscard]] bool is_silent();

/// Replaces control characters by '?'. Names come from files, which must not control the terminal.
[[nodiscard]] std::string printable(std::string_view text);

/// Columns of the terminal that `stream` writes to; 80 if it is not a terminal or does not know.
[[nodiscard]] std::size_t terminal_columns(std::FILE* stream);
/// Columns that text on standard output may take: the environment's COLUMNS if that is a number,
/// else those of the terminal.
[[nodiscard]] std::size_t output_columns();

/// From here on Ctrl-C and the signals TERM and HUP set a flag instead of ending the program;
/// another such signal, half a second later or more, ends it.
void catch_interrupts();
[[nodiscard]] bool interrupted();
/// The exit code after an interrupt: 128 plus the number of the signal.
[[nodiscard]] int interrupted_code();
/// Throws `Error` (kCancelled) after an interrupt.
void stop_if_interrupted();

}  // namespace raysheaf::app
