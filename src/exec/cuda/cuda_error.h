// What CUDA says of itself, as the project's exception.
#pragma once

namespace raysheaf {

/// `status`: a cudaError_t. Throws Error where it is not success: CUDA's name and description of
/// it, with `stage` as the place; kOutOfMemory where memory ran out, kUnsupported where there is no
/// device or driver for this build, else kInternal. Clears what CUDA remembers of it.
void check_cuda(int status, const char* stage);

/// Where nobody could do anything about it. Clears what CUDA remembers of it, too, lest it be taken
/// for an error of what is asked for next.
void ignore_cuda(int status) noexcept;

}  // namespace raysheaf
