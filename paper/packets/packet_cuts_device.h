// Cuts ordered rays into packets on a device, as paper/packets/packets.h does on the CPU. For
// sources that include a device.
//
//   the first rays of cells ─► how many of each sense ─► packets, and the order split by sense
#pragma once

#include "exec/device.h"
#include "paper/packets/cut_body.h"

namespace raysheaf {

/// Ordered rays, on the device.
struct OrderedRays {
  View<const Ray> given;
  View<const std::uint32_t> order;  ///< order[place] is the number of a ray
  View<const std::uint32_t> keys;   ///< by place; may be empty
  std::uint32_t key_bits = 32;
};

/// Sets 1 at the places where a cell begins, or a part of one.
template <class Device>
void flag_cells_on(Device& device, const OrderedRays& rays, std::uint32_t most_rays,
                   std::uint8_t* begins) {
  const auto count = static_cast<std::uint32_t>(rays.order.size);
  device.for_each("hierarchy: packets", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const auto place = static_cast<std::uint32_t>(i);
    const Packet cell = packet_about(rays.keys, rays.key_bits, most_rays, count, place);
    begins[i] = cell.first == place ? 1 : 0;
  });
}

/// Cell `c` of those that begin at `starts`.
RAYSHEAF_HD inline Packet cell_of(View<const std::uint32_t> starts, std::size_t c,
                                  std::size_t count) {
  const std::uint32_t first = starts.data[c];
  const auto end = c + 1 < starts.size ? starts.data[c + 1] : static_cast<std::uint32_t>(count);
  return {first, end - first};
}

template <class Device>
void part_cells_on(Device& device, const OrderedRays& rays, View<const std::uint32_t> starts,
                   SenseCounts* senses, std::uint32_t* packets, std::uint32_t* parted) {
  device.for_each("hierarchy: packets", starts.size, [=] RAYSHEAF_DEVICE(std::size_t c) {
    const Packet cell = cell_of(starts, c, rays.order.size);
    const View<const std::uint32_t> members(rays.order.data + cell.first, cell.count);
    senses[c] = count_senses(rays.given, members);
    packets[c] = senses[c].packets();
    part_members(rays.given, senses[c], members, parted + cell.first);
  });
}

template <class Device>
void write_packets_on(Device& device, View<const std::uint32_t> starts, const SenseCounts* senses,
                      const std::uint64_t* places, Packet* packets) {
  device.for_each("hierarchy: packets", starts.size, [=] RAYSHEAF_DEVICE(std::size_t c) {
    write_packets(senses[c], starts.data[c], packets + places[c]);
  });
}

template <class Device>
class PacketCutsOn {
 public:
  explicit PacketCutsOn(Device& device) : device_(device) {}

  /// Cuts packets of at most `most_rays`.
  void cut(const OrderedRays& rays, std::uint32_t most_rays) {
    const std::size_t count = rays.order.size;
    order_.resize_uninitialized("hierarchy: packets", count);
    begins_.resize_uninitialized("hierarchy: packets", count);
    starts_.resize_uninitialized("hierarchy: packets", count);
    flag_cells_on(device_, rays, most_rays, begins_.data());
    const std::uint32_t cells =
        device_.select("hierarchy: packets", begins_.view_const(), starts_.view());
    const View<const std::uint32_t> starts = starts_.view_const().slice(0, cells);
    senses_.resize_uninitialized("hierarchy: packets", cells);
    counts_.resize_uninitialized("hierarchy: packets", cells);
    places_.resize_uninitialized("hierarchy: packets", std::size_t{cells} + 1);
    part_cells_on(device_, rays, starts, senses_.data(), counts_.data(), order_.data());
    device_.exclusive_scan("hierarchy: packets", counts_.view_const(), places_.view());
    packets_.resize_uninitialized("hierarchy: packets",
                                  device_.read("hierarchy: packets", places_.data() + cells));
    write_packets_on(device_, starts, senses_.data(), places_.data(), packets_.data());
  }

  [[nodiscard]] View<const Packet> packets() const { return packets_.view_const(); }
  /// The rays in the packets' order.
  [[nodiscard]] View<const std::uint32_t> order() const { return order_.view_const(); }

 private:
  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<std::uint32_t> order_{memory_}, starts_{memory_}, counts_{memory_};
  DeviceBuffer<std::uint8_t> begins_{memory_};
  DeviceBuffer<SenseCounts> senses_{memory_};
  DeviceBuffer<std::uint64_t> places_{memory_};
  DeviceBuffer<Packet> packets_{memory_};
};

}  // namespace raysheaf
