// The extension `raysheaf._core`: the C++ API with numpy arrays of one dtype and layout each. The
// public interface, and everything about dtypes, shapes and broadcasting, is written in Python on
// top of it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>

#include "raysheaf/context.h"
#include "raysheaf/types.h"

namespace raysheaf::python {

namespace nb = nanobind;

using Floats3 = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Indices3 = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Matrix34 = nb::ndarray<const float, nb::shape<3, 4>, nb::c_contig, nb::device::cpu>;
using Matrices34 = nb::ndarray<const float, nb::shape<-1, 3, 4>, nb::c_contig, nb::device::cpu>;
using Ids = nb::ndarray<const std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Doubles3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Rays = nb::ndarray<const float, nb::shape<-1, 8>, nb::c_contig, nb::device::cpu>;

using Column = nb::ndarray<nb::ro, nb::ndim<1>, nb::device::cpu>;
using Columns = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;
using Blocks = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using Blocks3 = nb::ndarray<nb::ro, nb::shape<-1, -1, 3>, nb::device::cpu>;

/// Rays in blocks as four arrays, which it keeps alive. It has hidden visibility because its
/// members, nanobind's types, have it.
class __attribute__((visibility("hidden"))) Parts {
 public:
  Parts() = default;
  Parts(Blocks3 origins, Blocks3 directions, Blocks t_min, Blocks t_max);
  [[nodiscard]] const RayParts& rays() const { return rays_; }

 private:
  Blocks3 origins_, directions_;
  Blocks t_min_, t_max_;
  RayParts rays_{0, {}, {}};
};

/// An array in a device's memory: `count` rows from `pointer` on, and the stream (a cudaStream_t)
/// that writes them.
struct Place {
  void* pointer = nullptr;
  std::size_t count = 0;
  void* stream = nullptr;
};

void bind_errors(nb::module_& module);
void bind_rays(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_copies(nb::module_& module);
void bind_look(nb::module_& module);
void bind_hit_points(nb::module_& module);
void bind_points(nb::module_& module);
void bind_proximity(nb::module_& module);
void bind_render(nb::module_& module);

/// A numpy array over memory that `owner` keeps alive.
template <class Scalar>
nb::object array_over(const void* data, std::initializer_list<std::size_t> shape,
                      nb::handle owner) {
  return nb::ndarray<nb::numpy, Scalar>(const_cast<void*>(data), shape, owner).cast();
}

}  // namespace raysheaf::python
