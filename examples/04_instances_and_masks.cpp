// One mesh in several places, some of which only some queries see.
#include <raysheaf/query.h>

#include <cstdio>
#include <vector>

namespace {

// The meaning of each mask bit is up to the program.
constexpr std::uint32_t kSolid = 1, kGlass = 2;

raysheaf::Affine moved_to(float z) {
  raysheaf::Affine a;  // the identity
  a.m[2][3] = z;
  return a;
}

}  // namespace

int main() {
  using namespace raysheaf;
  const std::vector<Vec3> corners{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};

  Scene scene;
  MeshOptions wall;
  wall.transform = moved_to(10);
  wall.mask = kSolid;
  const MeshId square = scene.add(corners, triangles, wall);  // instance 0, the mesh's first
  scene.instance(square, moved_to(6), kGlass);                // instance 1
  const InstanceId pane = scene.instance(square, moved_to(3), kGlass);
  scene.commit();

  const std::vector<Ray> ray{{{0.5f, 0.25f, 0}, 0, {0, 0, 1}}};
  const auto first = [&](std::uint32_t mask) {
    return closest_hit(scene, ray, QueryOptions{.mask = mask}).front();
  };
  std::printf("camera sees the glass of instance %u\n", first(kSolid | kGlass).inst_id);
  std::printf("light sees the wall of instance %u\n", first(kSolid).inst_id);

  // Moving an instance does not change its mesh.
  scene.set_transform(pane, moved_to(8));
  scene.commit();
  if (first(kSolid | kGlass).t == 6) std::printf("moved: 1 commit, nothing rebuilt by hand\n");
}
