// Uses the renderer, the file formats and the ray queries, so that a missing private library shows
// at link time; traces one ray, so that a library that does not load shows at run time.
#include <raysheaf/builtin_scenes.h>
#include <raysheaf/error.h>
#include <raysheaf/io.h>
#include <raysheaf/query.h>
#include <raysheaf/render.h>
#include <raysheaf/verify.h>
#include <raysheaf/version.h>

#include <iostream>
#include <string>

int main(int argc, char** argv) try {
  std::cout << "raysheaf " << RAYSHEAF_VERSION << '\n';
  if (argc > 1) {
    const raysheaf::SceneDescription scene = argv[1] == std::string("cornell")
                                                 ? raysheaf::builtin_scene("cornell")
                                                 : raysheaf::load_scene(argv[1]);
    raysheaf::VerifyOptions options;
    options.rounds = 1;
    if (!raysheaf::verify(options).kept()) return 1;
    raysheaf::write_png(raysheaf::tone_mapped(raysheaf::render(scene)), "consumer.png");
  }
  raysheaf::Scene scene;
  scene.add_soup(std::vector<raysheaf::Vec3>{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  scene.commit();
  const std::vector<raysheaf::Ray> rays{{{0.25f, 0.25f, 0}, 0, {0, 0, 1}}};
  return raysheaf::closest_hit(scene, rays).front().t == 1 ? 0 : 1;
} catch (const raysheaf::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
