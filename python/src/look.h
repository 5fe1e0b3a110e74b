// Scene descriptions as dictionaries of numbers, tuples and arrays, and back: what a scene of
// Python's keeps of a file besides its triangles, so that pickles and programs may have it.
#pragma once

#include "core.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::python {

/// Arrays in the dictionary take over the description's memory.
[[nodiscard]] nb::dict dict_of(SceneDescription&& scene);
/// The same keys. Throws nanobind's errors for what is of another kind; not `validate`d.
[[nodiscard]] SceneDescription description_of(const nb::dict& scene);

[[nodiscard]] Camera camera_of(const nb::dict& camera);
[[nodiscard]] Light light_of(const nb::dict& light);

}  // namespace raysheaf::python
