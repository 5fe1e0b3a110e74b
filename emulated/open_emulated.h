// A device that is the CPU, and what a backend makes on it: for tests and counts.
#pragma once

#include <cstdint>
#include <memory>

#include "device/backend.h"
#include "emulated/emulated_device.h"

namespace raysheaf {

/// The CPU as a device would see itself (emulated/emulated_device.h), with a device's memory, which
/// `allocator`, if there is one, takes from `memory`.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor,
                                                           HostAllocator& memory,
                                                           DeviceAllocator* allocator = nullptr);

// Each as `open_emulated`. `capacity`: of each list of pairs.
[[nodiscard]] std::unique_ptr<PairTracer> make_emulated_pair_tracer(
    std::uint32_t capacity, const Executor& executor, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);
[[nodiscard]] std::unique_ptr<PacketTracer> make_emulated_packet_tracer(
    std::uint32_t capacity, const Executor& executor, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);
[[nodiscard]] std::unique_ptr<BlockTracer> make_emulated_block_tracer(
    const Executor& executor, const BlockLimits& limits, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);
[[nodiscard]] std::unique_ptr<DeviceStages> make_emulated_stages(const Executor& executor,
                                                                 HostAllocator& memory,
                                                                 DeviceAllocator* allocator);

}  // namespace raysheaf
