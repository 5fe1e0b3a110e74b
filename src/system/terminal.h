// Standard streams, terminals, and requests to stop.
#pragma once

#include <cstddef>
#include <cstdio>

namespace raysheaf::system {

[[nodiscard]] bool is_terminal(std::FILE* stream);
/// Columns of the terminal that `stream` writes to; 0: unknown, or no terminal.
[[nodiscard]] std::size_t columns_of(std::FILE* stream);

/// From here on Ctrl-C, and signals by which others ask a program to end, call `on_stop(signal)`
/// instead, which may only do what a signal handler may. Signals that are ignored stay ignored.
void catch_stops(void (*on_stop)(int));
/// Ends the program as the signal does where nothing catches it. For signal handlers.
void end_by(int signal);

/// A write to a closed pipe, or beyond the limit on a file's size, then fails instead of ending the
/// program. Standard streams that are closed lead nowhere, so that no file which is opened later
/// gets their number; writing to them fails. Streams carry bytes: lines do not end in two
/// characters.
void guard_streams();

}  // namespace raysheaf::system
