// Refuses invalid rays on a device. For sources that include a device.
#pragma once

#include <string>

#include "exec/atomic.h"
#include "exec/device.h"
#include "geom/ray_fault.h"

namespace raysheaf {

/// Throws for the first invalid ray. `first_wrong` is scratch memory.
template <class Device>
void check_rays_on(Device& device, View<const Ray> rays, DeviceBuffer<std::uint32_t>* first_wrong) {
  first_wrong->resize_uninitialized("check: rays", 1);
  device.fill("check: rays", first_wrong->view(), 0xff);
  std::uint32_t* const first = first_wrong->data();
  device.for_each("check: rays", rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (!is_right(rays.data[i])) lower_to(first, static_cast<std::uint32_t>(i));
  });
  const std::uint32_t wrong = device.read("check: rays", first);
  if (wrong == kInvalidId) return;
  const RayFault fault = fault_of(device.read("check: rays", rays.data + wrong));
  throw Error(ErrorCode::kInvalidData, fault.sentence,
              "rays[" + std::to_string(wrong) + "]." + fault.field);
}

}  // namespace raysheaf
