// The ways to query Embree for a block of rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "lab/commands/compare/embree_api.h"
#include "raysheaf/types.h"

namespace raysheaf::app {

inline constexpr std::size_t kRaysATask = 1024;

/// The last argument of every query: Embree 3 takes the context, Embree 4 the arguments.
struct EmbreeQuestion {
  EmbreeQuestion(const embree::Api& embree_api, embree::Scene of, bool coherent)
      : api(embree_api), scene(of) {
    context.flags = coherent ? embree::kContextCoherent : 0;
    arguments.flags = coherent ? embree::kArgumentsCoherent : 0;
  }

  const embree::Api& api;
  embree::Scene scene;
  embree::Context context;
  embree::Arguments arguments;
};

struct EmbreeCall {
  const char* closest_name;
  const char* any_name;
  bool coherent;  ///< whether rays are declared coherent
  bool stream;    ///< only Embree 3 supports streams
  void (*closest)(EmbreeQuestion& question, std::span<const Ray> rays, std::span<Hit> hits);
  void (*any)(EmbreeQuestion& question, std::span<const Ray> rays,
              std::span<std::uint8_t> occluded);
};

/// All ways; each takes at most `kRaysATask` rays.
[[nodiscard]] std::span<const EmbreeCall> embree_calls();

}  // namespace raysheaf::app
