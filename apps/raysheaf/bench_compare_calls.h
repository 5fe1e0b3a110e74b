// The ways to ask Embree 3 about a block of rays.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <span>

#include "raysheaf/types.h"

namespace raysheaf::app {

struct EmbreeCall {
  const char* closest_name;
  const char* any_name;
  bool coherent;  ///< the flag of the context
  void (*closest)(RTCScene scene, RTCIntersectContext& context, std::span<const Ray> rays,
                  std::span<Hit> hits);
  void (*any)(RTCScene scene, RTCIntersectContext& context, std::span<const Ray> rays,
              std::span<std::uint8_t> occluded);
};

/// All of them; each takes `kBlock` rays at most.
[[nodiscard]] std::span<const EmbreeCall> embree_calls();

}  // namespace raysheaf::app
