// The arrays of a scene, and its ids given again: for copies and pickles.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core.h"
#include "gil.h"
#include "shared_scene.h"

namespace raysheaf::python {
namespace {

/// A copy of the items, of shape (..., 3), and the array over it.
template <class Scalar, class Item>
nb::object array_of(std::vector<Item>&& items, std::initializer_list<std::size_t> shape) {
  auto* const kept = new std::vector<Item>(std::move(items));
  const nb::capsule owner(kept,
                          [](void* at) noexcept { delete static_cast<std::vector<Item>*>(at); });
  return array_over<Scalar>(kept->data(), shape, owner);
}

/// Positions of shape (times, n, 3), and triangles or None for a soup.
nb::tuple mesh_arrays(SharedScene& shared, MeshId mesh) {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::size_t times = 0;
  const bool soup = shared.look([&](const Scene& scene) {
    times = scene.time_count(mesh);
    for (std::size_t k = 0; k < times; ++k) {
      const auto vertices = scene.positions(mesh, k);
      positions.insert(positions.end(), vertices.begin(), vertices.end());
    }
    const auto corners = scene.triangles(mesh);
    triangles.assign(corners.begin(), corners.end());
    return scene.is_soup(mesh);
  });
  const std::size_t each = positions.size() / times, count = triangles.size();
  nb::object corners =
      soup ? nb::none() : array_of<std::uint32_t>(std::move(triangles), {count, 3});
  return nb::make_tuple(array_of<float>(std::move(positions), {times, each, 3}),
                        std::move(corners));
}

nb::object positions_at(SharedScene& shared, MeshId mesh, float time) {
  std::vector<Vec3> positions =
      shared.look([&](const Scene& scene) { return scene.positions_at(mesh, time); });
  const std::size_t count = positions.size();
  return array_of<float>(std::move(positions), {count, 3});
}

SharedScene* copy_scene(SharedScene& shared) {
  return shared.look([](const Scene& scene) { return std::make_unique<SharedScene>(scene.copy()); })
      .release();
}

std::pair<MeshId, InstanceId> next_ids(SharedScene& shared) {
  return shared.look(
      [](const Scene& scene) { return std::pair(scene.next_mesh(), scene.next_instance()); });
}

}  // namespace

void bind_copies(nb::module_& module) {
  module.def("mesh_arrays", mesh_arrays, nb::arg("scene"), nb::arg("mesh"));
  module.def("positions_at", positions_at, nb::arg("scene"), nb::arg("mesh"), nb::arg("time"));
  module.def("copy_scene", copy_scene, nb::arg("scene"), nb::rv_policy::take_ownership);
  module.def("next_ids", next_ids, nb::arg("scene"));
  module.def(
      "continue_ids",
      [](SharedScene& shared, MeshId mesh, InstanceId instance) {
        shared.change([&](Scene& scene) { scene.continue_ids(mesh, instance); });
      },
      nb::arg("scene"), nb::arg("next_mesh"), nb::arg("next_instance"));
}

}  // namespace raysheaf::python
