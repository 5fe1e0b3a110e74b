// `_core.render`: a scene file or a built-in scene in, arrays of pixels out.
#include "raysheaf/render.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <optional>
#include <string>

#include "core.h"
#include "interrupt.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"

namespace raysheaf::python {
namespace {

SceneDescription scene_named(const std::string& name, const std::string& environment) {
  const std::string prefix = "builtin:";
  SceneDescription scene =
      name.starts_with(prefix) ? builtin_scene(name.substr(prefix.size())) : load_scene(name);
  if (!environment.empty()) scene.environment = load_environment(environment);
  add_missing_camera_and_light(scene);
  return scene;
}

struct Rendered {
  RenderResult result;
  Image picture;
};

nb::dict arrays_of(Rendered* rendered) {
  const nb::capsule owner(rendered, [](void* at) noexcept { delete static_cast<Rendered*>(at); });
  const RenderResult& result = rendered->result;
  const std::size_t height = result.height, width = result.width;
  nb::dict arrays;
  arrays["rgba"] =
      array_over<std::uint8_t>(rendered->picture.rgba.data(), {height, width, 4}, owner);
  arrays["beauty"] = array_over<float>(result.beauty.data(), {height, width, 3}, owner);
  arrays["position"] = array_over<float>(result.position.data(), {height, width, 3}, owner);
  arrays["normal"] = array_over<float>(result.normal.data(), {height, width, 3}, owner);
  arrays["albedo"] = array_over<float>(result.albedo.data(), {height, width, 3}, owner);
  arrays["shadow"] = array_over<float>(result.shadow.data(), {height, width}, owner);
  arrays["ids"] = array_over<std::uint32_t>(result.ids.data(), {height, width, 3}, owner);
  arrays["exposure"] = result.exposure;
  return arrays;
}

nb::dict render_scene(const std::string& scene, std::uint32_t width, std::uint32_t height,
                      const std::string& camera, const std::string& method, bool raster,
                      std::uint32_t bounces, std::uint32_t threads,
                      const std::optional<float>& exposure, std::uint32_t samples,
                      const std::optional<float>& aperture, const std::optional<float>& focus,
                      const std::string& environment) {
  auto rendered = std::make_unique<Rendered>();
  interruptible([&](const std::atomic<bool>& stop) {
    RenderOptions options;
    options.width = width;
    options.height = height;
    options.camera = camera;
    options.method = method_from_string(method);
    options.primary = raster ? Primary::kRaster : Primary::kTrace;
    options.bounces = bounces;
    options.threads = threads;
    options.exposure = exposure;
    options.samples = samples;
    options.aperture = aperture;
    options.focus = focus;
    options.progress = [&](const Progress&) { return !stop; };
    rendered->result = render(scene_named(scene, environment), options);
    rendered->picture = tone_mapped(rendered->result);
  });
  return arrays_of(rendered.release());
}

}  // namespace

void bind_render(nb::module_& module) {
  module.def("render", render_scene, nb::arg("scene"), nb::arg("width"), nb::arg("height"),
             nb::arg("camera"), nb::arg("method"), nb::arg("raster"), nb::arg("bounces"),
             nb::arg("threads"), nb::arg("exposure").none(), nb::arg("samples"),
             nb::arg("aperture").none(), nb::arg("focus").none(), nb::arg("environment"));
}

}  // namespace raysheaf::python
