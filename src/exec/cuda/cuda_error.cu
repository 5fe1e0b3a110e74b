#include "exec/cuda/cuda_error.h"

#include <cuda_runtime.h>

#include <string>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

ErrorCode code_of(cudaError_t status) {
  switch (status) {
    case cudaErrorMemoryAllocation:
      return ErrorCode::kOutOfMemory;
    case cudaErrorNoDevice:
    case cudaErrorInsufficientDriver:
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorUnsupportedPtxVersion:
    case cudaErrorInitializationError:
    case cudaErrorSystemDriverMismatch:
    case cudaErrorCompatNotSupportedOnDevice:
    case cudaErrorDevicesUnavailable:
    case cudaErrorStubLibrary:
      return ErrorCode::kUnsupported;
    default:
      return ErrorCode::kInternal;
  }
}

}  // namespace

void check_cuda(int status, const char* stage) {
  const auto error = static_cast<cudaError_t>(status);
  if (error == cudaSuccess) return;
  static_cast<void>(cudaGetLastError());
  throw Error(
      code_of(error),
      std::string("CUDA says: ") + cudaGetErrorString(error) + " (" + cudaGetErrorName(error) + ")",
      stage);
}

void ignore_cuda(int status) noexcept {
  if (status != cudaSuccess) static_cast<void>(cudaGetLastError());
}

}  // namespace raysheaf
