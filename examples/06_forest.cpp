// A forest by a lake, of ten billion triangles: four kinds of trees in 230 000 places. Rays enter
// the instances where they stand, so no triangle is placed, and the forest takes a few hundred
// megabytes. `example_06_forest forest.png` writes an image, in minutes; without a name, the same
// code draws a small one of 4 000 trees.
#include <raysheaf/io.h>
#include <raysheaf/render.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

using raysheaf::Vec3;

constexpr float kPi = 3.14159265f;

// A public header has no operations on vectors.
Vec3 plus(Vec3 a, Vec3 b, float s = 1) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
Vec3 scaled(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
Vec3 crossed(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
float dotted(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 unit(Vec3 a) {
  return scaled(a, 1 / std::sqrt(std::max(dotted(a, a), 1e-20f)));
}
/// Turned about a unit axis.
Vec3 turned(Vec3 v, Vec3 axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return plus(plus(scaled(v, c), crossed(axis, v), s), axis, dotted(axis, v) * (1 - c));
}
Vec3 across(Vec3 v) {
  return unit(crossed(v, std::fabs(v.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
}

/// The same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint32_t seed) : state_(seed * 747796405u + 2891336453u) {}
  float uniform(float low, float high) {
    state_ = state_ * 747796405u + 2891336453u;
    const std::uint32_t word = ((state_ >> ((state_ >> 28) + 4)) ^ state_) * 277803737u;
    return low + (high - low) * static_cast<float>((word >> 22 ^ word) >> 8) * 0x1p-24f;
  }

 private:
  std::uint32_t state_;
};

void add_triangle(raysheaf::Mesh* mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 normal, Vec3 color) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  const bool is_front = dotted(crossed(plus(b, a, -1), plus(c, a, -1)), normal) > 0;
  for (const Vec3 p : {a, is_front ? b : c, is_front ? c : b}) {
    mesh->positions.push_back(p);
    mesh->normals.push_back(normal);
    mesh->colors.push_back(color);
  }
  mesh->triangles.push_back({first, first + 1, first + 2});
}

/// A branch with four sides.
void add_branch(raysheaf::Mesh* mesh, Vec3 from, Vec3 to, float thick, float thin, Vec3 color) {
  const Vec3 along = unit(plus(to, from, -1)), right = across(along), up = crossed(along, right);
  for (int side = 0; side < 4; ++side) {
    const auto out = [&](int s) {
      const float angle = 0.5f * kPi * static_cast<float>(s);
      return plus(scaled(right, std::cos(angle)), up, std::sin(angle));
    };
    const Vec3 a = out(side), b = out(side + 1), normal = unit(plus(a, b));
    add_triangle(mesh, plus(from, a, thick), plus(from, b, thick), plus(to, a, thin), normal,
                 color);
    add_triangle(mesh, plus(from, b, thick), plus(to, b, thin), plus(to, a, thin), normal, color);
  }
}

/// Two triangles, lit as a part of the crown around `middle`.
void add_leaf(raysheaf::Mesh* mesh, Vec3 at, Vec3 along, float length, Vec3 middle, Vec3 color,
              Random* random) {
  const Vec3 side = turned(across(along), along, random->uniform(0, 2 * kPi));
  const Vec3 wild{random->uniform(-1, 1), random->uniform(-1, 1), random->uniform(-1, 1)};
  const Vec3 normal = unit(plus(unit(plus(at, middle, -1)), wild, 0.7f));
  const Vec3 tone = scaled(color, random->uniform(0.6f, 1.4f)), tip = plus(at, along, length);
  const Vec3 half = plus(at, along, 0.5f * length);
  const Vec3 left = plus(half, side, 0.3f * length), right = plus(half, side, -0.3f * length);
  add_triangle(mesh, at, left, tip, normal, tone);
  add_triangle(mesh, at, tip, right, normal, tone);
}

struct Look {
  Vec3 bark, leaf;
  float spread;  ///< of branches, in radians
};

void grow(raysheaf::Mesh* mesh, Vec3 from, Vec3 along, float length, float thick, int depth,
          const Look& look, Random* random) {
  constexpr int kChildren = 4, kLeaves = 13;
  const Vec3 to = plus(from, along, length);
  add_branch(mesh, from, to, thick, 0.6f * thick, look.bark);
  const Vec3 middle{0, 6, 0};
  for (int i = 0; i < (depth == 0 ? kLeaves : kChildren); ++i) {
    const float angle = 2.4f * static_cast<float>(i) + random->uniform(-0.4f, 0.4f);
    const float lean = look.spread * random->uniform(0.6f, 1.3f);
    const Vec3 way =
        unit(plus(turned(turned(along, across(along), lean), along, angle), Vec3{0, 0.15f, 0}));
    const float place = i == 0 ? 1.0f : random->uniform(depth == 0 ? 0.1f : 0.55f, 1);
    const Vec3 start = plus(from, along, place * length);
    if (depth == 0)
      add_leaf(mesh, start, way, random->uniform(0.22f, 0.38f), middle, look.leaf, random);
    else
      grow(mesh, start, way, length * random->uniform(0.6f, 0.75f), 0.55f * thick, depth - 1, look,
           random);
  }
}

/// About 12 m high.
raysheaf::Mesh broadleaf(const Look& look, std::uint32_t seed) {
  raysheaf::Mesh mesh;
  Random random(seed);
  grow(&mesh, {0, -0.5f, 0}, unit({random.uniform(-0.05f, 0.05f), 1, 0.03f}), 4.2f, 0.24f, 5, look,
       &random);
  return mesh;
}

/// About 17 m high.
raysheaf::Mesh conifer(const Look& look, std::uint32_t seed) {
  raysheaf::Mesh mesh;
  Random random(seed);
  const float height = 17;
  add_branch(&mesh, {0, -0.5f, 0}, {0, height, 0}, 0.24f, 0.02f, look.bark);
  for (float y = 1.5f; y < height - 0.2f; y += random.uniform(0.25f, 0.4f)) {
    const float reach = (0.3f + 2.9f * (1 - y / height)) * random.uniform(0.85f, 1.1f);
    for (int i = 0; i < 9; ++i) {
      const float angle = random.uniform(0, 2 * kPi);
      const Vec3 way = unit({std::cos(angle), random.uniform(-0.45f, -0.15f), std::sin(angle)});
      const Vec3 start{0, y, 0}, middle{0, y - reach, 0};
      add_branch(&mesh, start, plus(start, way, reach), 0.035f, 0.01f, look.bark);
      for (float s = 0.12f * reach; s < reach; s += 0.11f) {
        for (int spray = 0; spray < 4; ++spray) {
          const Vec3 to = unit(plus(turned(across(way), way, random.uniform(0, 2 * kPi)), way));
          add_leaf(&mesh, plus(start, way, s), to, random.uniform(0.14f, 0.32f), middle, look.leaf,
                   &random);
        }
      }
    }
  }
  return mesh;
}

/// Smooth noise between -1 and 1.
float noise(float x, float z) {
  const auto at = [](float i, float j) {
    const auto number = static_cast<std::int32_t>(i) * 7919 + static_cast<std::int32_t>(j) * 104729;
    return Random(static_cast<std::uint32_t>(number)).uniform(-1, 1);
  };
  const float i = std::floor(x), j = std::floor(z);
  const float u = (x - i) * (x - i) * (3 - 2 * (x - i)), v = (z - j) * (z - j) * (3 - 2 * (z - j));
  const float near_row = at(i, j) + u * (at(i + 1, j) - at(i, j));
  const float far_row = at(i, j + 1) + u * (at(i + 1, j + 1) - at(i, j + 1));
  return near_row + v * (far_row - near_row);
}

/// The ground: a lake at height 0, and hills that rise behind it.
float height_at(float x, float z) {
  const float lake = std::hypot((x - 40) / 400, (z - 520) / 230) - 1;
  const float hills = std::clamp((z - 700) / 900, 0.0f, 1.0f) * std::clamp(lake, 0.0f, 1.0f);
  float height = 30 * lake;
  for (float size = 420, rise = 95; size > 20; size *= 0.5f, rise *= 0.45f)
    height +=
        rise * hills * noise(x / size + 13, z / size) + 0.03f * rise * noise(z / size, x / size);
  return height;
}

/// The land's side in metres, so that trees stand about as dense in a grove.
raysheaf::Mesh ground(float side) {
  constexpr int kCells = 384;
  raysheaf::Mesh mesh;
  const float step = side / kCells;
  const auto at = [&](float x, float z) { return Vec3{x, height_at(x, z), z}; };
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const float x = step * (static_cast<float>(i) - kCells / 2.0f);
      const float z = step * static_cast<float>(j) - 100;
      const Vec3 dx = plus(at(x + 1, z), at(x - 1, z), -1),
                 dz = plus(at(x, z + 1), at(x, z - 1), -1);
      mesh.positions.push_back(at(x, z));
      mesh.normals.push_back(unit(crossed(dz, dx)));
      const float dry = 0.5f + 0.5f * noise(x / 17, z / 17);
      const Vec3 grass{0.08f + 0.10f * dry, 0.12f + 0.05f * dry, 0.035f}, sand{0.25f, 0.21f, 0.15f};
      mesh.colors.push_back(at(x, z).y < 0.6f ? sand : grass);
    }
  }
  for (std::uint32_t j = 0; j < kCells; ++j) {
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t a = j * (kCells + 1) + i, b = a + kCells + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

void plant(raysheaf::SceneDescription* scene, std::uint32_t trees, float side) {
  Random random(5);
  const auto rows = static_cast<int>(std::sqrt(static_cast<float>(trees)) * 1.05f);
  const float step = side / static_cast<float>(rows);
  for (int row = 0; row < rows; ++row) {
    for (int place = 0; place < rows; ++place) {
      const float x = step * (static_cast<float>(place) + random.uniform(0, 1)) - side / 2;
      const float z = step * (static_cast<float>(row) + random.uniform(0, 1)) - 100;
      const float y = height_at(x, z), size = random.uniform(0.55f, 1.25f);
      const float angle = random.uniform(0, 2 * kPi), kind = noise(x / 90, z / 90 + 7);
      const float luck = random.uniform(-0.6f, 0.6f), tall = size * random.uniform(0.9f, 1.15f);
      const bool is_in_view = z < 85 && std::fabs(x) < 9 + 0.3f * z + 4 * noise(z / 9, 3);
      if (y < 0.8f || is_in_view) continue;
      raysheaf::Instance tree;
      tree.mesh = kind + luck > 0.05f ? (luck > 0.2f ? 2 : 3) : (luck > -0.2f ? 4 : 5);
      const float c = size * std::cos(angle), s = size * std::sin(angle);
      tree.to_world.m = {{{c, 0, s, x}, {0, tall, 0, y}, {-s, 0, c, z}}};
      scene->instances.push_back(tree);
    }
  }
}

constexpr Vec3 kHorizon{0.72f, 0.80f, 0.88f};

raysheaf::Environment sky() {
  raysheaf::Environment sky;
  sky.width = 1024;
  sky.height = 512;
  for (std::uint32_t row = 0; row < sky.height; ++row) {
    for (std::uint32_t column = 0; column < sky.width; ++column) {
      const float polar = kPi * (static_cast<float>(row) + 0.5f) / 512;
      const float around = kPi * (static_cast<float>(column) + 0.5f) / 512;
      const float up = std::cos(polar), out = std::sin(polar) / (std::max(up, 0.0f) + 0.12f);
      const float blue = std::sqrt(std::max(up, 0.0f));
      Vec3 color = plus(scaled(kHorizon, 1 - blue), {0.10f, 0.26f, 0.62f}, blue);
      float cloud = -0.1f;
      for (float size = 1, part = 0.6f; size < 40; size *= 2.1f, part *= 0.55f)
        cloud += part * noise(size * out * std::sin(around) + 40, size * out * std::cos(around));
      cloud = std::clamp(1.6f * cloud, 0.0f, 0.85f) * std::min(1.0f, 6 * std::max(up, 0.0f));
      color = plus(scaled(color, 1 - cloud), {1.05f, 1.0f, 0.95f}, cloud);
      sky.radiance.push_back(up > 0 ? color : scaled(kHorizon, 0.3f));
    }
  }
  return sky;
}

raysheaf::SceneDescription forest(std::uint32_t trees) {
  using namespace raysheaf;
  SceneDescription scene;
  scene.name = "forest";
  const float side = 6.2f * std::sqrt(static_cast<float>(trees));
  Material matte, water;
  matte.double_sided = true;
  water.base_color = {0.01f, 0.03f, 0.04f, 1};
  water.roughness = 0;
  scene.materials = {matte, water};
  Mesh lake;
  lake.positions = {{-2000, 0, -200}, {2000, 0, -200}, {2000, 0, 1000}, {-2000, 0, 1000}};
  lake.triangles = {{0, 2, 1}, {0, 3, 2}};
  lake.materials = {1};
  const Look spruce{{0.10f, 0.07f, 0.05f}, {0.030f, 0.075f, 0.035f}, 0};
  const Look larch{{0.10f, 0.07f, 0.05f}, {0.075f, 0.115f, 0.030f}, 0};
  const Look oak{{0.12f, 0.09f, 0.07f}, {0.070f, 0.140f, 0.030f}, 0.75f};
  const Look birch{{0.45f, 0.43f, 0.40f}, {0.260f, 0.200f, 0.035f}, 0.55f};
  scene.meshes = {ground(side),       lake,
                  conifer(spruce, 1), conifer(larch, 2),
                  broadleaf(oak, 3),  broadleaf(birch, 4)};
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    if (i != 1) scene.meshes[i].materials = {0};
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  plant(&scene, trees, side);

  Light sun;
  sun.type = Light::Type::kDirectional;
  sun.direction = unit({0.8f, -0.5f, 0.25f});
  sun.intensity = {17, 14.5f, 11};
  scene.lights = {sun};
  scene.environment = sky();
  Camera camera;
  const float c = std::cos(0.14f), s = std::sin(0.14f);  // looks down a little, along +z
  camera.to_world.m = {{{-1, 0, 0, 0}, {0, c, s, height_at(0, 0) + 38}, {0, s, -c, 0}}};
  camera.y_fov = 0.6f;
  scene.cameras = {camera};
  return scene;
}

/// The air between the camera and what it sees. At the skyline the first sample may see the sky
/// where others see trees: there the distance is that of the pixel below.
void add_haze(const raysheaf::Camera& camera, raysheaf::RenderResult* image) {
  const auto& m = camera.to_world.m;
  const Vec3 eye{m[0][3], m[1][3], m[2][3]};
  for (std::size_t i = image->beauty.size(); i-- > 0;) {
    const bool sees_nothing = image->ids[i].inst_id == raysheaf::kInvalidId;
    if (dotted(image->albedo[i], {1, 1, 1}) == 0) continue;
    if (sees_nothing && i + image->width < image->beauty.size())
      image->position[i] = image->position[i + image->width];
    const Vec3 way = plus(image->position[i], eye, -1);
    const float clear = std::exp(-std::sqrt(dotted(way, way)) / 5200);
    image->beauty[i] = plus(scaled(image->beauty[i], clear), kHorizon, 1 - clear);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace raysheaf;
  const bool whole = argc > 1;
  const SceneDescription scene = forest(whole ? 218000 : 4000);
  RenderOptions options;
  options.primary = Primary::kTrace;
  options.width = whole ? 960 : 96;
  options.height = options.width * 9 / 16;
  options.samples = whole ? 16 : 1;
  options.bounces = 1;
  options.exposure = 1;
  RenderResult image = render(scene, options);
  const auto trees = std::count_if(image.ids.begin(), image.ids.end(), [](const PixelIds& ids) {
    return ids.inst_id != kInvalidId && ids.inst_id > 1;
  });
  std::printf("%zu trees, %.2f billion triangles; trees cover %d %% of the image\n",
              scene.instances.size() - 2, 1e-9 * static_cast<double>(scene.triangle_count()),
              static_cast<int>(100 * static_cast<std::size_t>(trees) / image.ids.size()));
  add_haze(scene.cameras[0], &image);
  if (whole) write_png(tone_mapped(image), argv[1]);
}
