// Origins, directions and intervals of any strides, float32 or float64, packed into rays.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include <nanobind/stl/array.h>

#include "core.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using Column = nb::ndarray<nb::ro, nb::ndim<1>, nb::device::cpu>;
using Columns = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;
using WritableRays = nb::ndarray<float, nb::shape<-1, 8>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kFloatsPerRay = 8, kRaysABlock = 16384;
static_assert(sizeof(Ray) == kFloatsPerRay * sizeof(float));

/// One part of the rays: `width` numbers a ray, which come to stand at `place` of its eight.
struct Part {
  const void* data;
  bool is_double;
  std::int64_t row_stride, column_stride;  // in elements; may be 0 or negative
  std::size_t width, place;
};

template <class Array>
Part part_of(const Array& array, std::size_t count, std::size_t place) {
  const bool is_double = array.dtype() == nb::dtype<double>();
  if (!is_double && array.dtype() != nb::dtype<float>())
    throw nb::type_error("pack_rays: float32 or float64 expected");
  if (array.shape(0) != count) throw nb::type_error("pack_rays: arrays of equal length expected");
  const bool is_column = array.ndim() == 1;
  return {array.data(),
          is_double,
          array.stride(0),
          is_column ? 0 : array.stride(1),
          is_column ? std::size_t{1} : std::size_t{3},
          place};
}

/// `kColumnStride` is the part's where it is known, else 0.
template <class Scalar, std::size_t kWidth, std::int64_t kColumnStride>
void copy(const Part& part, std::size_t begin, std::size_t end, float* out) {
  const auto* data = static_cast<const Scalar*>(part.data);
  const std::int64_t row_stride = part.row_stride;
  const std::int64_t column_stride = kColumnStride != 0 ? kColumnStride : part.column_stride;
  for (std::size_t i = begin; i < end; ++i) {
    const Scalar* from = data + static_cast<std::int64_t>(i) * row_stride;
    float* to = out + i * kFloatsPerRay + part.place;
    for (std::size_t k = 0; k < kWidth; ++k)
      to[k] = static_cast<float>(from[static_cast<std::int64_t>(k) * column_stride]);
  }
}

template <class Scalar>
void copy(const Part& part, std::size_t begin, std::size_t end, float* out) {
  if (part.width == 1) return copy<Scalar, 1, 0>(part, begin, end, out);
  if (part.column_stride == 1) return copy<Scalar, 3, 1>(part, begin, end, out);
  copy<Scalar, 3, 0>(part, begin, end, out);
}

void pack_rays(const Context& context, const Columns& origins, const Columns& directions,
               const Column& t_min, const Column& t_max, const WritableRays& out) {
  constexpr std::size_t kStep = 2048;  // rays that stay in the first cache while parts are added
  const std::size_t count = out.shape(0);
  const std::array parts{part_of(origins, count, 0), part_of(t_min, count, 3),
                         part_of(directions, count, 4), part_of(t_max, count, 7)};
  float* const rays = out.data();
  const nb::gil_scoped_release release;
  context.for_each_block(count, kRaysABlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += kStep) {
      const std::size_t end = std::min(last, begin + kStep);
      for (const Part& part : parts) {
        if (part.is_double)
          copy<double>(part, begin, end, rays);
        else
          copy<float>(part, begin, end, rays);
      }
    }
  });
}

/// Where a scene has what lies about `origin`: (point - origin) * scale. `reach`: how far from
/// `middle`, in the scene, rays may begin; `shortest` to `longest`: what directions may be.
struct Frame {
  std::array<double, 3> origin, middle;
  double scale, reach, shortest, longest;
};

/// Moves one ray into the frame; whether float32 keeps its digits there.
bool pack_ray(const Frame& frame, const double* origin, const double* direction, float* out) {
  bool good = true;
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double start = (origin[k] - frame.origin[k]) * frame.scale;
    good = good && std::abs(start - frame.middle[k]) <= frame.reach;
    squares += direction[k] * direction[k];
    out[k] = static_cast<float>(start);
    out[4 + k] = static_cast<float>(direction[k]);
  }
  out[3] = 0;
  out[7] = std::numeric_limits<float>::infinity();
  const double length = std::sqrt(squares);
  return good && length > frame.shortest && length < frame.longest;
}

/// Whether float32 keeps the digits of all rays in the frame; if not, `out` means nothing.
bool pack_rays_in_frame(const Context& context, const Doubles3& origins, const Doubles3& directions,
                        const Frame& frame, const WritableRays& out) {
  const std::size_t count = out.shape(0);
  if (origins.shape(0) != count || directions.shape(0) != count)
    throw nb::type_error("pack_rays_in_frame: arrays of equal length expected");
  std::atomic<bool> good = true;
  const nb::gil_scoped_release release;
  context.for_each_block(count, kRaysABlock, [&](std::size_t begin, std::size_t end) {
    bool all = true;
    for (std::size_t i = begin; i < end; ++i) {
      const bool one = pack_ray(frame, origins.data() + 3 * i, directions.data() + 3 * i,
                                out.data() + kFloatsPerRay * i);
      all = all && one;
    }
    if (!all) good = false;
  });
  return good;
}

}  // namespace

void bind_rays(nb::module_& module) {
  module.def("pack_rays", pack_rays, nb::arg("context"), nb::arg("origins").noconvert(),
             nb::arg("directions").noconvert(), nb::arg("t_min").noconvert(),
             nb::arg("t_max").noconvert(), nb::arg("out").noconvert());
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
             nb::arg("out").noconvert());
}

}  // namespace raysheaf::python
