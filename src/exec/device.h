// The verbs (operations) of every device, and their contract. Two classes implement them:
//
//   EmulatedDevice   emulated/emulated_device.h   the CPU, emulating a device
//   CudaDevice       exec/cuda/cuda_device.h      CUDA kernels, CUB, one stream
//
// Code for devices is a template over the class, written once: `EmulatedDevice` runs the same
// functions over the same items, divided among the same threads. Tests use it on machines without a
// device.
//
//   for_each(stage, count, body)            body(i) for each i below count, in any order. `body` is
//                                           copied to the device: it captures values and views, and
//                                           is marked RAYSHEAF_DEVICE.
//   exclusive_scan(stage, in, out)          out[i] = in[0] + ... + in[i - 1], 64 bits. `out`
//                                           has one element more than `in`: the total. Must not
//                                           overlap.
//   select(stage, flags, out) -> count      the i with flags[i] != 0, ascending; `out` has a place
//                                           for each flag. Waits.
//   sort_pairs(stage, keys, values, bits)   stable, by the bits [bits.begin, bits.end) of the keys
//                                           of 32 or 64 bits
//   sort_keys(stage, keys, bits)            as sort_pairs, without values; keys of 64 bits
//   run_lengths(stage, keys, out) -> count  runs of equal keys, in order: their keys and lengths.
//                                           Waits.
//   fill(stage, view, byte)                 sets every byte of the view
//   copy(stage, to, from, bytes)            between memories of the device and of the host, in any
//                                           direction; complete on return if one is the host's
//   read(stage, place)                      returns the value there. Waits.
//   synchronize(stage)                      waits until all queued work is done
//   start_clock(stage)                      waits for all queued work, and starts the device's own
//                                           clock.
//   stop_clock(stage) -> ms                 the time from then until all work queued since is done,
//                                           including gaps. Waits.
//   is_device_memory(pointer, name)         whether kernels may access it. Throws Error
//                                           (kInvalidArgument, `name` as its place) for memory of
//                                           another device.
//   wait_for(stage, stream)                 orders later work after the work of another stream
//   allocator()                             allocator of the device's memory
//   free_bytes()                            free device memory, as far as the machine knows
//   reads_host_memory()                     whether loops can access any memory of the host. If so,
//                                           a host pointer passed by mistake does not change
//                                           answers
//   Uplink, Downlink                        copies that overlap other work: exec/links.h
//   GlBuffer                                OpenGL's buffers: render/backends/cuda_gl.h
//
// All work is done in the order in which it was queued; work of verbs that do not wait may still be
// in progress on return. `stage` names the caller: it is the place of an `Error` (kOutOfMemory,
// kInternal with the machine's own message), and the key of the times in `times()`. All verbs
// except `for_each` take fewer than 2^31 items.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/view.h"
#include "exec/device_memory.h"
#include "exec/launch.h"
#include "raysheaf/error.h"

namespace raysheaf {

/// How a device accesses an OpenGL buffer.
enum class GlAccess : std::uint8_t { kRead, kWrite };

struct BitRange {
  std::uint32_t begin = 0, end = 0;
};

/// Double buffers for sorting: `keys` and `values` hold the input and, after the sort, the output;
/// the spare ones, of the same sizes, are scratch.
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

/// Runs of equal keys, with as many places as there are keys.
struct RunColumns {
  View<std::uint32_t> keys, lengths;
};

/// Throws if CUB could not count the items.
inline void check_item_count(const char* stage, std::size_t count) {
  if (count > std::size_t{std::numeric_limits<std::int32_t>::max()})
    throw Error(ErrorCode::kUnsupported, "2^31 items or more at once are not supported", stage);
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

/// Makes `to` a copy of `from`, which may be in the memory of the host or of the device.
template <class Device, class T>
void upload(Device& device, const char* stage, View<const T> from, DeviceBuffer<T>* to) {
  to->resize_uninitialized(stage, from.size);
  if (!from.empty()) device.copy(stage, to->data(), from.data, from.size * sizeof(T));
}

}  // namespace raysheaf
