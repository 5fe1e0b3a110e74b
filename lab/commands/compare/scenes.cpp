#include "lab/commands/compare/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <string_view>

#include "apps/support/scene_argument.h"
#include "apps/support/values.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBuiltin = "builtin:", kHall = "hall:";
constexpr std::uint64_t kLargestHall = 10'000'000;
constexpr std::uint64_t kBytesForLargestHall = 12ull << 30;

/// Camera positions for files without a camera; without a field of view the scene's own camera and
/// light are used.
struct Place {
  Vec3 eye, target, light;
  float y_fov_degrees = 0;
};

struct Known {
  std::string_view name, file;
  Place place;
};

constexpr std::array<Known, 11> kKnown = {{
    {"office", "paper/office.glb", {}},
    {"cornell", "paper/cornell.glb", {}},
    {"sponza", "paper/sponza.glb", {}},
    {"sibenik", "sibenik/sibenik.obj", {{-16, -9, 0}, {0, -10, 0}, {-2, 2, 0}, 60}},
    {"bart_kitchen",
     "bart_kitchen/static.obj",
     {{4.5f, 1.3f, 3}, {-1, 0, -1.5f}, {1.6f, 2.2f, 0.4f}, 60}},
    {"bitterli_coffee",
     "bitterli_coffee/coffee.glb",
     {{-0.00296f, 0.198303f, 0.828151f}, {0.0043f, 0.159f, -0.171f}, {0.25f, 0.5f, 0.6f}, 25}},
    {"bitterli_teapot_full",
     "bitterli_teapot_full/teapot-full.glb",
     {{23.17f, 15.71f, -0.17f}, {-0.5f, 2.5f, -0.05f}, {14, 24, 10}, 20}},
    {"dragon", "standard_meshes/dragon_res2.ply", {}},
    {"bunny", "standard_meshes/bun_zipper.ply", {}},
    {"armadillo", "standard_meshes/armadillo_86k.obj", {}},
    {"cloth_ball", "cloth_ball/cloth_ball92.ply", {}},
}};

Vec3 minus(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

Vec3 crossed(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vec3 of_unit_length(Vec3 v) {
  const float length = std::hypot(v.x, v.y, v.z);
  return {v.x / length, v.y / length, v.z / length};
}

/// +y is up.
Camera camera_at(const Place& place) {
  const Vec3 z = of_unit_length(minus(place.eye, place.target));
  const Vec3 x = of_unit_length(crossed({0, 1, 0}, z)), y = crossed(z, x);
  Camera camera;
  camera.to_world.m = {
      {{x.x, y.x, z.x, place.eye.x}, {x.y, y.y, z.y, place.eye.y}, {x.z, y.z, z.z, place.eye.z}}};
  camera.y_fov = place.y_fov_degrees * 0.0174532925f;
  camera.z_near = 0.001f;
  return camera;
}

/// From the front, the right and above. Rays that miss everything are not worth comparing, so a
/// sphere around the box is slightly larger than the image.
void fill_picture(SceneDescription& scene) {
  if (!scene.cameras.empty()) return;
  const Box box = world_bounds(scene);
  const Vec3 center{(box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2,
                    (box.min.z + box.max.z) / 2};
  const Vec3 half = minus(box.max, center), way = of_unit_length({0.6f, 0.45f, 1});
  const float distance = 2.2f * std::hypot(half.x, half.y, half.z);
  Place place;
  place.eye = {center.x + way.x * distance, center.y + way.y * distance,
               center.z + way.z * distance};
  place.target = center;
  place.y_fov_degrees = 36;
  scene.cameras.push_back(camera_at(place));
}

void stand_at(const Place& place, SceneDescription& scene) {
  if (place.y_fov_degrees == 0) return fill_picture(scene);
  scene.cameras = {camera_at(place)};
  Light light;
  light.position = place.light;
  scene.lights = {light};
}

/// "1000000", "1m", "300k".
std::uint64_t triangles_of_hall(const std::string& text) {
  std::string digits = text;
  std::uint64_t factor = 1;
  if (digits.ends_with('k')) factor = 1000;
  if (digits.ends_with('m')) factor = 1'000'000;
  if (factor > 1) digits.pop_back();
  return factor * parse_count(digits, 1, 1'000'000'000);
}

/// The number of triangles in a name that `hall_name` writes; empty for other names, such as a file
/// hall_x.obj.
std::string triangles_in_hall_name(const std::string& name) {
  std::smatch parts;
  return std::regex_match(name, parts, std::regex("hall_([0-9]+[km]?)")) ? parts[1].str() : "";
}

/// "hall_1m"
std::string hall_name(std::uint64_t triangles) {
  if (triangles % 1'000'000 == 0) return fmt::format("hall_{}m", triangles / 1'000'000);
  if (triangles % 1000 == 0) return fmt::format("hall_{}k", triangles / 1000);
  return fmt::format("hall_{}", triangles);
}

CompareScene hall(std::uint64_t triangles) {
  return {hall_name(triangles), fmt::format("{}{}", kHall, triangles)};
}

CompareScene asked_hall(const std::string& triangles) {
  try {
    return hall(triangles_of_hall(triangles));
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), "--scene");
  }
}

void add_halls(std::vector<CompareScene>& all, std::vector<std::string>* notes) {
  all.push_back(hall(1'000'000));
  if (system::memory_bytes() >= kBytesForLargestHall) {
    all.push_back(hall(kLargestHall));
  } else {
    notes->push_back(fmt::format(
        "{} is omitted: it needs {} GiB of memory; give `--scene hall_10m` to include it",
        hall_name(kLargestHall), kBytesForLargestHall >> 30));
  }
}

const Known* known_scene(const std::string& name) {
  const auto* found =
      std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return k.name == name; });
  return found == kKnown.end() ? nullptr : &*found;
}

}  // namespace

