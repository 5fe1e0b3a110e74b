// CUDA's errors as the project's exception.
#pragma once

namespace raysheaf {

/// `status`: a cudaError_t. Throws Error unless it is success: CUDA's name and description of it,
/// with `stage` as the place; kOutOfMemory if memory is exhausted, kUnsupported if there is no
/// device or driver for this build, else kInternal. Clears CUDA's last error.
void check_cuda(int status, const char* stage);

/// For errors that cannot be handled. Clears CUDA's last error, so that the next check does not
/// report it.
void ignore_cuda(int status) noexcept;

}  // namespace raysheaf
