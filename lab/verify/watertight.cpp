#include "lab/verify/watertight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/float.h"
#include "lab/verify/round.h"
#include "lab/verify/simd_target.h"

namespace raysheaf::checks {
namespace {

constexpr std::size_t kBatches = 4, kBatchRays = 1 << 16;  ///< batches per round, and rays per
                                                           ///< batch
constexpr float kNever = std::numeric_limits<float>::infinity();
/// Roundings of the largest coordinate, relative to the ray's origin, that must fit between an
/// interior point and the surface. A nearer point may lie in the rounded surface.
constexpr float kInsideRoundings = 256;

struct EdgePoint {
  Vec3 point, core;
};

EdgePoint some_edge_point(const ClosedMesh& mesh, Random* random) {
  const Triangle& t =
      mesh.triangles[random->below(static_cast<std::uint32_t>(mesh.triangles.size()))];
  const std::uint32_t k = random->below(3);
  const std::uint32_t a = t[k], b = t[(k + 1) % 3];
  if (random->one_in(2)) return {mesh.positions[a], mesh.cores[a]};
  const float s = random->one_in(2) ? 0.5f : random->unit();
  return {lerp(mesh.positions[a], mesh.positions[b], s), lerp(mesh.cores[a], mesh.cores[b], s)};
}

/// A point between an edge point and its core; `least` is the smallest fraction of the way.
Vec3 inside(const EdgePoint& e, float least, Random* random) {
  const float most = std::min(4 * least, 1.0f);
  const float part = random->one_in(2) ? random->between(least, most) : random->between(least, 1);
  return lerp(e.point, e.core, part);
}

/// Multiplies by a power of two, so that the direction's line does not change; t = 1 becomes `t`.
void change_length(Random* random, Ray* ray, float* t) {
  const float size = max_component(abs(ray->direction));
  const int now = std::ilogb(size);
  const int lo = std::max(-66, now - 60) - now, hi = std::min(66, now + 60) - now;
  const int by = lo + static_cast<int>(random->below(static_cast<std::uint32_t>(hi - lo + 1)));
  ray->direction = ray->direction * std::ldexp(1.0f, by);
  *t = std::ldexp(1.0f, -by);
}

}  // namespace

Ray edge_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  const EdgePoint from = some_edge_point(mesh, &random), to = some_edge_point(mesh, &random);
  const float coordinates = max_component(abs(mesh.offset)) + 2 * mesh.extent;
  Ray ray;
  float t = 1;
  if (!random.one_in(3)) {  // from inside, in half of the cases along the surface
    const float least =
        std::min(kInsideRoundings * kUnitRoundoff * coordinates / mesh.thickness, 1.0f);
    ray.origin = inside(from, least, &random);
    ray.direction = to.point - ray.origin;
    if (random.one_in(8)) {  // along an axis
      const Vec3 m = ray.direction;
      ray.direction = {random.one_in(2) ? m.x : 0.0f, random.one_in(2) ? m.y : 0.0f, 0.0f};
    }
    if (!(max_component(abs(ray.direction)) > 0)) ray.direction.z = mesh.extent;
    change_length(&random, &ray, &t);
    return ray;
  }
  // From outside to an interior point, through an edge point as exactly as rounding allows.
  const float away = random.magnitude(0, 2);
  const float least =
      kInsideRoundings * kUnitRoundoff * (coordinates + away * mesh.extent) / mesh.thickness;
  const Vec3 aim = inside(to, std::min(least, 1.0f), &random);
  const Vec3 out = to.point - aim;
  const float size = max_component(abs(out));
  ray.origin = aim + out * (size > 0 ? (away + 1) * mesh.extent / size : 0.0f);
  ray.direction = aim - ray.origin;
  if (!(max_component(abs(ray.direction)) > 0)) {
    ray.direction = {0, 0, mesh.extent};
    return ray;
  }
  change_length(&random, &ray, &t);
  // From so far away, no point of the mesh is certainly inside: the ray enters and leaves.
  if (least > 1) return ray;
  if (random.one_in(2))
    ray.t_max = t;  // enters
  else
    ray.t_min = t;  // leaves
  return ray;
}

Ray fan_ray(const ClosedMesh& mesh, std::uint64_t seed, std::uint64_t index) {
  Random once(seed), random(seed, index);
  Ray ray{lerp(mesh.positions.front(), mesh.cores.front(), once.between(0.5f, 1)), 0, {}, kNever};
  ray.direction = some_edge_point(mesh, &random).point - ray.origin;
  return ray;
}

void check_watertight(const Subject& subject, std::uint64_t seed, Tally* tally) {
  const ClosedMesh mesh = make_closed_mesh(seed);
  const std::int64_t target = subject.targets[seed % subject.targets.size()];
  const Subject::Threads& threads = subject.most();
  const OnSimdTarget on(target);
  Scene scene(threads.context);
  scene.add(mesh.positions, mesh.triangles);
  scene.commit();
  std::vector<Ray> rays(kBatchRays);
  std::vector<std::uint8_t> met(kBatchRays);
  for (std::size_t batch = 0; batch < kBatches; ++batch) {
    const bool fan = batch + 1 == kBatches;  // rays of one origin share their tests
    threads.executor->for_each(kBatchRays, 1024, [&](std::size_t i) {
      rays[i] = (fan ? fan_ray : edge_ray)(mesh, seed, batch * kBatchRays + i);
    });
    if (fan || batch == 0) {
      met = subject.any_hit(scene, rays, {});
    } else {
      const std::vector<Hit> hits = subject.closest_hit(scene, rays, {});
      for (std::size_t i = 0; i < kBatchRays; ++i) met[i] = hits[i].prim_id != kInvalidId ? 1 : 0;
    }
    tally->tried(kBatchRays);
    const auto gaps = static_cast<std::uint64_t>(std::count(met.begin(), met.end(), 0));
    if (gaps == 0) continue;
    const auto first = static_cast<std::size_t>(std::find(met.begin(), met.end(), 0) - met.begin());
    tally->fail(gaps, std::string(fan || batch == 0 ? "any_hit" : "closest_hit") + " of dual on " +
                          name_of(target) + ", " + mesh.text() + ": " + std::to_string(gaps) +
                          " rays pass through it, the first being a " + text_of(rays[first]));
  }
}

}  // namespace raysheaf::checks
