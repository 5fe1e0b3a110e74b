#include <raysheaf/builtin_scenes.h>
#include <raysheaf/error.h>
#include <raysheaf/io.h>
#include <raysheaf/render.h>
#include <raysheaf/version.h>

#include <iostream>

// Refers to the renderer and to the files, so that a missing private library shows at link time.
int main(int argc, char** argv) try {
  std::cout << "raysheaf " << RAYSHEAF_VERSION << '\n';
  if (argc < 2) return 0;
  const raysheaf::SceneDescription scene = raysheaf::load_scene(argv[1]);
  const raysheaf::RenderResult result = raysheaf::render(scene);
  raysheaf::write_png(raysheaf::tone_mapped(result), "consumer.png");
  return 0;
} catch (const raysheaf::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
