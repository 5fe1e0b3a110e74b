// The nearest of a few faces of a mesh in double precision: for callers whose meshes are float64,
// of which the scene has found the candidates in float32.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core.h"
#include "gil.h"
#include "raysheaf/context.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using Faces = nb::ndarray<const std::int64_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Candidates = nb::ndarray<const std::uint32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using OutPoints = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using OutDistances = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using OutFaces = nb::ndarray<std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using OutSides = nb::ndarray<std::int8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kPointsABlock = 4096;

struct D3 {
  double x, y, z;
};
D3 operator-(D3 a, D3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
D3 along(D3 a, double s, D3 b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double inner(D3 a, D3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
D3 outer(D3 a, D3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The nearest point of one face.
struct OfFace {
  D3 point;
  double squared;
  double facing;  ///< the cosine between the face's normal and the way to the point asked for
  bool in_face;   ///< neither on an edge nor on a corner
};

D3 nearest_on_edge(D3 p, D3 a, D3 b) {
  const D3 h = b - a;
  const double length = inner(h, h);
  const double t = length > 0 ? std::clamp(inner(p - a, h) / length, 0.0, 1.0) : 0.0;
  return t == 1 ? b : along(a, t, h);
}

OfFace nearest_on_face(D3 p, D3 a, D3 b, D3 c) {
  const D3 h = b - a, k = c - a, n = outer(h, k), to = p - a;
  const double nn = inner(n, n);
  OfFace best{a, std::numeric_limits<double>::infinity(), 0, false};
  const auto offer = [&](D3 point, bool in_face) {
    const D3 r = p - point;
    if (inner(r, r) < best.squared) best = {point, inner(r, r), 0, in_face};
  };
  offer(nearest_on_edge(p, a, b), false);
  offer(nearest_on_edge(p, b, c), false);
  offer(nearest_on_edge(p, a, c), false);
  const double u = inner(outer(to, k), n) / nn, v = inner(outer(h, to), n) / nn;
  if (nn > 0 && u > 0 && v > 0 && u + v < 1) offer(along(along(a, u, h), v, k), true);
  best.facing =
      nn > 0 && best.squared > 0 ? inner(p - best.point, n) / std::sqrt(nn * best.squared) : 0;
  return best;
}

/// Selects the nearest of the candidates of each point (`kInvalidId`: none); among those whose
/// squared distances differ by less than `same`, the one that faces the point most, as trimesh
/// does. `side` is 1 before the face, -1 behind it, and 0 where an edge or a corner is nearest.
void nearest_faces(const Context& context, const Doubles3& vertices, const Faces& faces,
                   const Doubles3& points, const Candidates& candidates, double same,
                   const OutPoints& out, const OutDistances& distances, const OutFaces& found,
                   const OutSides& sides) {
  const std::size_t count = points.shape(0), each = candidates.shape(1);
  if (candidates.shape(0) != count || out.shape(0) != count || distances.shape(0) != count ||
      found.shape(0) != count || sides.shape(0) != count)
    throw nb::type_error("nearest_faces: arrays of equal length expected");
  const auto* const corners = reinterpret_cast<const D3*>(vertices.data());
  const std::size_t face_count = faces.shape(0), vertex_count = vertices.shape(0);
  const auto corner = [&](std::uint32_t face, std::size_t k) {
    const auto i = static_cast<std::uint64_t>(faces.data()[3 * std::size_t{face} + k]);
    if (i >= vertex_count) throw nb::index_error("nearest_faces: an index is out of range");
    return corners[i];
  };
  const WithoutGil released;
  context.for_each_block(count, kPointsABlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const D3 p = reinterpret_cast<const D3*>(points.data())[i];
      OfFace best{{}, std::numeric_limits<double>::infinity(), 0, false};
      std::int64_t best_face = -1;
      for (std::size_t c = 0; c < each; ++c) {
        const std::uint32_t face = candidates.data()[i * each + c];
        if (face >= face_count) continue;
        const OfFace one = nearest_on_face(p, corner(face, 0), corner(face, 1), corner(face, 2));
        const bool tie = best_face >= 0 && std::abs(one.squared - best.squared) < same &&
                         one.squared > same && best.squared > same;
        if (tie ? one.facing > best.facing : one.squared < best.squared || best_face < 0) {
          best = one;
          best_face = std::int64_t{face};
        }
      }
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      if (best_face < 0) best = {{kNone, kNone, kNone}, kNone, 0, false};
      reinterpret_cast<D3*>(out.data())[i] = best.point;
      distances.data()[i] = std::sqrt(best.squared);
      found.data()[i] = best_face;
      const int side = best.facing > 0 ? 1 : best.facing < 0 ? -1 : 0;
      sides.data()[i] = static_cast<std::int8_t>(best.in_face ? side : 0);
    }
  });
}

}  // namespace

void bind_proximity(nb::module_& module) {
  module.def("nearest_faces", nearest_faces, nb::arg("context"), nb::arg("vertices").noconvert(),
             nb::arg("faces").noconvert(), nb::arg("points").noconvert(),
             nb::arg("candidates").noconvert(), nb::arg("same"), nb::arg("out").noconvert(),
             nb::arg("distances").noconvert(), nb::arg("found").noconvert(),
             nb::arg("sides").noconvert());
}

}  // namespace raysheaf::python
