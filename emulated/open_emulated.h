// Opens the CPU as an emulated device, for tests and counts.
#pragma once

#include <cstdint>
#include <memory>

#include "device/backend.h"
#include "emulated/emulated_device.h"

namespace raysheaf {

/// The CPU emulating a device (emulated/emulated_device.h), with `memory` as the device's memory,
/// from which `allocator`, if given, allocates.
[[nodiscard]] std::unique_ptr<DeviceBackend> open_emulated(const Executor& executor,
                                                           HostAllocator& memory,
                                                           DeviceAllocator* allocator = nullptr);

// The same with lists of another `capacity` of pairs.
[[nodiscard]] std::unique_ptr<PairTracer> make_emulated_pair_tracer(
    std::uint32_t capacity, const Executor& executor, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);
[[nodiscard]] std::unique_ptr<PacketTracer> make_emulated_packet_tracer(
    std::uint32_t capacity, const Executor& executor, HostAllocator& memory,
    DeviceAllocator* allocator = nullptr);

}  // namespace raysheaf
