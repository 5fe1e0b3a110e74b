// The verbs that every device has, and where their contract stands. Two classes have them:
//
//   EmulatedDevice   emulated/emulated_device.h   the CPU as a device would see itself
//   CudaDevice       exec/cuda/cuda_device.h      CUDA kernels, CUB, one stream
//
// What runs on a device is a template over the class, written once: `EmulatedDevice` runs the same
// functions over the same items, cut into the same threads, and is what tests look at where no
// device is.
//
//   for_each(stage, count, body)            body(i) for each i below count, in any order. `body` is
//                                           copied to the device: it captures values and views, and
//                                           is marked RAYSHEAF_DEVICE.
//   exclusive_scan(stage, in, out)          out[i] = in[0] + ... + in[i - 1], 64 bits, one place
//                                           more than `in`: the last is the total. Not overlapping.
//   select(stage, flags, out) -> count      the i with flags[i] != 0, ascending; `out` has a place
//                                           for each flag. Waits.
//   sort_pairs(stage, keys, values, bits)   stable, by the bits [bits.begin, bits.end) of the keys,
//                                           32 or 64 of them
//   sort_keys(stage, keys, bits)            the same without values; 64 bits
//   run_lengths(stage, keys, out) -> count  runs of equal keys, in order: their keys, and how many.
//                                           Waits.
//   fill(stage, view, byte)                 every byte of the view
//   copy(stage, to, from, bytes)            between memories of the device and of the host, either
//                                           way; has happened on return where the host's is in it
//   read(stage, place)                      the value there. Waits.
//   synchronize(stage)                      until all that was asked for is done
//   start_clock(stage)                      what was asked for before is done, and the device's own
//                                           clock starts. Waits.
//   stop_clock(stage) -> ms                 from then until all that was asked for since is done,
//                                           gaps included. Waits.
//   is_device_memory(pointer, name)         whether kernels may follow it. Throws Error
//                                           (kInvalidArgument, `name` as its place) where it is
//                                           another device's.
//   wait_for(stage, stream)                 what was asked for on another stream comes first
//   allocator()                             of the device's memory
//   free_bytes()                            of it that nobody has, as far as the machine knows
//   reads_host_memory()                     whether loops may follow a pointer to any memory of the
//                                           host's: one that they were given by mistake then shows
//                                           in no answer
//   Uplink, Downlink                        copies beside its work: exec/links.h
//   GlBuffer                                what OpenGL has: exec/cuda/cuda_gl.h
//
// All is done in the order in which it was asked for, and all but what waits may still be under way
// on return. `stage` names who asked: it is the place of the `Error` that is thrown where something
// fails (kOutOfMemory, kInternal with the machine's own words), and what `times()` is kept by.
// Fewer than 2^31 items in all verbs but `for_each`, which takes any number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/view.h"
#include "exec/device_memory.h"
#include "exec/launch.h"
#include "raysheaf/error.h"

namespace raysheaf {

/// How a device uses a buffer of OpenGL's.
enum class GlAccess : std::uint8_t { kRead, kWrite };

struct BitRange {
  std::uint32_t begin = 0, end = 0;
};

/// Two columns that take turns: what is sorted from one into the other. `keys` and `values` have
/// what is to be sorted, and take what is; the spare ones, of the same sizes, are scratch.
template <class Key>
struct SortColumns {
  DeviceBuffer<Key> keys, spare_keys;
  DeviceBuffer<std::uint32_t> values, spare_values;

  explicit SortColumns(DeviceAllocator& allocator)
      : keys(allocator), spare_keys(allocator), values(allocator), spare_values(allocator) {}
  void resize_uninitialized(const char* stage, std::size_t count, bool with_values) {
    keys.resize_uninitialized(stage, count);
    spare_keys.resize_uninitialized(stage, count);
    values.resize_uninitialized(stage, with_values ? count : 0);
    spare_values.resize_uninitialized(stage, with_values ? count : 0);
  }
  [[nodiscard]] std::size_t capacity_bytes() const {
    return keys.capacity_bytes() + spare_keys.capacity_bytes() + values.capacity_bytes() +
           spare_values.capacity_bytes();
  }
};

/// Runs of equal keys, places for as many as there are keys.
struct RunColumns {
  View<std::uint32_t> keys, lengths;
};

/// Throws for what CUB could not count.
inline void check_item_count(const char* stage, std::size_t count) {
  if (count > std::size_t{std::numeric_limits<std::int32_t>::max()})
    throw Error(ErrorCode::kUnsupported, "2^31 items or more at once", stage);
}

/// out[i] = in[order[i]].
template <class Device, class T>
void gather(Device& device, const char* stage, View<const T> in, View<const std::uint32_t> order,
            View<T> out) {
  device.for_each(stage, order.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { out.data[i] = in.data[order.data[i]]; });
}

/// 0, 1, 2 ...
template <class Device>
void number(Device& device, const char* stage, View<std::uint32_t> out) {
  device.for_each(stage, out.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out.data[i] = static_cast<std::uint32_t>(i);
  });
}

}  // namespace raysheaf
