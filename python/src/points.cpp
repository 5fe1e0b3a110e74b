// Computes the positions of hits in double precision, for callers with float64 meshes and rays.
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core.h"
#include "gil.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using Faces = nb::ndarray<const std::int64_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using HitArray = nb::ndarray<const float, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using RayIds = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kRaysABlock = 8192;

// Below this sine of the angle between ray and plane, the hit's barycentric weights are more
// accurate than the plane: a point on the plane has an error that grows with the inverse of the
// sine, while the weights have only the rounding error of float32.
constexpr double kFlat = 1e-4;

struct Face {
  std::int64_t ids[3];
};

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

/// The rows of an array; an invalid index is an error.
template <class Row, class Array>
struct Rows {
  explicit Rows(const Array& array)
      : data(reinterpret_cast<const Row*>(array.data())), count(array.shape(0)) {}

  const Row& operator[](std::uint64_t i) const {
    if (i >= count) throw nb::index_error("found_rows: an index is out of range");
    return data[i];
  }

  const Row* data;
  std::size_t count;
};

/// `unit` is as in `Found`.
Double3 point_of(const Hit& hit, Double3 a, Double3 b, Double3 c, Double3 origin, Double3 direction,
                 double unit) {
  const Double3 normal = cross(unit * (b - a), unit * (c - a));
  const double slope = dot(normal, direction);
  if (std::abs(slope) > kFlat * length(normal) * length(direction))
    return origin + (dot(normal, a - origin) / slope) * direction;
  return a + double{hit.u} * (b - a) + double{hit.v} * (c - a);
}

/// A mesh and rays in double precision, and the hits of the single-precision scene.
struct Found {
  Rows<Double3, Doubles3> corners;
  Rows<Face, Faces> faces;
  Rows<Double3, Doubles3> origins, directions;
  std::optional<RayIds> asked;  ///< which rays the scene was queried for; empty: all
  std::optional<RayIds> ends;   ///< hits [ends[i], ends[i + 1]) belong to ray i; empty: hit i does
  Rows<Hit, HitArray> hits;
  /// A power of two that scales the mesh to size 1, so that products neither overflow nor
  /// underflow.
  double unit;
  /// Hits of faces that share a corner count as one if they are no farther apart than this.
  double same_place;
  std::int64_t max_hits;  ///< per ray
};

struct Place3 {
  double distance;  ///< from the ray's origin
  std::int64_t face;
  Double3 point;
};

Place3 place_of(const Found& found, const Hit& hit, Double3 origin, Double3 direction) {
  const Face& face = found.faces[hit.prim_id];
  const auto at = [&](int k) { return found.corners[static_cast<std::uint64_t>(face.ids[k])]; };
  const Double3 point = point_of(hit, at(0), at(1), at(2), origin, direction, found.unit);
  return {dot(point - origin, direction) / length(direction), std::int64_t{hit.prim_id}, point};
}

struct FoundRow {
  std::int64_t face, ray;
  Double3 point;
};

bool share_corner(const Found& found, std::int64_t a, std::int64_t b) {
  const auto corner = [&](std::int64_t face, int k) {
    const std::int64_t id = found.faces[static_cast<std::uint64_t>(face)].ids[k];
    return found.corners[static_cast<std::uint64_t>(id)];
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Double3 p = corner(a, i), q = corner(b, j);
      if (p.x == q.x && p.y == q.y && p.z == q.z) return true;
    }
  }
  return false;
}

/// Whether a hit is one that was kept already: that of a neighbouring face, where a ray runs
/// through an edge or a vertex, or at the very same point, as where a vertex lies on an edge.
bool is_known(const Found& found, const Place3& place, const std::vector<Place3>& kept) {
  constexpr std::size_t kMostCompared = 64;
  constexpr double kSamePoint = 1e-6;  // of `same_place`
  for (std::size_t k = kept.size(); k > 0 && kept.size() - k < kMostCompared; --k) {
    const Place3& before = kept[k - 1];
    const double apart = place.distance - before.distance;
    if (apart > found.same_place) return false;
    if (!(apart > kSamePoint * found.same_place) || share_corner(found, place.face, before.face))
      return true;
  }
  return false;
}

