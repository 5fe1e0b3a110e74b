#include "render/backends/cuda_gl.h"

#include <cuda_gl_interop.h>

#include <algorithm>
#include <array>
#include <string>

#include "exec/cuda/cuda_device_templates.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

constexpr const char* kSharing = "CUDA device: OpenGL";

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::kUnsupported, why, kSharing);
}

/// Reports every refusal as unsupported, because the image can be copied instead.
void require(cudaError_t status) {
  try {
    check_cuda(status, kSharing);
  } catch (const Error& error) {
    refuse(error.sentence());
  }
}

cudaStream_t stream_of(const CudaDevice& device) {
  return static_cast<cudaStream_t>(device.stream());
}
cudaGraphicsResource_t resource_of(void* resource) {
  return static_cast<cudaGraphicsResource_t>(resource);
}

}  // namespace

CudaGlBuffer::CudaGlBuffer(CudaDevice& device, unsigned name, GlAccess access)
    : index_(device.index()) {
  const CurrentDevice current(index_, kSharing);
  std::array<int, 16> drawing{};
  unsigned count = 0;
  // If CUDA cannot list the devices that draw, registering the buffer decides.
  const cudaError_t said = cudaGLGetDevices(
      &count, drawing.data(), static_cast<unsigned>(drawing.size()), cudaGLDeviceListAll);
  ignore_cuda(said);
  const auto end = drawing.begin() + std::min<std::size_t>(count, drawing.size());
  if (said == cudaSuccess && count > 0 && std::find(drawing.begin(), end, index_) == end)
    refuse("OpenGL draws on another device");
  cudaGraphicsResource_t resource = nullptr;
  require(cudaGraphicsGLRegisterBuffer(&resource, name,
                                       access == GlAccess::kRead
                                           ? cudaGraphicsRegisterFlagsReadOnly
                                           : cudaGraphicsRegisterFlagsWriteDiscard));
  // Maps the buffer once, so that a driver that refuses only now is reported here, too.
  cudaError_t status = cudaGraphicsMapResources(1, &resource, stream_of(device));
  if (status == cudaSuccess) status = cudaGraphicsUnmapResources(1, &resource, stream_of(device));
  if (status != cudaSuccess) ignore_cuda(cudaGraphicsUnregisterResource(resource));
  require(status);
  resource_ = resource;
}

CudaGlBuffer::~CudaGlBuffer() {
  const CurrentDevice current(index_);
  ignore_cuda(cudaGraphicsUnregisterResource(resource_of(resource_)));
}

void* CudaGlBuffer::map(const char* stage, CudaDevice& device, std::size_t bytes) const {
  const CurrentDevice current(index_, stage);
  cudaGraphicsResource_t resource = resource_of(resource_);
  check_cuda(cudaGraphicsMapResources(1, &resource, stream_of(device)), stage);
  void* memory = nullptr;
  std::size_t room = 0;
  cudaError_t status = cudaGraphicsResourceGetMappedPointer(&memory, &room, resource);
  if (status == cudaSuccess && room < bytes) status = cudaErrorInvalidValue;
  if (status != cudaSuccess)
    ignore_cuda(cudaGraphicsUnmapResources(1, &resource, stream_of(device)));
  check_cuda(status, stage);
  return memory;
}

void CudaGlBuffer::unmap(const char* stage, CudaDevice& device) const {
  const CurrentDevice current(index_, stage);
  cudaGraphicsResource_t resource = resource_of(resource_);
  check_cuda(cudaGraphicsUnmapResources(1, &resource, stream_of(device)), stage);
}

void CudaGlBuffer::copy_to(const char* stage, CudaDevice& device, void* to,
                           std::size_t bytes) const {
  const CurrentDevice current(index_, stage);
  const void* const from = map(stage, device, bytes);
  const cudaError_t status =
      cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream_of(device));
  unmap(stage, device);
  check_cuda(status, stage);
}

}  // namespace raysheaf
