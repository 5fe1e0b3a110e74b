// Measures a device's speed, from which lower bounds of stages are computed. For sources that
// include a device.
#pragma once

#include "device/backend.h"
#include "exec/device.h"
#include "exec/stage_clock.h"

namespace raysheaf {

/// Bytes read plus written per millisecond in copies of `bytes`, by the device's clock.
template <class Device>
double measure_copy(Device& device, std::size_t bytes) {
  constexpr int kCopies = 16;
  DeviceBuffer<std::uint8_t> from(device.allocator()), to(device.allocator());
  from.resize_uninitialized("copy bandwidth", bytes);
  to.resize_uninitialized("copy bandwidth", bytes);
  device.fill("copy bandwidth", from.view(), 1);
  device.fill("copy bandwidth", to.view(), 2);
  device.synchronize("copy bandwidth");
  device.keep_times(true);
  for (int i = 0; i < kCopies; ++i) device.copy("copy bandwidth", to.data(), from.data(), bytes);
  double ms = 0;
  for (const StageTime& time : device.times()) ms += time.ms;
  device.keep_times(false);
  return 2.0 * kCopies * static_cast<double>(bytes) / ms;
}

/// Multiplications and additions in binary32 per millisecond, not contracted, by `items`
/// independent threads.
template <class Device>
double measure_arithmetic(Device& device, std::size_t items) {
  constexpr int kRuns = 8, kChains = 4, kSteps = 256;
  DeviceBuffer<float> results(device.allocator());
  results.resize_uninitialized("arithmetic", items);
  float* const out = results.data();
  double ms = 0;
  for (int run = 0; run <= kRuns; ++run) {
    device.keep_times(true);
    device.for_each("arithmetic", items, [=] RAYSHEAF_DEVICE(std::size_t i) {
      float x[kChains];
      for (int c = 0; c < kChains; ++c) x[c] = static_cast<float>(i + static_cast<std::size_t>(c));
      for (int step = 0; step < kSteps; ++step)
        for (float& v : x) v = v * 0.75f + 0.5f;
      out[i] = x[0] + x[1] + x[2] + x[3];
    });
    for (const StageTime& time : device.times()) ms += run > 0 ? time.ms : 0;
  }
  device.keep_times(false);
  return 2.0 * kRuns * kChains * kSteps * static_cast<double>(items) / ms;
}

template <class Device>
DeviceSpeed measure_speed(Device& device) {
  return {measure_copy(device, Device::kMeasuredBytes),
          measure_arithmetic(device, Device::kMeasuredItems)};
}

}  // namespace raysheaf