/// Appends the hits of one ray from near to far. Their order in double precision may differ from
/// that in float32.
void add_rows(const Found& found, std::size_t i, std::vector<Place3>* places,
              std::vector<Place3>* kept, std::vector<FoundRow>* rows) {
  const std::uint64_t first = found.ends ? static_cast<std::uint64_t>(found.ends->data()[i]) : i;
  const std::uint64_t end = found.ends ? static_cast<std::uint64_t>(found.ends->data()[i + 1])
                                       : i + (found.hits[i].prim_id != kInvalidId ? 1 : 0);
  if (first >= end) return;
  const std::int64_t ray = found.asked ? found.asked->data()[i] : static_cast<std::int64_t>(i);
  const Double3 origin = found.origins[static_cast<std::uint64_t>(ray)];
  const Double3 direction = found.directions[static_cast<std::uint64_t>(ray)];
  places->clear();
  for (std::uint64_t h = first; h < end; ++h)
    places->push_back(place_of(found, found.hits[h], origin, direction));
  // NaN sorts last.
  const auto nearer = [](const Place3& a, const Place3& b) {
    return a.distance < b.distance || (std::isnan(b.distance) && !std::isnan(a.distance));
  };
  if (!std::is_sorted(places->begin(), places->end(), nearer))
    std::stable_sort(places->begin(), places->end(), nearer);
  kept->clear();
  for (const Place3& place : *places) {
    if (static_cast<std::int64_t>(kept->size()) >= found.max_hits) break;
    if (is_known(found, place, *kept)) continue;
    rows->push_back({place.face, ray, place.point});
    kept->push_back(place);
  }
}

template <class Scalar, std::size_t kWidth>
struct Column {
  LargeVector<Scalar> values;

  explicit Column(std::size_t rows) : values(kWidth * rows) {}

  static nb::object array(std::unique_ptr<Column> column) {
    Column* const at = column.release();
    const nb::capsule owner(at, [](void* self) noexcept { delete static_cast<Column*>(self); });
    const std::size_t rows = at->values.size() / kWidth;
    if constexpr (kWidth == 1) return array_over<Scalar>(at->values.data(), {rows}, owner);
    return array_over<Scalar>(at->values.data(), {rows, kWidth}, owner);
  }
};

/// Faces, rays and positions, one row per hit: sorted by ray, then from near to far.
nb::tuple found_rows(const Context& context, const Found& found, std::size_t rays) {
  std::unique_ptr<Column<std::int64_t, 1>> face, ray;
  std::unique_ptr<Column<double, 3>> point;
  {
    const WithoutGil released;
    const std::size_t blocks = (rays + kRaysABlock - 1) / kRaysABlock;
    std::vector<std::vector<FoundRow>> rows(blocks);
    context.for_each_block(blocks, 1, [&](std::size_t begin, std::size_t end) {
      std::vector<Place3> places, kept;
      for (std::size_t b = begin; b < end; ++b)
        for (std::size_t i = b * kRaysABlock; i < std::min(rays, (b + 1) * kRaysABlock); ++i)
          add_rows(found, i, &places, &kept, &rows[b]);
    });
    std::vector<std::size_t> starts{0};
    for (const auto& some : rows) starts.push_back(starts.back() + some.size());
    face = std::make_unique<Column<std::int64_t, 1>>(starts.back());
    ray = std::make_unique<Column<std::int64_t, 1>>(starts.back());
    point = std::make_unique<Column<double, 3>>(starts.back());
    context.for_each_block(blocks, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        for (std::size_t i = 0; i < rows[b].size(); ++i) {
          const FoundRow& row = rows[b][i];
          const std::size_t place = starts[b] + i;
          face->values[place] = row.face;
          ray->values[place] = row.ray;
          point->values[3 * place] = row.point.x;
          point->values[3 * place + 1] = row.point.y;
          point->values[3 * place + 2] = row.point.z;
        }
      }
    });
  }
  return nb::make_tuple(Column<std::int64_t, 1>::array(std::move(face)),
                        Column<std::int64_t, 1>::array(std::move(ray)),
                        Column<double, 3>::array(std::move(point)));
}

}  // namespace

void bind_points(nb::module_& module) {
  module.def(
      "found_rows",
      [](const Context& context, const Doubles3& vertices, const Faces& faces,
         const Doubles3& origins, const Doubles3& directions, const std::optional<RayIds>& asked,
         const std::optional<RayIds>& ends, const HitArray& hits, double unit, double same_place,
         std::int64_t max_hits) {
        const std::size_t rays = ends ? ends->shape(0) - 1 : hits.shape(0);
        if (asked && asked->shape(0) != rays)
          throw nb::value_error("found_rows: arrays of equal length expected");
        const Found found{Rows<Double3, Doubles3>(vertices),
                          Rows<Face, Faces>(faces),
                          Rows<Double3, Doubles3>(origins),
                          Rows<Double3, Doubles3>(directions),
                          asked,
                          ends,
                          Rows<Hit, HitArray>(hits),
                          unit,
                          same_place,
                          max_hits};
        return found_rows(context, found, rays);
      },
      nb::arg("context"), nb::arg("vertices").noconvert(), nb::arg("faces").noconvert(),
      nb::arg("origins").noconvert(), nb::arg("directions").noconvert(),
      nb::arg("asked").noconvert().none(), nb::arg("ends").noconvert().none(),
      nb::arg("hits").noconvert(), nb::arg("unit"), nb::arg("same_place"), nb::arg("max_hits"));
}

}  // namespace raysheaf::python
