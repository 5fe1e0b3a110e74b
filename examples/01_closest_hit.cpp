// Two squares and three rays: the closest hit of each ray.
#include <raysheaf/query.h>

#include <cstdio>
#include <vector>

int main() {
  using namespace raysheaf;

  // A mesh has positions, and triangles that are three indices into the positions each.
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<Vec3> corners_behind{{0, 0, 2}, {9, 0, 2}, {9, 9, 2}, {0, 9, 2}};

  Scene scene;
  scene.add(corners, triangles);         // mesh 0
  scene.add(corners_behind, triangles);  // mesh 1
  scene.commit();                        // now queries see the meshes

  // Origin, t_min, direction; hits lie at origin + t * direction. t_max is infinite by default.
  const std::vector<Ray> rays{
      {{0.25f, 0.5f, -3}, 0, {0, 0, 1}},
      {{4, 2, -3}, 0, {0, 0, 1}},
      {{4, 2, -3}, 0, {0, 0, -1}},
  };
  const std::vector<Hit> hits = closest_hit(scene, rays);

  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    if (hit.prim_id == kInvalidId)
      std::printf("ray %zu: nothing\n", i);
    else
      std::printf("ray %zu: t = %g, triangle %u of mesh %u\n", i, hit.t, hit.prim_id, hit.geom_id);
  }
}
