// Positions, normals and sides of hits that a scene was asked for.
#include "raysheaf/hit_points.h"

#include <memory>

#include "core.h"
#include "gil.h"
#include "raysheaf/error.h"
#include "raysheaf/large_vector.h"
#include "shared_scene.h"

namespace raysheaf::python {
namespace {

using HitArray = nb::ndarray<const float, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using Directions = nb::ndarray<const float, nb::shape<-1, 3>, nb::device::cpu>;
using Points = nb::ndarray<nb::numpy, float, nb::shape<-1, -1>>;

constexpr std::size_t kPointFloats = sizeof(HitPoint) / sizeof(float);
static_assert(kPointFloats == 11, "raysheaf/_asked.py counts on it");

/// The points as rows of floats. `version`: of the scene, when it was asked.
Points points_of(SharedScene& shared, const HitArray& hits, const Directions& directions,
                 std::uint64_t version, const std::optional<TimeArray>& times) {
  if (directions.shape(0) != hits.shape(0))
    throw nb::type_error("hit_points: arrays of equal length expected");
  std::span<const float> when;
  if (times) when = {times->data(), times->shape(0)};
  NumberRows rows;
  rows.data = directions.data();
  rows.row_stride = directions.stride(0);
  rows.column_stride = directions.stride(1);
  auto points = std::make_unique<LargeVector<HitPoint>>(hits.shape(0));
  {
    const WithoutGil released;
    shared.look_committed(
        [&](const Scene& scene) {
          if (shared.version() != version)
            throw Error(ErrorCode::kWrongState,
                        "the scene has changed since it was asked for them: ask for positions, "
                        "normals and sides before you change it",
                        "hits");
          hit_points(scene, rows, {reinterpret_cast<const Hit*>(hits.data()), hits.shape(0)},
                     *points, when);
        },
        [&] { released.check_signals(); });
  }
  LargeVector<HitPoint>* const kept = points.release();
  const nb::capsule owner(
      kept, [](void* at) noexcept { delete static_cast<LargeVector<HitPoint>*>(at); });
  return {kept->data(), {kept->size(), kPointFloats}, owner};
}

}  // namespace

void bind_hit_points(nb::module_& module) {
  module.def("hit_points", points_of, nb::arg("scene"), nb::arg("hits").noconvert(),
             nb::arg("directions").noconvert(), nb::arg("version"),
             nb::arg("times").noconvert().none());
}

}  // namespace raysheaf::python
