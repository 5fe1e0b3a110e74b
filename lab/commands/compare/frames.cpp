#include "lab/commands/compare/frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raysheaf/lab.h"

namespace raysheaf::app {
namespace {

Vec3 plus(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

float diagonal_of(const Box& box) {
  return std::hypot(box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z);
}

Vec3 mapped(const Affine& a, Vec3 p, bool is_point) {
  const auto row = [&](const std::array<float, 4>& m) {
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + (is_point ? m[3] : 0);
  };
  return {row(a.m[0]), row(a.m[1]), row(a.m[2])};
}

/// The matrix of cofactors: the inverse transpose times the determinant, which maps normals.
Affine cofactors(const Affine& a) {
  Affine c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const auto at = [&](std::size_t k, std::size_t l) { return a.m[(i + k) % 3][(j + l) % 3]; };
      c.m[i][j] = at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1);
    }
  }
  return c;
}

float determinant(const Affine& a, const Affine& cofactor) {
  return a.m[0][0] * cofactor.m[0][0] + a.m[0][1] * cofactor.m[0][1] + a.m[0][2] * cofactor.m[0][2];
}

Vec3 unit(Vec3 v, float sign) {
  const float length = std::hypot(v.x, v.y, v.z);
  return length > 0 ? Vec3{sign * v.x / length, sign * v.y / length, sign * v.z / length}
                    : Vec3{0, 0, 1};
}

/// A separate mesh for an instance. A mirrored instance gets its corners swapped, so that its front
/// faces stay in front.
Mesh baked(const Mesh& mesh, const Affine& to_world) {
  const Affine normal_map = cofactors(to_world);
  const bool mirrors = determinant(to_world, normal_map) < 0;
  Mesh result;
  result.positions.reserve(mesh.positions.size() + 1);  // four bytes that the peer may read
  for (const Vec3 p : mesh.positions) result.positions.push_back(mapped(to_world, p, true));
  for (const Vec3 n : mesh.normals)
    result.normals.push_back(unit(mapped(normal_map, n, false), mirrors ? -1.0f : 1.0f));
  result.triangles = mesh.triangles;
  if (mirrors)
    for (auto& t : result.triangles) std::swap(t[1], t[2]);
  result.materials = mesh.materials;
  return result;
}

/// The first light of the scene, or one that lights it from its camera.
Light point_light(const SceneDescription& scene, const SceneDescription& seen) {
  for (const Light& light : scene.lights)
    if (light.type == Light::Type::kPoint) return light;
  return showing_light(seen, seen.cameras.front());
}

/// The data that rays depend on: surfaces, whether they are two-sided, one light, one camera.
SceneDescription plain(const SceneDescription& scene) {
  SceneDescription result;
  for (const Material& material : scene.materials) {
    result.materials.emplace_back();
    result.materials.back().double_sided = material.double_sided;
  }
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    result.instances.push_back({{}, static_cast<std::uint32_t>(result.meshes.size()), {}});
    result.meshes.push_back(baked(mesh, instance.to_world));
  }
  result.cameras = scene.cameras;
  if (result.cameras.empty()) result.cameras.push_back(framing_camera(result));
  result.lights.push_back(point_light(scene, result));
  return result;
}

/// Three waves per diagonal along each axis.
void deform(SceneDescription& scene) {
  const float size = diagonal_of(world_bounds(scene));
  const float turn = 6 * std::numbers::pi_v<float> / std::max(size, 1e-30f), reach = 0.005f * size;
  for (Mesh& mesh : scene.meshes) {
    for (Vec3& p : mesh.positions) {
      const Vec3 a{p.x * turn, p.y * turn, p.z * turn};
      p = plus(p,
               {reach * std::sin(a.y + 1), reach * std::sin(a.z + 2), reach * std::sin(a.x + 3)});
    }
  }
}

