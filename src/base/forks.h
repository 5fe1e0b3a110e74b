// Children of fork: they have memory as their parent's threads had it, and none of the threads.
#pragma once

#include <cstdint>
#include <mutex>

namespace raysheaf {

/// Another number than the parent's in a child of fork, once this was called in the parent.
[[nodiscard]] std::uint32_t fork_number() noexcept;

/// Throws `Error` (kWrongState) with this place where `made` is not this process's fork number.
void check_not_forked(std::uint32_t made, const char* place);

/// A process forks while nobody holds `mutex`, which lasts as long as the process does.
void hold_over_forks(std::mutex* mutex);

}  // namespace raysheaf
