// What opens a CUDA device, and makes on it what a backend is asked for.
#pragma once

#include <cstdint>
#include <memory>

#include "device/backend.h"

namespace raysheaf {

/// The first CUDA device. Throws Error (kUnsupported) where this build has no CUDA, or in CUDA's
/// words where the machine has none that it can use.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_cuda();

/// On the first CUDA device, as what follows; errors as `open_cuda`. `capacity`: of each list of
/// pairs.
[[nodiscard]] std::unique_ptr<PairTracer> make_cuda_pair_tracer(std::uint32_t capacity);
[[nodiscard]] std::unique_ptr<PacketTracer> make_cuda_packet_tracer(std::uint32_t capacity);
[[nodiscard]] std::unique_ptr<DeviceStages> make_cuda_stages();
/// Throws as well kOutOfMemory with one sentence where no buffers and rays fit.
[[nodiscard]] std::unique_ptr<BlockTracer> make_cuda_block_tracer(const Executor& executor,
                                                                  const BlockLimits& limits);

}  // namespace raysheaf
