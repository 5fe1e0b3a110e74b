#include "core.h"

#include "raysheaf/paper.h"
#include "raysheaf/version.h"

NB_MODULE(_core, module) {
  using namespace raysheaf::python;
  // Objects that are still referenced when an exception ends the process are no leaks.
  nanobind::set_leak_warnings(false);
  module.doc() = "The compiled part of raysheaf: use `raysheaf` instead.";
  module.attr("version") = RAYSHEAF_VERSION;
  raysheaf::use_paper_methods();
  bind_errors(module);
  bind_scene(module);
  bind_copies(module);
  bind_look(module);
  bind_hit_points(module);
  bind_rays(module);
  bind_points(module);
  bind_proximity(module);
  bind_render(module);
}