std::vector<CompareScene> default_compare_scenes(const std::string& scenes,
                                                 std::vector<std::string>* notes) {
  std::vector<CompareScene> all;
  if (scenes.empty()) {
    for (const std::string& name : builtin_scene_names())
      all.push_back({name, std::string(kBuiltin) + name});
  } else {
    for (const Known& known : kKnown) {
      const std::string path = (fs::path(scenes) / known.file).string();
      if (fs::exists(path)) all.push_back({std::string(known.name), path});
    }
    if (all.empty())
      throw Error(ErrorCode::kIo, "this folder contains none of the known scenes", scenes);
  }
  add_halls(all, notes);
  return all;
}

CompareScene compare_scene_from_string(const std::string& name, const std::string& scenes) {
  if (name.starts_with(kBuiltin)) return {name.substr(kBuiltin.size()), name};
  if (name.starts_with(kHall)) return asked_hall(name.substr(kHall.size()));
  if (const std::string triangles = triangles_in_hall_name(name); !triangles.empty())
    return asked_hall(triangles);
  const Known* known = known_scene(name);
  if (known == nullptr) return {fs::path(name).stem().string(), name};
  if (scenes.empty())
    throw Error(ErrorCode::kInvalidArgument,
                "'" + name + "' must be in a folder of scenes: give --scenes DIR", "--scene");
  return {name, (fs::path(scenes) / known->file).string()};
}

std::vector<CompareScene> compare_scenes_from_strings(const std::vector<std::string>& names,
                                                      const std::string& scenes) {
  std::vector<CompareScene> all;
  std::map<std::string, int> count;
  for (const std::string& name : names) {
    all.push_back(compare_scene_from_string(name, scenes));
    ++count[all.back().name];
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (count[all[i].name] > 1) all[i].name = names[i];
  return all;
}

std::vector<CompareScene> chosen_compare_scenes(const std::vector<std::string>& names,
                                                const std::string& scenes,
                                                std::vector<std::string>* notes) {
  return names.empty() ? default_compare_scenes(scenes, notes)
                       : compare_scenes_from_strings(names, scenes);
}

SceneDescription load_compare_scene(const CompareScene& scene, std::uint32_t threads) {
  if (scene.source.starts_with(kHall))
    return hall_scene(triangles_of_hall(scene.source.substr(kHall.size())), threads);
  SceneDescription loaded = scene_from_argument(scene.source);
  const Known* known = known_scene(scene.name);
  if (known != nullptr && scene.source.ends_with(known->file)) stand_at(known->place, loaded);
  return loaded;
}

}  // namespace raysheaf::app
