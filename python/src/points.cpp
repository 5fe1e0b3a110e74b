// Where hits lie, in double precision: for callers whose meshes and rays are float64.
#include <cmath>

#include "core.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using Doubles3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Faces = nb::ndarray<const std::int64_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using HitArray = nb::ndarray<const float, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using RayIds = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Distances = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// Below this sine between ray and plane, the hit's weights say more than the plane does: the error
// of a point on the plane grows with the inverse, that of the weights is a rounding of float32.
constexpr double kFlat = 1e-4;

struct Double3 {
  double x, y, z;
};

Double3 operator-(Double3 a, Double3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Double3 operator+(Double3 a, Double3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Double3 operator*(double s, Double3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
double dot(Double3 a, Double3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(Double3 a) {
  return std::sqrt(dot(a, a));
}
Double3 cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The rows of an array, with an error for an index that is none.
template <class Row, class Array>
struct Rows {
  explicit Rows(const Array& array)
      : data(reinterpret_cast<const Row*>(array.data())), count(array.shape(0)) {}

  const Row& operator[](std::uint64_t i) const {
    if (i >= count) throw nb::index_error("hit_points: an index is out of range");
    return data[i];
  }

  const Row* data;
  std::size_t count;
};

Double3 point_of(const Hit& hit, Double3 a, Double3 b, Double3 c, Double3 origin,
                 Double3 direction) {
  const Double3 normal = cross(b - a, c - a);
  const double slope = dot(normal, direction);
  if (std::abs(slope) > kFlat * length(normal) * length(direction))
    return origin + (dot(normal, a - origin) / slope) * direction;
  return a + double{hit.u} * (b - a) + double{hit.v} * (c - a);
}

/// points[i]: where the ray ray_id[i] meets the face that hits[i] names. distances[i]: how far from
/// the ray's origin, as a length.
void hit_points(const Doubles3& vertices, const Faces& faces, const Doubles3& origins,
                const Doubles3& directions, const HitArray& hits, const RayIds& ray_id,
                const Points& points, const Distances& distances) {
  struct Face {
    std::int64_t ids[3];
  };
  const std::size_t count = hits.shape(0);
  if (ray_id.shape(0) != count || points.shape(0) != count || distances.shape(0) != count)
    throw nb::value_error("hit_points: arrays of equal length expected");
  const Rows<Double3, Doubles3> corner(vertices), origin(origins), direction(directions);
  const Rows<Face, Faces> face(faces);
  const Rows<Hit, HitArray> hit(hits);
  auto* const point = reinterpret_cast<Double3*>(points.data());
  const nb::gil_scoped_release release;
  for (std::size_t i = 0; i < count; ++i) {
    const auto ray = static_cast<std::uint64_t>(ray_id.data()[i]);
    const Face& named = face[hit[i].prim_id];
    const auto at = [&](int k) { return corner[static_cast<std::uint64_t>(named.ids[k])]; };
    const Double3 from = origin[ray], along = direction[ray];
    point[i] = point_of(hit[i], at(0), at(1), at(2), from, along);
    distances.data()[i] = dot(point[i] - from, along) / length(along);
  }
}

}  // namespace

void bind_points(nb::module_& module) {
  module.def("hit_points", hit_points, nb::arg("vertices").noconvert(),
             nb::arg("faces").noconvert(), nb::arg("origins").noconvert(),
             nb::arg("directions").noconvert(), nb::arg("hits").noconvert(),
             nb::arg("ray_id").noconvert(), nb::arg("points").noconvert(),
             nb::arg("distances").noconvert());
}

}  // namespace raysheaf::python
