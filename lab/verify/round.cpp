#include "lab/verify/round.h"

#include <algorithm>
#include <bit>
#include <cstdio>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "lab/verify/simd_target.h"

namespace raysheaf::checks {
namespace {

constexpr std::size_t kMostNamed = 10;

std::vector<std::uint32_t> thread_counts(std::uint32_t most) {
  const std::uint32_t cores = Context().threads();
  if (most == 0 || most > cores) most = cores;
  std::vector<std::uint32_t> counts{1};
  if (most > 1) counts.push_back(2);
  if (most > 2) counts.push_back(most);
  return counts;
}

std::string number(float x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", static_cast<double>(x));
  return text;
}

/// With its memory.
struct EmulatedContext {
  std::shared_ptr<const Executor> executor;
  HostAllocator memory;
  Context context;

  explicit EmulatedContext(const Subject::Threads& threads)
      : executor(threads.executor),
        context(ContextAccess::with_backend({.device = Device::kCuda, .threads = threads.count},
                                            open_emulated(*executor, memory))) {}
};

}  // namespace

Subject::Subject(std::uint32_t most_threads)
    : closest_hit([](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
        return raysheaf::closest_hit(scene, rays, options);
      }),
      any_hit([](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
        return raysheaf::any_hit(scene, rays, options);
      }),
      all_hits([](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
        return raysheaf::all_hits(scene, rays, options);
      }),
      first_hits([](const Scene& scene, std::span<const Ray> rays, std::uint32_t most,
                    const QueryOptions& options) {
        return raysheaf::first_hits(scene, rays, most, options);
      }),
      hit_counts([](const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
        return raysheaf::hit_counts(scene, rays, options);
      }),
      hit_points([](const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits,
                    std::span<const float> times) {
        return raysheaf::hit_points(scene, rays, hits, times);
      }),
      nearest([](const Scene& scene, const PointParts& points, std::size_t k,
                 const PointOptions& options) {
        return k == 1 ? raysheaf::closest_point(scene, points, options)
                      : raysheaf::nearest(scene, points, k, options);
      }),
      signed_distance(
          [](const Scene& scene, const PointParts& points, const PointOptions& options) {
            return raysheaf::signed_distance(scene, points, options);
          }),
      contains([](const Scene& scene, const PointParts& points, const PointOptions& options) {
        return raysheaf::contains(scene, points, options);
      }),
      intersect(intersect_triangle),
      targets(simd_targets()) {
  for (const std::uint32_t count : thread_counts(most_threads))
    threads.push_back(
        {count, Context({.threads = count}), std::make_shared<const Executor>(count)});
  const auto emulated = std::make_shared<const EmulatedContext>(most());
  device = {emulated, &emulated->context};
}

void Tally::fail(std::string what) {
  fail(1, std::move(what));
}

void Tally::fail(std::uint64_t count, std::string first) {
  report_->failures += count;
  if (report_->first_failures.size() < kMostNamed)
    report_->first_failures.push_back({seed_, std::move(first)});
}

bool same(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) &&
         a.prim_id == b.prim_id && a.geom_id == b.geom_id && a.inst_id == b.inst_id;
}

std::string text_of(Vec3 v) {
  return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

std::string text_of(const Hit& hit) {
  if (hit.prim_id == kInvalidId) return "no hit";
  return "triangle " + std::to_string(hit.prim_id) + " of mesh " + std::to_string(hit.geom_id) +
         " at t " + number(hit.t) + ", u " + number(hit.u) + ", v " + number(hit.v);
}

std::string text_of(const Ray& ray) {
  return "ray from " + text_of(ray.origin) + " along " + text_of(ray.direction) + ", t from " +
         number(ray.t_min) + " to " + number(ray.t_max);
}

std::string text_of(const ClosestPoint& found) {
  if (found.prim_id == kInvalidId) return "no triangle";
  return "triangle " + std::to_string(found.prim_id) + " of mesh " + std::to_string(found.geom_id) +
         " at " + text_of(found.distance) + ", u " + text_of(found.u) + ", v " + text_of(found.v) +
         ", side " + std::to_string(found.side);
}

std::string text_of(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

}  // namespace raysheaf::checks
