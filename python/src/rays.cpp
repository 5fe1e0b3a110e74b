// Reads rays from numpy arrays: origins, directions and intervals of any strides, in float32 or
// float64.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include <nanobind/stl/array.h>

#include "core.h"
#include "gil.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using WritableRays = nb::ndarray<float, nb::shape<-1, 8>, nb::c_contig, nb::device::cpu>;

using WritableFlags = nb::ndarray<bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kFloatsPerRay = 8, kRaysABlock = 16384;
static_assert(sizeof(Ray) == kFloatsPerRay * sizeof(float));

/// One row of three numbers, or one number, per ray.
template <class Array>
NumberRows rows_of(const Array& array, const Blocks3& origins) {
  NumberRows rows;
  rows.data = array.data();
  rows.is_double = array.dtype() == nb::dtype<double>();
  if (!rows.is_double && array.dtype() != nb::dtype<float>())
    throw nb::type_error("Parts: float32 or float64 expected");
  if (array.shape(0) != origins.shape(0) || array.shape(1) != origins.shape(1))
    throw nb::type_error("Parts: arrays of equal length expected");
  rows.block_stride = array.stride(0);
  rows.row_stride = array.stride(1);
  rows.column_stride = array.ndim() == 2 ? 1 : array.stride(2);
  return rows;
}

/// The scene's space: (point - origin) * scale. Rays may begin at most `reach` from `middle` in the
/// scene, and directions may have lengths from `shortest` to `longest`.
struct Frame {
  std::array<double, 3> origin, middle;
  double scale, reach, shortest, longest;
};

/// Transforms a ray into the frame. Returns whether float32 keeps its digits there: it begins near
/// the middle, or nothing is rounded.
bool pack_ray(const Frame& frame, const double* origin, const double* direction, float* out) {
  bool near = true, exact = true;
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double start = (origin[k] - frame.origin[k]) * frame.scale;
    near = near && std::abs(start - frame.middle[k]) <= frame.reach;
    squares += direction[k] * direction[k];
    out[k] = static_cast<float>(start);
    exact = exact && std::isfinite(out[k]) && static_cast<double>(out[k]) == start;
    out[4 + k] = static_cast<float>(direction[k]);
  }
  out[3] = 0;
  out[7] = std::numeric_limits<float>::infinity();
  const double length = std::sqrt(squares);
  return (near || exact) && length > frame.shortest && length < frame.longest;
}

/// Sets good[i] to whether float32 keeps the digits of ray i in the frame; for the other rays,
/// `out` is unspecified. Returns whether all are good. The result for a ray does not depend on
/// other rays.
bool pack_rays_in_frame(const Context& context, const Doubles3& origins, const Doubles3& directions,
                        const Frame& frame, const WritableRays& out, const WritableFlags& good) {
  const std::size_t count = out.shape(0);
  if (origins.shape(0) != count || directions.shape(0) != count || good.shape(0) != count)
    throw nb::type_error("pack_rays_in_frame: arrays of equal length expected");
  std::atomic<bool> all_good = true;
  const WithoutGil released;
  context.for_each_block(count, kRaysABlock, [&](std::size_t begin, std::size_t end) {
    bool all = true;
    for (std::size_t i = begin; i < end; ++i) {
      const bool one = pack_ray(frame, origins.data() + 3 * i, directions.data() + 3 * i,
                                out.data() + kFloatsPerRay * i);
      good.data()[i] = one;
      all = all && one;
    }
    if (!all) all_good = false;
  });
  return all_good;
}

}  // namespace

Parts::Parts(Blocks3 origins, Blocks3 directions, Blocks t_min, Blocks t_max)
    : origins_(std::move(origins)),
      directions_(std::move(directions)),
      t_min_(std::move(t_min)),
      t_max_(std::move(t_max)) {
  rays_ = {origins_.shape(0) * origins_.shape(1), rows_of(origins_, origins_),
           rows_of(directions_, origins_), rows_of(t_min_, origins_), rows_of(t_max_, origins_)};
  if (origins_.shape(0) > 1) rays_.block = origins_.shape(1);
}

void bind_rays(nb::module_& module) {
  nb::class_<Parts>(module, "Parts")
      .def(nb::init<Blocks3, Blocks3, Blocks, Blocks>(), nb::arg("origins").noconvert(),
           nb::arg("directions").noconvert(), nb::arg("t_min").noconvert(),
           nb::arg("t_max").noconvert());
  nb::class_<Frame>(module, "Frame")
      .def(
          "__init__",
          [](Frame* frame, const std::array<double, 3>& origin, const std::array<double, 3>& middle,
             double scale, double reach, double shortest, double longest) {
            new (frame) Frame{origin, middle, scale, reach, shortest, longest};
          },
          nb::arg("origin"), nb::arg("middle"), nb::arg("scale"), nb::arg("reach"),
          nb::arg("shortest"), nb::arg("longest"));
  module.def("pack_rays_in_frame", pack_rays_in_frame, nb::arg("context"),
             nb::arg("origins").noconvert(), nb::arg("directions").noconvert(), nb::arg("frame"),
             nb::arg("out").noconvert(), nb::arg("good").noconvert());
}

}  // namespace raysheaf::python
