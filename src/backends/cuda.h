// Opens the CUDA device, and creates the tracers and stages that its backend hands out.
#pragma once

#include <cstdint>
#include <memory>

#include "device/backend.h"

namespace raysheaf {

/// The first CUDA device. Throws Error (kUnsupported) if this build has no CUDA or, with CUDA's
/// message, if the machine has no usable device.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_cuda();

// Each is created on the first CUDA device, and throws as `open_cuda`. `capacity`: of each list of
// pairs.
[[nodiscard]] std::unique_ptr<PairTracer> make_cuda_pair_tracer(std::uint32_t capacity);
[[nodiscard]] std::unique_ptr<PacketTracer> make_cuda_packet_tracer(std::uint32_t capacity);
[[nodiscard]] std::unique_ptr<DeviceStages> make_cuda_stages();
/// Throws also kOutOfMemory with one sentence if the buffers and rays do not fit.
[[nodiscard]] std::unique_ptr<BlockTracer> make_cuda_block_tracer(const Executor& executor,
                                                                  const BlockLimits& limits);

}  // namespace raysheaf
