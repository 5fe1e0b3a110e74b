#include "render/frame/device_tracer.h"

#include <utility>

#include "exec/stopwatch.h"
#include "render/device/frame_stages.h"

namespace raysheaf {

DeviceQueries& DeviceTracer::engine(const Executor& executor) {
  if (engine_.knows) return *engine_.made;
  if (engine_.made == nullptr) engine_.made = backend_.make_queries();
  engine_.made->set_triangles(executor, scene_.source(), std::exchange(same_triangles_, false));
  engine_.knows = same_triangles_ = true;
  return *engine_.made;
}

PairTracer& DeviceTracer::pairs(const TriangleList& there) {
  if (pairs_.knows) return *pairs_.made;
  std::vector<PairMesh> meshes;
  for (const FlatMesh& mesh : scene_.meshes)
    meshes.push_back({mesh.bound, mesh.first_triangle, mesh.triangle_count});
  if (pairs_.made == nullptr) pairs_.made = backend_.make_pair_tracer();
  pairs_.made->set_scene({there, View<const PairMesh>(meshes)});
  pairs_.knows = true;
  return *pairs_.made;
}

PacketTracer& DeviceTracer::packets(const Executor& executor, const TriangleList& there,
                                    TreeReport* tree) {
  tree->add({true, TreeWork::kKeep, 0});
  if (packets_.knows) return *packets_.made;
  Stopwatch build;
  if (packets_.made == nullptr) packets_.made = backend_.make_packet_tracer();
  packets_.made->set_scene(executor, {there, scene_.bounds});
  packets_.knows = true;
  tree->add({true, TreeWork::kRebuild, build.lap_ms()});
  return *packets_.made;
}

std::vector<RayHit> DeviceTracer::trace(const Executor& executor, const RayBatch& batch,
                                        Facing facing) {
  DeviceQuery query;
  query.facing = facing;
  query.executor = &executor;
  std::vector<IndexedHit> found(batch.rays.size());
  engine(executor).closest_hit(batch.rays, query, View<IndexedHit>(found));
  std::vector<RayHit> hits;
  for (const IndexedHit& hit : found) hits.push_back({hit.t, hit.triangle});
  return hits;
}

}  // namespace raysheaf
