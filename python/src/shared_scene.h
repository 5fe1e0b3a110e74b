// A scene behind its door, for any number of Python's threads, and the parameters of its queries.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "core.h"
#include "door.h"
#include "gil.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"

namespace raysheaf::python {

/// Waits and works without the interpreter's lock; what runs inside touches no Python object.
class __attribute__((visibility("hidden"))) SharedScene {
 public:
  SharedScene(std::uint32_t threads, bool cuda)
      : scene_(Context(
            ContextOptions{.device = cuda ? Device::kCuda : Device::kCpu, .threads = threads})) {}
  explicit SharedScene(Scene&& scene) : scene_(std::move(scene)) {}

  template <class Body>
  auto change(const Body& body) {
    const WithoutGil released;
    const Door::Changing alone(door_, [&] { released.check_signals(); });
    if constexpr (std::is_void_v<decltype(body(scene_))>) {
      body(scene_);
      ++version_;
    } else {
      auto result = body(scene_);
      ++version_;
      return result;
    }
  }

  void commit() {
    const WithoutGil released;
    const Door::Changing alone(door_, [&] { released.check_signals(); });
    scene_.commit();
  }

  template <class Body>
  auto look(const Body& body) {
    const WithoutGil released;
    const Door::Reading inside(door_, [&] { released.check_signals(); });
    return body(static_cast<const Scene&>(scene_));
  }

  /// Looks at a scene whose changes are all committed. To be called without the interpreter's lock;
  /// `poll` as `Door` has it.
  template <class Body, class Poll>
  auto look_committed(const Body& body, const Poll& poll) {
    for (;;) {
      {
        const Door::Reading inside(door_, poll);
        if (scene_.is_committed()) return body(static_cast<const Scene&>(scene_));
      }
      const Door::Changing alone(door_, poll);
      scene_.commit();
    }
  }

  /// Another number after each change; a commit is none. For bodies that look at the scene.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  Scene scene_;
  std::uint64_t version_ = 0;
  Door door_;
};

using MaskArray = nb::ndarray<const std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using TimeArray = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using SkipArray = nb::ndarray<const std::uint32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

/// The parameters of a query, apart from its rays or points.
struct __attribute__((visibility("hidden"))) QueryRequest {
  std::uint32_t mask;
  bool brute, check;
  nb::object statistics;  // a dict, or None
  Sides sides = Sides::kBoth;
  std::optional<MaskArray> masks;   // one for each ray
  std::optional<SkipArray> skip;    // one for each ray
  std::optional<MaskArray> worlds;  // one for each ray or point
  std::size_t per_world = 0;        // instead: so many in a row are in one world
  std::optional<TimeArray> times;   // one for each ray

  [[nodiscard]] std::span<const WorldId> worlds_of_items() const {
    if (!worlds) return {};
    return {worlds->data(), worlds->shape(0)};
  }
};

inline nb::list plan_of(const QueryStatistics& statistics) {
  nb::list plan;
  for (const std::string& sentence : statistics.plan) plan.append(sentence.c_str());
  return plan;
}

inline void write_statistics(const QueryStatistics& from, const nb::dict& to) {
  to["rays"] = from.rays;
  to["triangles"] = from.triangles;
  to["bound_tests"] = from.bound_tests;
  to["ray_bound_tests"] = from.ray_bound_tests;
  to["triangle_tests"] = from.triangle_tests;
  to["update_ms"] = from.update_ms;
  to["check_ms"] = from.check_ms;
  to["order_ms"] = from.order_ms;
  to["hierarchy_ms"] = from.hierarchy_ms;
  to["trace_ms"] = from.trace_ms;
  to["total_ms"] = from.total_ms;
  to["plan"] = plan_of(from);
}

void bind_point_queries(nb::module_& module, nb::class_<SharedScene>& scene);

}  // namespace raysheaf::python
