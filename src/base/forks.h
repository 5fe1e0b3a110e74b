// Detects child processes of fork. They have a copy of their parent's memory, but none of its other
// threads.
#pragma once

#include <cstdint>
#include <mutex>

namespace raysheaf {

/// Returns a different number in a child of fork than in its parent, if the parent called this
/// before.
[[nodiscard]] std::uint32_t fork_number() noexcept;

/// Throws `Error` (kWrongState) with this place if `made` is not this process's fork number.
void check_not_forked(std::uint32_t made, const char* place);

/// Holds `mutex` during every fork, so that no other thread holds it at that moment. The mutex must
/// exist until the process ends.
void hold_over_forks(std::mutex* mutex);

}  // namespace raysheaf
