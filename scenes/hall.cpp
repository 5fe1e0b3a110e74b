// A closed hall with columns and spheres and any requested number of triangles: the shapes are the
// same, tessellated more finely. As in real scenes, larger numbers add detail.
//
//      +--------------------------------+
//      |  o    o    o    o    o    o    |     o  columns, in two rows
//      |     (  )      (  )    (  )     |   ( )  spheres on the floor and in the air
//      |  o    o    o    o    o    o    |
//      +--------------------------------+
#include <cmath>
#include <string>
#include <vector>

#include "base/vec.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "scenes/builder.h"
#include "scenes/hall_patch.h"
#include "scenes/hall_tiles.h"

namespace raysheaf {
namespace {

using builtin::HallPatch;

constexpr float kHallLength = 40, kHallWidth = 20,
                kHallHeight = 10;  ///< metres; the origin is on the floor
constexpr int kColumnsARow = 8, kBalls = 24;
constexpr std::uint64_t kFewest = 4000, kMost = 200'000'000, kMostInBlocks = 2'000'000'000;

void add_walls(std::vector<HallPatch>& patches) {
  const float x = kHallLength / 2, z = kHallWidth / 2;
  const Vec3 along{kHallLength, 0, 0}, across{0, 0, kHallWidth}, up{0, kHallHeight, 0};
  const auto wall = [&](const char* name, Vec3 origin, Vec3 a, Vec3 b) {
    patches.push_back({HallPatch::Shape::kWall, origin, a, b, 0.35f, name});
  };
  wall("floor", {-x, 0, z}, along, across * -1.0f);
  wall("ceiling", {-x, kHallHeight, -z}, along, across);
  wall("north", {-x, 0, -z}, along, up);
  wall("south", {x, 0, z}, along * -1.0f, up);
  wall("east", {x, 0, -z}, across, up);
  wall("west", {-x, 0, z}, across * -1.0f, up);
}

void add_columns(std::vector<HallPatch>& patches) {
  for (int side = -1; side <= 1; side += 2) {
    for (int i = 0; i < kColumnsARow; ++i) {
      const float step = kHallLength / kColumnsARow;
      const Vec3 foot{-kHallLength / 2 + (static_cast<float>(i) + 0.5f) * step, 0,
                      static_cast<float>(side) * 0.3f * kHallWidth};
      patches.push_back(
          {HallPatch::Shape::kColumn, foot, {0.6f, 0, 0}, {0, kHallHeight, 0}, 0.3f, "column"});
    }
  }
}

void add_balls(std::vector<HallPatch>& patches) {
  builtin::Random random(10);
  for (int i = 0; i < kBalls; ++i) {
    const float radius = random.uniform(0.4f, 1.1f);
    const float x = random.uniform(-0.42f, 0.36f) * kHallLength;
    const float z = random.uniform(-0.22f, 0.22f) * kHallWidth;
    const float y = i % 3 == 0 ? random.uniform(2, 0.7f * kHallHeight) : radius;
    patches.push_back({HallPatch::Shape::kBall, {x, y, z}, {radius, 0, 0}, {}, 0.4f, "ball"});
  }
}

std::uint64_t triangles_at(const std::vector<HallPatch>& patches, float cells_a_metre) {
  std::uint64_t sum = 0;
  for (const HallPatch& p : patches) sum += triangle_count(p, grid_of(p, cells_a_metre));
  return sum;
}

/// The finest tessellation with at most `triangles`, found by bisection.
float cells_a_metre(const std::vector<HallPatch>& patches, std::uint64_t triangles) {
  float low = 0.01f, high = 1000;
  for (int i = 0; i < 40; ++i) {
    const float middle = std::sqrt(low * high);
    (triangles_at(patches, middle) <= triangles ? low : high) = middle;
  }
  return low;
}

void furnish(SceneDescription& scene) {
  Light lamp;
  lamp.name = "lamp";
  lamp.position = {1.5f, 0.75f * kHallHeight, 0.4f};
  lamp.intensity = {600, 580, 540};
  scene.lights.push_back(lamp);
  Camera camera;
  camera.name = "from the east";
  camera.to_world =
      look_at({0.44f * kHallLength, 0.4f * kHallHeight, 1.2f}, {-4, 2.6f, -0.6f}, {0, 1, 0});
  camera.z_near = 0.02f;
  scene.cameras.push_back(camera);
}

void check_count(std::uint64_t triangles, std::uint64_t most) {
  if (triangles < kFewest || triangles > most)
    throw Error(ErrorCode::kInvalidArgument,
                "a hall has from " + std::to_string(kFewest) + " to " + std::to_string(most) +
                    " triangles, not " + std::to_string(triangles),
                "triangles");
}

std::vector<HallPatch> patches_of_hall() {
  std::vector<HallPatch> patches;
  add_walls(patches);
  add_columns(patches);
  add_balls(patches);
  return patches;
}

/// Everything except meshes and instances.
SceneDescription furnished_hall() {
  SceneDescription scene;
  scene.name = "hall";
  scene.materials.push_back(builtin::matte("plaster", 0xd8d0c4));
  furnish(scene);
  return scene;
}

}  // namespace

SceneDescription hall_scene(std::uint64_t triangles, std::uint32_t threads) {
  check_count(triangles, kMost);
  const std::vector<HallPatch> patches = patches_of_hall();
  const float cells = cells_a_metre(patches, triangles);
  const Executor executor(threads);
  SceneDescription scene = furnished_hall();
  for (const HallPatch& patch : patches) {
    const auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(hall_mesh(executor, patch, grid_of(patch, cells)));
    scene.instances.push_back({patch.name, mesh, {}});
  }
  return scene;
}

SceneDescription hall_in_blocks(std::uint64_t triangles, BlockSink* sink, std::uint32_t threads) {
  check_count(triangles, kMostInBlocks);
  const std::vector<HallPatch> patches = patches_of_hall();
  const float cells = cells_a_metre(patches, triangles);
  const Executor executor(threads);
  SceneDescription scene = furnished_hall();
  for (const HallPatch& patch : patches) {
    const auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.emplace_back().name = patch.name;
    scene.instances.push_back({patch.name, mesh, {}});
    hall_tiles(executor, patch, grid_of(patch, cells), mesh, sink);
  }
  return scene;
}

}  // namespace raysheaf
