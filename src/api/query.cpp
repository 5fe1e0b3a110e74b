// Implements the public queries of rays.
#include "raysheaf/query.h"

#include <string>

#include "api/query_call.h"
#include "geom/ray_fault.h"

namespace raysheaf {
namespace {

HitRows find_rows(const Scene& scene, const QueryRays& rays, std::size_t most,
                  const QueryOptions& options) {
  return answered([&] {
    HitRows rows;
    rows.offsets.assign(rays.size() + 1, 0);
    run_query(scene, rays, options, Answers<Hit>{{}, "", {}, 0},
              [&](const SceneQueries& by, QueryCall& call, const QueryRays& all,
                  std::span<Hit> /*answers*/) { by.all_hits(call, all, most, &rows); });
    return rows;
  });
}

/// The answer for a batch of one ray.
template <class T, class Ask>
T answer_one(const Scene& scene, const Ray& ray, const QueryOptions& options, const char* name,
             const Ask& ask) {
  if (options.check) {
    const RayFault fault = fault_of(ray);
    if (fault.field != nullptr)
      throw Error(ErrorCode::kInvalidData, fault.sentence, std::string("ray.") + fault.field);
  }
  T answer{};
  run_query(scene, QueryRays(std::span(&ray, 1), false), options,
            Answers<T>{{&answer, 1}, name, {}, 1, true}, ask);
  return answer;
}

/// Every hit of a row.
constexpr std::size_t kEveryHit = ~std::size_t{0};

}  // namespace

void closest_hit(const Scene& scene, const RayParts& rays, std::span<Hit> hits,
                 const QueryOptions& options) {
  run_query(scene, QueryRays(rays, options.check), options, Answers<Hit>{hits, "hits", {}, 1, true},
            &SceneQueries::closest_hit);
}
std::vector<Hit> closest_hit(const Scene& scene, const RayParts& rays,
                             const QueryOptions& options) {
  return make_answers<Hit>(rays.count, "rays",
                           [&](std::span<Hit> hits) { closest_hit(scene, rays, hits, options); });
}
Hit closest_hit(const Scene& scene, const Ray& ray, const QueryOptions& options) {
  return answer_one<Hit>(scene, ray, options, "hits", &SceneQueries::closest_hit);
}

void any_hit(const Scene& scene, const RayParts& rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options) {
  run_query(scene, QueryRays(rays, options.check), options,
            Answers<std::uint8_t>{occluded, "occluded", {}, 1, true}, &SceneQueries::any_hit);
}
std::vector<std::uint8_t> any_hit(const Scene& scene, const RayParts& rays,
                                  const QueryOptions& options) {
  return make_answers<std::uint8_t>(rays.count, "rays", [&](std::span<std::uint8_t> occluded) {
    any_hit(scene, rays, occluded, options);
  });
}
bool any_hit(const Scene& scene, const Ray& ray, const QueryOptions& options) {
  return answer_one<std::uint8_t>(scene, ray, options, "occluded", &SceneQueries::any_hit) != 0;
}

HitRows all_hits(const Scene& scene, const RayParts& rays, const QueryOptions& options) {
  return find_rows(scene, QueryRays(rays, options.check), kEveryHit, options);
}

HitRows first_hits(const Scene& scene, const RayParts& rays, std::uint32_t most,
                   const QueryOptions& options) {
  return find_rows(scene, QueryRays(rays, options.check), most, options);
}

void hit_counts(const Scene& scene, const RayParts& rays, std::span<std::uint32_t> counts,
                const QueryOptions& options) {
  run_query(scene, QueryRays(rays, options.check), options,
            Answers<std::uint32_t>{counts, "counts"}, &SceneQueries::hit_counts);
}
std::vector<std::uint32_t> hit_counts(const Scene& scene, const RayParts& rays,
                                      const QueryOptions& options) {
  return make_answers<std::uint32_t>(rays.count, "rays", [&](std::span<std::uint32_t> counts) {
    hit_counts(scene, rays, counts, options);
  });
}

}  // namespace raysheaf
