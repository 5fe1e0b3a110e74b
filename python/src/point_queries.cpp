// The queries of a scene that points ask: arrays of any strides, float32 or float64.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/variant.h>

#include <optional>
#include <utility>

#include "interrupt.h"
#include "places.h"
#include "raysheaf/points.h"
#include "shared_scene.h"

namespace raysheaf::python {
namespace {

constexpr std::size_t kRecordBytes = 64;
static_assert(sizeof(ClosestPoint) == kRecordBytes);
using Records =
    nb::ndarray<std::uint8_t, nb::shape<-1, kRecordBytes>, nb::c_contig, nb::device::cpu>;
using Distances = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Points and radii as two arrays, which it keeps alive. Points in a device's memory are rows in C
/// order, and have one radius.
class __attribute__((visibility("hidden"))) PointArrays {
 public:
  PointArrays(Columns points, Column radii)
      : points_(std::move(points)),
        radii_(std::move(radii)),
        parts_(points_.shape(0), rows_of(points_), rows_of(radii_)) {}
  PointArrays(const Place& place, bool doubles, double radius)
      : place_(place), radius_(radius), parts_(place.count, rows_there(doubles)) {
    parts_.radii = NumberRows(&radius_, 0);
  }
  PointArrays(const PointArrays&) = delete;
  PointArrays& operator=(const PointArrays&) = delete;

  [[nodiscard]] const PointParts& parts() const { return parts_; }
  /// Null: they are numpy's.
  [[nodiscard]] const Place* place() const { return place_ ? &*place_ : nullptr; }

 private:
  [[nodiscard]] NumberRows rows_there(bool doubles) const {
    if (doubles) return NumberRows(static_cast<const double*>(place_->pointer));
    return NumberRows(static_cast<const float*>(place_->pointer));
  }
  template <class Array>
  NumberRows rows_of(const Array& array) {
    NumberRows rows;
    rows.data = array.data();
    rows.is_double = array.dtype() == nb::dtype<double>();
    if (!rows.is_double && array.dtype() != nb::dtype<float>())
      throw nb::type_error("Points: float32 or float64 expected");
    if (array.shape(0) != points_.shape(0))
      throw nb::type_error("Points: arrays of equal length expected");
    rows.row_stride = array.stride(0);
    rows.column_stride = array.ndim() == 1 ? 1 : array.stride(1);
    return rows;
  }

  Columns points_;
  Column radii_;
  std::optional<Place> place_;
  double radius_ = 0;
  PointParts parts_;
};

/// A query of no more points, and of no more tests at the worst, is over before anyone could be
/// tired of it.
constexpr std::uint64_t kFewPoints = 100'000, kFewPairs = 10'000'000;

/// Calls `body(scene, answers, options)`, which Ctrl-C may stop where it takes long. If arrays are
/// on a device, the query stays on the calling thread, as with rays.
template <class Item, class Array, class Body>
void ask(SharedScene& shared, const PointArrays& points, const Anywhere<Array>& out,
         const QueryRequest& request, bool even_odd, const Body& body) {
  const auto answers = items_of<Item>(out);
  const Streams streams = streams_of(points.place(), std::get_if<Place>(&out));
  QueryStatistics statistics;
  const bool counted = !request.statistics.is_none();
  PointOptions options{.method = request.brute ? QueryMethod::kBrute : QueryMethod::kDual,
                       .mask = request.mask,
                       .check = request.check,
                       .inside = even_odd ? InsideRule::kEvenOdd : InsideRule::kNonZero,
                       .stream = streams.asked,
                       .results_stream = streams.results,
                       .statistics = counted ? &statistics : nullptr};
  options.point_worlds = request.worlds_of_items();
  options.points_per_world = request.per_world;
  const auto answer = [&](const auto& poll) {
    shared.look_committed([&](const Scene& scene) { body(scene, answers, options); }, poll);
  };
  const std::uint64_t count = points.parts().count;
  const std::uint64_t triangles = shared.look([](const Scene& s) { return s.triangle_count(); });
  const bool is_long = count > kFewPoints || count * triangles > kFewPairs;
  if (is_long && !streams.any_place) {
    interruptible([&](const std::atomic<bool>& stop) {
      options.stop = &stop;
      answer([&stop] { give_up_if(stop); });
    });
  } else {
    const WithoutGil released;
    answer([&] { released.check_signals(); });
  }
  if (counted) write_statistics(statistics, nb::borrow<nb::dict>(request.statistics));
}

/// `k` results a point.
void query_nearest(SharedScene& shared, const PointArrays& points, std::size_t k,
                   const Anywhere<Records>& out, const QueryRequest& request) {
  ask<ClosestPoint>(shared, points, out, request, false,
                    [&](const Scene& scene, auto found, const PointOptions& options) {
                      nearest(scene, points.parts(), k, found, options);
                    });
}

void query_signed_distance(SharedScene& shared, const PointArrays& points, bool even_odd,
                           const Anywhere<Distances>& out, const QueryRequest& request) {
  ask<double>(shared, points, out, request, even_odd,
              [&](const Scene& scene, auto distances, const PointOptions& options) {
                signed_distance(scene, points.parts(), distances, options);
              });
}

void query_inside(SharedScene& shared, const PointArrays& points, bool even_odd,
                  const Anywhere<Flags>& out, const QueryRequest& request) {
  ask<std::uint8_t>(shared, points, out, request, even_odd,
                    [&](const Scene& scene, auto inside, const PointOptions& options) {
                      contains(scene, points.parts(), inside, options);
                    });
}

}  // namespace

void bind_point_queries(nb::module_& module, nb::class_<SharedScene>& scene) {
  nb::class_<PointArrays>(module, "PointArrays")
      .def(nb::init<Columns, Column>(), nb::arg("points").noconvert(), nb::arg("radii").noconvert())
      .def(nb::init<const Place&, bool, double>(), nb::arg("place"), nb::arg("doubles"),
           nb::arg("radius"));
  const auto points = nb::arg("points");
  const auto out = nb::arg("out").noconvert();
  scene.def("nearest", query_nearest, points, nb::arg("k"), out, nb::arg("request"))
      .def("signed_distance", query_signed_distance, points, nb::arg("even_odd"), out,
           nb::arg("request"))
      .def("inside", query_inside, points, nb::arg("even_odd"), out, nb::arg("request"));
}

}  // namespace raysheaf::python
