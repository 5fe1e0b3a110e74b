// Orders rays by their keys on a device, as paper/order/order.h does on the CPU: compresses runs of
// equal keys, sorts and decompresses them (Garanzha & Loop 2010; Reis, Costa, Pereira 2017,
// sections 3.1 and 3.2). For sources that include a device.
#pragma once

#include "exec/device.h"
#include "paper/order/order_body.h"

namespace raysheaf {

/// Place p of the order belongs to chunk r, the last that starts at or before it
/// (paper/order/order_body.h).
template <class Device>
void decompress_on(Device& device, View<const std::uint32_t> chunks, const std::uint64_t* starts,
                   const std::uint64_t* bases, View<std::uint32_t> order) {
  device.for_each("order: decompress", order.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t run = chunk_at(starts, static_cast<std::uint32_t>(chunks.size), i);
    order.data[i] = static_cast<std::uint32_t>(bases[chunks.data[run]] + (i - starts[run]));
  });
}

template <class Device>
class KeyOrderOn {
 public:
  explicit KeyOrderOn(Device& device) : device_(device) {}

  /// Computes the stable order of `count` rays by the low `key_bits` bits of their keys, which may
  /// be in the host's or the device's memory; without keys, the order is the identity. Returns the
  /// number of runs of equal keys, 0 without keys.
  std::uint64_t sort(View<const std::uint32_t> keys, std::size_t count, std::uint32_t key_bits) {
    order_.resize_uninitialized("order: numbers", count);
    if (keys.empty()) {
      keys_.resize_uninitialized("order: numbers", 0);
      number(device_, "order: numbers", order_.view());
      return 0;
    }
    upload(device_, "copy: keys", keys, &keys_);
    columns_.resize_uninitialized("order: compress", count, true);
    lengths_.resize_uninitialized("order: compress", count);
    const std::uint32_t runs = device_.run_lengths("order: compress", keys_.view_const(),
                                                   {columns_.keys.view(), lengths_.view()});
    bases_.resize_uninitialized("order: compress", std::size_t{runs} + 1);
    device_.exclusive_scan("order: compress", lengths_.view_const().slice(0, runs), bases_.view());
    columns_.resize_uninitialized("order: sort", runs, true);
    number(device_, "order: sort", columns_.values.view());
    device_.sort_pairs("order: sort", &columns_, {0, key_bits});
    sorted_lengths_.resize_uninitialized("order: decompress", runs);
    gather(device_, "order: decompress", lengths_.view_const(), columns_.values.view_const(),
           sorted_lengths_.view());
    starts_.resize_uninitialized("order: decompress", std::size_t{runs} + 1);
    device_.exclusive_scan("order: decompress", sorted_lengths_.view_const(), starts_.view());
    decompress_on(device_, columns_.values.view_const(), starts_.data(), bases_.data(),
                  order_.view());
    return runs;
  }

  /// order()[place] is the number of a ray.
  [[nodiscard]] View<const std::uint32_t> order() const { return order_.view_const(); }
  /// In the order in which the rays were given; empty without keys.
  [[nodiscard]] View<const std::uint32_t> keys() const { return keys_.view_const(); }

 private:
  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  SortColumns<std::uint32_t> columns_{memory_};
  DeviceBuffer<std::uint32_t> keys_{memory_}, lengths_{memory_}, sorted_lengths_{memory_},
      order_{memory_};
  DeviceBuffer<std::uint64_t> bases_{memory_}, starts_{memory_};
};

}  // namespace raysheaf
