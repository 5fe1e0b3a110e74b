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

static_assert(sizeof(HitPoint) == 11 * sizeof(float), "raysheaf/_asked.py counts on it");

/// The results of `find(scene, directions, hits, found, times)` as rows of floats. `version`: of
/// the scene, when it was asked.
template <class Found, class Find>
Points rows_of(SharedScene& shared, const HitArray& hits, const Directions& directions,
               std::uint64_t version, const std::optional<TimeArray>& times, const Find& find) {
  if (directions.shape(0) != hits.shape(0))
    throw nb::type_error("hits: arrays of equal length expected");
  std::span<const float> when;
  if (times) when = {times->data(), times->shape(0)};
  NumberRows rows;
  rows.data = directions.data();
  rows.row_stride = directions.stride(0);
  rows.column_stride = directions.stride(1);
  auto found = std::make_unique<LargeVector<Found>>(hits.shape(0));
  {
    const WithoutGil released;
    shared.look_committed(
        [&](const Scene& scene) {
          if (shared.version() != version)
            throw Error(ErrorCode::kWrongState,
                        "the scene has changed since it was asked for them: ask for positions, "
                        "normals and sides before you change it",
                        "hits");
          find(scene, rows, {reinterpret_cast<const Hit*>(hits.data()), hits.shape(0)}, *found,
               when);
        },
        [&] { released.check_signals(); });
  }
  LargeVector<Found>* const kept = found.release();
  const nb::capsule owner(kept,
                          [](void* at) noexcept { delete static_cast<LargeVector<Found>*>(at); });
  return {
      reinterpret_cast<float*>(kept->data()), {kept->size(), sizeof(Found) / sizeof(float)}, owner};
}

Points points_of(SharedScene& shared, const HitArray& hits, const Directions& directions,
                 std::uint64_t version, const std::optional<TimeArray>& times) {
  return rows_of<HitPoint>(shared, hits, directions, version, times,
                           [](const Scene& scene, const NumberRows& rows, std::span<const Hit> some,
                              std::span<HitPoint> points, std::span<const float> when) {
                             hit_points(scene, rows, some, points, when);
                           });
}

Points normals_of(SharedScene& shared, const HitArray& hits, const Directions& directions,
                  std::uint64_t version, const std::optional<TimeArray>& times) {
  return rows_of<Vec3>(shared, hits, directions, version, times, facing_normals);
}

}  // namespace

void bind_hit_points(nb::module_& module) {
  const auto define = [&](const char* name, auto function) {
    module.def(name, function, nb::arg("scene"), nb::arg("hits").noconvert(),
               nb::arg("directions").noconvert(), nb::arg("version"),
               nb::arg("times").noconvert().none());
  };
  define("hit_points", points_of);
  define("facing_normals", normals_of);
}

}  // namespace raysheaf::python
