// The ways to ask Embree 3 about a block of rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "raysheaf/types.h"

struct RTCSceneTy;
struct RTCIntersectContext;

namespace raysheaf::app {

inline constexpr std::size_t kRaysATask = 1024;

struct EmbreeCall {
  const char* closest_name;
  const char* any_name;
  bool coherent;  ///< the flag of the context
  void (*closest)(RTCSceneTy* scene, RTCIntersectContext& context, std::span<const Ray> rays,
                  std::span<Hit> hits);
  void (*any)(RTCSceneTy* scene, RTCIntersectContext& context, std::span<const Ray> rays,
              std::span<std::uint8_t> occluded);
};

/// All of them; each takes `kRaysATask` rays at most.
[[nodiscard]] std::span<const EmbreeCall> embree_calls();

}  // namespace raysheaf::app
