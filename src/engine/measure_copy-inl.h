// The bandwidth that floors of stages are reckoned with; for the sources that know which device it
// is.
#pragma once

#include "exec/device.h"
#include "exec/stage_clock.h"

namespace raysheaf {

/// Bytes read and written a millisecond in copies of `bytes`, by the device's clock.
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

}  // namespace raysheaf