/// Sebastiano Vigna's splitmix64: the number at each position of a sequence, in any order.
std::uint64_t number_at(std::uint64_t place) {
  std::uint64_t z = (place + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

Ray random_ray(const Box& box, std::uint64_t i) {
  const auto inside = [&](float lo, float hi, std::uint64_t axis) {
    return lo + (hi - lo) * fraction_at(8 * i + axis);
  };
  const float z = 2 * fraction_at(8 * i + 3) - 1;
  const float angle = 2 * std::numbers::pi_v<float> * fraction_at(8 * i + 4);
  const float radius = std::sqrt(std::max(0.0f, 1 - z * z));
  Ray ray;
  ray.origin = {inside(box.min.x, box.max.x, 0), inside(box.min.y, box.max.y, 1),
                inside(box.min.z, box.max.z, 2)};
  ray.direction = {radius * std::cos(angle), radius * std::sin(angle), z};
  return ray;
}

LabRays lab_rays(CompareKind kind) {
  switch (kind) {
    case CompareKind::kMirror:
      return LabRays::kReflection1;
    case CompareKind::kSecond:
      return LabRays::kReflection2;
    case CompareKind::kAmbientOcclusion:
      return LabRays::kAmbientOcclusion;
    default:
      return LabRays::kShadow;
  }
}

bool needs_whole_picture(CompareKind kind) {
  return kind == CompareKind::kShadow || kind == CompareKind::kMirror ||
         kind == CompareKind::kSecond;
}

}  // namespace

float fraction_at(std::uint64_t place) {
  return static_cast<float>(number_at(place) >> 40) * 0x1p-24f;
}

std::vector<Ray> random_rays(const Box& box, std::uint64_t count) {
  std::vector<Ray> rays(count);
  for (std::uint64_t i = 0; i < count; ++i) rays[i] = random_ray(box, i);
  return rays;
}

CompareFrames::CompareFrames(const SceneDescription& scene, bool moving) {
  frames_.resize(moving ? kFrames : 1);
  frames_[0].scene = plain(scene);
  if (!moving) return;
  Frame& second = frames_[1];
  second.scene = frames_[0].scene;
  for (Mesh& mesh : second.scene.meshes) mesh.positions.reserve(mesh.positions.size() + 1);
  deform(second.scene);
  for (const Mesh& mesh : second.scene.meshes)
    second.reversed.emplace_back(mesh.triangles.rbegin(), mesh.triangles.rend());
}

std::uint64_t CompareFrames::triangle_count() const {
  return frames_[0].scene.triangle_count() + ground_.triangles.size();
}

std::vector<MeshView> CompareFrames::meshes(std::size_t frame, bool same_indices) const {
  const Frame& f = frames_[frame];
  std::vector<MeshView> views;
  for (std::size_t i = 0; i < f.scene.meshes.size(); ++i) {
    const Triangles& own = f.reversed.empty() ? f.scene.meshes[i].triangles : f.reversed[i];
    views.push_back(
        {f.scene.meshes[i].positions, same_indices ? frames_[0].scene.meshes[i].triangles : own});
  }
  if (!ground_.triangles.empty()) views.push_back({ground_.positions, ground_.triangles});
  return views;
}

const std::vector<Ray>& CompareFrames::rays(std::size_t frame, CompareKind kind) const {
  return frames_[frame].rays[static_cast<std::size_t>(kind)];
}

float CompareFrames::diagonal() const {
  return diagonal_of(world_bounds(frames_[0].scene));
}

void CompareFrames::make_rays(const std::vector<CompareKind>& kinds, std::uint32_t width,
                              std::uint32_t height, std::uint32_t threads) {
  for (Frame& frame : frames_) {
    const auto fill = [&](CompareKind kind, Laboratory& laboratory) {
      frame.rays[static_cast<std::size_t>(kind)] = laboratory.rays(lab_rays(kind));
    };
    const auto asked = [&](CompareKind kind) {
      return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
    };
    if (std::any_of(kinds.begin(), kinds.end(), needs_whole_picture)) {
      Laboratory laboratory(frame.scene, width, height, threads);
      for (const CompareKind kind : kinds)
        if (needs_whole_picture(kind)) fill(kind, laboratory);
    }
    if (asked(CompareKind::kAmbientOcclusion)) {
      Laboratory half(frame.scene, std::max(1u, width / 2), std::max(1u, height / 2), threads);
      fill(CompareKind::kAmbientOcclusion, half);
    }
    if (asked(CompareKind::kRandom))
      frame.rays[static_cast<std::size_t>(CompareKind::kRandom)] =
          random_rays(world_bounds(frame.scene), std::uint64_t{width} * height);
  }
}

void CompareFrames::set_ground(float half) {
  const float below = world_bounds(frames_[0].scene).min.y - 0.1f * diagonal();
  ground_.positions.reserve(5);  // four bytes that the peer may read
  ground_.positions = {
      {-half, below, -half}, {half, below, -half}, {half, below, half}, {-half, below, half}};
  ground_.triangles = {{0, 2, 1}, {0, 3, 2}};
}

}  // namespace raysheaf::app
