// Origins, directions and intervals of any strides, float32 or float64, packed into rays.
#include <algorithm>
#include <array>

#include "core.h"
#include "raysheaf/types.h"

namespace raysheaf::python {
namespace {

using Column = nb::ndarray<nb::ro, nb::ndim<1>, nb::device::cpu>;
using Columns = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;
using WritableRays = nb::ndarray<float, nb::shape<-1, 8>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kFloatsPerRay = 8;
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

void pack_rays(const Columns& origins, const Columns& directions, const Column& t_min,
               const Column& t_max, const WritableRays& out) {
  constexpr std::size_t kStep = 2048;  // rays that stay in the first cache while parts are added
  const std::size_t count = out.shape(0);
  const std::array parts{part_of(origins, count, 0), part_of(t_min, count, 3),
                         part_of(directions, count, 4), part_of(t_max, count, 7)};
  float* const rays = out.data();
  const nb::gil_scoped_release release;
  for (std::size_t begin = 0; begin < count; begin += kStep) {
    const std::size_t end = std::min(count, begin + kStep);
    for (const Part& part : parts) {
      if (part.is_double)
        copy<double>(part, begin, end, rays);
      else
        copy<float>(part, begin, end, rays);
    }
  }
}

}  // namespace

void bind_rays(nb::module_& module) {
  module.def("pack_rays", pack_rays, nb::arg("origins").noconvert(),
             nb::arg("directions").noconvert(), nb::arg("t_min").noconvert(),
             nb::arg("t_max").noconvert(), nb::arg("out").noconvert());
}

}  // namespace raysheaf::python
