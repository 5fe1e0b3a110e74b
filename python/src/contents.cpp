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

/// A copy of the items, and the array over it.
template <class Scalar, class Item>
nb::object array_of(std::vector<Item>&& items) {
  auto* const kept = new std::vector<Item>(std::move(items));
  const nb::capsule owner(kept,
                          [](void* at) noexcept { delete static_cast<std::vector<Item>*>(at); });
  return array_over<Scalar>(kept->data(), {kept->size(), sizeof(Item) / sizeof(Scalar)}, owner);
}

/// Positions, and triangles or None for a soup.
nb::tuple mesh_arrays(SharedScene& shared, MeshId mesh) {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  const bool soup = shared.look([&](const Scene& scene) {
    const auto vertices = scene.positions(mesh);
    const auto corners = scene.triangles(mesh);
    positions.assign(vertices.begin(), vertices.end());
    triangles.assign(corners.begin(), corners.end());
    return scene.is_soup(mesh);
  });
  nb::object corners = soup ? nb::none() : array_of<std::uint32_t>(std::move(triangles));
  return nb::make_tuple(array_of<float>(std::move(positions)), std::move(corners));
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
