#include "parse/light.h"

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

void add_samples(CLI::App& app, RenderCommand& command) {
  begin_group(app, kCommonGroup);
  add_value(
      app, "--samples", "N",
      "Samples per pixel, 1 to 65536 [1; 4 for a scene without lights; 16 with an "
      "environment or a lens]",
      [&command](const auto& text) { command.options.samples = parse_count(text, 1, 65536); });
}

void add_lens(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  begin_group(app, kCameraGroup);
  add_value(app, "--aperture", "D", "Diameter of the lens; 0 is a pinhole [the camera's own]",
            [&options](const auto& text) { options.aperture = parse_not_negative(text); });
  add_value(app, "--focus", "DEPTH",
            "Depth that is in focus [the camera's own, or the depth at the middle of the image]",
            [&options](const auto& text) { options.focus = parse_positive(text); });
}

void add_light(CLI::App& app, RenderCommand& command) {
  LightOptions& light = command.light;
  begin_group(app, kLightGroup);
  add_value(app, "--light-size", "R",
            "Radius of the spheres that point and spot lights shine from; 0 is a point [the "
            "scene's own]",
            [&light](const auto& text) { light.size = parse_not_negative(text); });
  CLI::Option* const environment =
      app.add_option(
             "--env", light.environment,
             "Environment that lights the scene: .hdr or .exr, equirectangular, its top at +y")
          ->type_name("FILE");
  add_value(app, "--env-intensity", "X", "Factor on the radiance of the environment [1]",
            [&light](const auto& text) { light.intensity = parse_not_negative(text); });
  add_value(app, "--env-rotation", "DEGREES",
            "Rotation of the environment about +y, counter-clockwise from above [0]",
            [&light](const auto& text) { light.rotation_degrees = parse_number(text); });
  app.get_option("--env-intensity")->needs(environment);
  app.get_option("--env-rotation")->needs(environment);
}

}  // namespace raysheaf::app
