#include "render/frame/device_tracer.h"

#include <utility>

#include "exec/stopwatch.h"
#include "render/device/frame_backend.h"

namespace raysheaf {

DeviceQueries& DeviceTracer::engine(const Executor& executor) {
  if (engine_knows_) return *engine_;
  if (engine_ == nullptr) engine_ = backend_.make_queries();
  engine_->set_triangles(executor, scene_.source(), std::exchange(same_triangles_, false));
  engine_knows_ = same_triangles_ = true;
  return *engine_;
}

DeviceBatchTracer& DeviceTracer::ordered(const Executor& executor, Traversal traversal,
                                         const TriangleList& there, TreeReport* tree) {
  const bool has_tree = traversal == Traversal::kPackets;
  if (has_tree) tree->add({true, TreeWork::kKeep, 0});
  if (ordered_knows_ && ordered_by_ == traversal) return *ordered_;
  Stopwatch build;
  if (ordered_ == nullptr || ordered_by_ != traversal) {
    ordered_.reset();  // before the next takes the device's memory
    ordered_ = frame_backend(backend_).make_batch_tracer(traversal);
  }
  ordered_by_ = traversal;
  ordered_knows_ = false;
  ordered_->set_scene(executor, scene_, there);
  ordered_knows_ = true;
  if (has_tree) tree->add({true, TreeWork::kRebuild, build.lap_ms()});
  return *ordered_;
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
