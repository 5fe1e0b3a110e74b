#include "parse/light.h"

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

void add_light(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  LightOptions& light = command.light;
  add_value(
      app, "--samples", "N",
      "Rays a pixel, 1 to 65536 [1; 4 of scenes without lights; 16 with an environment or a lens]",
      [&options](const auto& text) { options.samples = parse_count(text, 1, 65536); });
  add_value(app, "--light-size", "R",
            "Radius of the ball that points and spots shine from; 0 is a point [the scene's own]",
            [&light](const auto& text) { light.size = parse_not_negative(text); });
  add_value(app, "--aperture", "D", "Diameter of the lens; 0 is a pinhole [the camera's own]",
            [&options](const auto& text) { options.aperture = parse_not_negative(text); });
  add_value(app, "--focus", "DEPTH",
            "Depth that is sharp [the camera's own, or what the middle of the picture shows]",
            [&options](const auto& text) { options.focus = parse_positive(text); });
  CLI::Option* const environment =
      app.add_option("--env", light.environment,
                     "Light from all around: .hdr or .exr, equirectangular, the top towards +y")
          ->type_name("FILE");
  add_value(app, "--env-intensity", "X", "A factor on its radiance [1]",
            [&light](const auto& text) { light.intensity = parse_not_negative(text); });
  add_value(app, "--env-rotation", "DEGREES", "Turns it about +y, counter-clockwise from above [0]",
            [&light](const auto& text) { light.rotation_degrees = parse_number(text); });
  app.get_option("--env-intensity")->needs(environment);
  app.get_option("--env-rotation")->needs(environment);
}

}  // namespace raysheaf::app
