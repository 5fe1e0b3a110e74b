#include "render/geometry/streamed_geometry.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <numeric>
#include <string>
#include <type_traits>

#include "base/mirrors_body.h"
#include "exec/stopwatch.h"
#include "raysheaf/error.h"
#include "render/frame/dual_tracer.h"
#include "render/frame/primary.h"

namespace raysheaf {
namespace {

/// The number of surfaces that processes exchange at once: 8 MB.
constexpr std::size_t kSurfacesAtOnce = 65536;

void add_stream_report(const QueryReport& report, BatchStatistics* statistics) {
  statistics->bound_tests += report.bound_tests;
  statistics->ray_bound_tests += report.ray_bound_tests;
  statistics->final_tests += report.triangle_tests;
  statistics->times_ms.traverse += report.trace_ms;
  statistics->plan.insert(statistics->plan.end(), report.plan.begin(), report.plan.end());
}

/// The surfaces of one block's hits.
class BlockSurfaces {
 public:
  BlockSurfaces(const GeometrySource& source, const TextureSet& textures, std::uint32_t block)
      : scene_(source.scene()), textures_(textures), place_(source.place(block)) {
    source.read_shading(block, &shading_);
  }

  [[nodiscard]] Surface at(const StreamHit& hit, const Ray& ray, Vec3 direction) const {
    SurfaceTriangle t;
    const Hit& named = hit.hit;
    if (named.inst_id >= scene_.instances.size() ||
        scene_.instances[named.inst_id].mesh != named.geom_id)
      refuse("a triangle is of instance " + std::to_string(named.inst_id) + " of mesh " +
             std::to_string(named.geom_id) + ", which the scene does not have");
    std::copy(hit.corner.begin(), hit.corner.end(), t.corner);
    t.to_world = scene_.instances[named.inst_id].to_world;
    t.mirrored = mirrors(t.to_world);
    t.has_normals = of_part(shading_.has_normals, hit.part);
    t.has_uvs = of_part(shading_.has_uvs, hit.part);
    t.has_colors = !shading_.has_colors.empty() && of_part(shading_.has_colors, hit.part);
    t.has_second_uvs =
        !shading_.has_second_uvs.empty() && of_part(shading_.has_second_uvs, hit.part);
    for (std::size_t k = 0; k < 3; ++k) {
      if (t.has_normals) t.normal[k] = element(shading_.normals, hit.vertex[k]);
      if (t.has_uvs) t.uv[k] = element(shading_.uvs, hit.vertex[k]);
      if (t.has_second_uvs) t.second_uv[k] = element(shading_.second_uvs, hit.vertex[k]);
      if (t.has_colors) t.color[k] = element(shading_.colors, hit.vertex[k]);
    }
    if (shading_.materials.size() == 1) t.material = shading_.materials[0];
    if (shading_.materials.size() > 1) t.material = element(shading_.materials, hit.triangle);
    if (t.material != kInvalidId && t.material >= scene_.materials.size())
      refuse("a triangle is of material " + std::to_string(t.material) + ", but the scene has " +
             std::to_string(scene_.materials.size()));
    const Vec2 uv = clamped_barycentrics(ray, t.corner[0], t.corner[1], t.corner[2]);
    return surface_of(scene_, textures_, t, uv.x, uv.y, direction);
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence) const {
    throw Error(ErrorCode::kInvalidData, sentence, place_);
  }
  template <class T>
  [[nodiscard]] const T& element(const std::vector<T>& column, std::uint32_t i) const {
    if (i >= column.size()) refuse("the shading data have fewer elements than the triangles need");
    return column[i];
  }
  [[nodiscard]] bool of_part(const std::vector<std::uint8_t>& column, std::uint32_t part) const {
    return element(column, part) != 0;
  }

  const SceneDescription& scene_;
  const TextureSet& textures_;
  std::string place_;
  BlockShading shading_;
};

}  // namespace

StreamedGeometry::StreamedGeometry(const Executor& executor, Streamer* streamer,
                                   const TextureSet& textures, std::size_t most_shadow_rays)
    : executor_(executor),
      streamer_(*streamer),
      textures_(textures),
      most_shadow_rays_(most_shadow_rays) {}

std::size_t StreamedGeometry::look(const Seeing& seeing, ProgressMeter* meter) {
  const RayBatch batch = primary_rays(executor_, bounds(), seeing.frame);
  const std::vector<RayHit> hits = traced(batch, Facing::kSkipBackOfSingleSided,
                                          &seeing.statistics(), seeing.pixel_tests, meter);
  meter->begin("surfaces", 1);
  Fragments fragments(hits.size());
  executor_.for_each(hits.size(), 4096, [&](std::size_t i) {
    Fragment f;
    f.pixel = static_cast<std::uint32_t>(i);
    f.triangle = hits[i].triangle;
    f.incoming = normalized(batch.rays[i].direction);
    fragments[i] = f;
  });
  fetch_surfaces(batch.rays, fragments);
  first_hits_ = std::move(fragments);
  return 1;
}

Fragments StreamedGeometry::first_hits(std::size_t /*group*/, const FirstHitTally& /*tally*/) {
  return std::move(first_hits_);
}

float StreamedGeometry::depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) {
  BatchStatistics not_kept;
  const RayHit hit =
      traced(middle_ray(frame), Facing::kSkipBackOfSingleSided, &not_kept, {}, meter).front();
  return depth_of(hit, frame, bounds());
}

StreamRequest StreamedGeometry::begin(const RayBatch& batch, BatchStatistics* statistics,
                                      View<float> ray_tests, ProgressMeter* meter) const {
  statistics->kind = batch.kind;
  statistics->bounce = batch.bounce;
  statistics->triangles = triangle_count();
  statistics->rays += batch.rays.size();
  StreamRequest request;
  request.stage = stage_name(batch.kind, batch.bounce) + ", bytes of blocks";
  request.meter = meter;
  request.ray_tests = ray_tests;
  return request;
}

std::vector<RayHit> StreamedGeometry::trace(const RayBatch& batch, BatchStatistics* statistics,
                                            View<float> ray_tests, ProgressMeter* meter) {
  return traced(batch, Facing::kBoth, statistics, ray_tests, meter);
}

std::vector<RayHit> StreamedGeometry::traced(const RayBatch& batch, Facing facing,
                                             BatchStatistics* statistics, View<float> ray_tests,
                                             ProgressMeter* meter) {
  StreamRequest request = begin(batch, statistics, ray_tests, meter);
  request.facing = facing;
  std::vector<RayHit> hits = closest(batch, request, statistics);
  statistics->hits += static_cast<std::uint64_t>(
      std::count_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.found(); }));
  return hits;
}

std::vector<RayHit> StreamedGeometry::closest(const RayBatch& batch, const StreamRequest& request,
                                              BatchStatistics* statistics) {
  hits_.resize(batch.rays.size());
  QueryReport report;
  streamer_.closest(batch.rays, request, hits_, &report);
  add_stream_report(report, statistics);
  std::vector<RayHit> hits(hits_.size());
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    if (hits_[i].block != kInvalidId) hits[i] = {hits_[i].hit.t, i};
  }
  return hits;
}

void StreamedGeometry::find_occluded(const RayBatch& batch, bool /*early_out*/,
                                     BatchStatistics* statistics, View<float> ray_tests,
                                     ProgressMeter* meter, View<std::uint8_t> occluded) {
  StreamRequest request = begin(batch, statistics, ray_tests, meter);
  request.facing = Facing::kBoth;
  QueryReport report;
  streamer_.any(batch.rays, request, occluded, &report);
  add_stream_report(report, statistics);
  statistics->hits += std::accumulate(occluded.begin(), occluded.end(), std::uint64_t{0});
}

void StreamedGeometry::fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) {
  Stopwatch watch;
  std::vector<std::uint32_t> met;
  for (std::uint32_t i = 0; i < fragments.size; ++i) {
    if (fragments[i].triangle != kInvalidId) met.push_back(i);
  }
  const auto block_of = [&](std::uint32_t i) { return hits_[fragments[i].triangle].block; };
  std::stable_sort(met.begin(), met.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return block_of(a) < block_of(b); });
  std::vector<std::size_t> starts;  // of the blocks, in `met`
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (i == 0 || block_of(met[i]) != block_of(met[i - 1])) starts.push_back(i);
  }
  starts.push_back(met.size());
  const GeometrySource& source = streamer_.source();
  HitExchange* const exchange = streamer_.exchange();
  executor_.for_each(starts.size() - 1, 1, [&](std::size_t s) {
    const std::uint32_t block = block_of(met[starts[s]]);
    if (exchange != nullptr && !streamer_.is_own(block)) return;
    const BlockSurfaces surfaces(source, textures_, block);
    for (std::size_t i = starts[s]; i < starts[s + 1]; ++i) {
      Fragment& f = fragments[met[i]];
      f.surface = surfaces.at(hits_[f.triangle], rays[met[i]], f.incoming);
    }
  });
  for (std::size_t s = 0; s + 1 < starts.size(); ++s) {
    const std::uint32_t block = block_of(met[starts[s]]);
    if (exchange != nullptr && !streamer_.is_own(block)) continue;
    ++shading_.shading_blocks;
    shading_.read_bytes += source.blocks()[block].shading_bytes;
  }
  if (exchange != nullptr) exchange_surfaces(met, fragments);
  shading_.shading_ms += watch.lap_ms();
}

void StreamedGeometry::exchange_surfaces(const std::vector<std::uint32_t>& met,
                                         View<Fragment> fragments) {
  static_assert(std::is_trivially_copyable_v<Surface>);
  std::vector<std::uint8_t> bytes;
  for (std::size_t begin = 0; begin < met.size(); begin += kSurfacesAtOnce) {
    const std::size_t count = std::min(kSurfacesAtOnce, met.size() - begin);
    bytes.assign(count * sizeof(Surface), 0);
    for (std::size_t i = 0; i < count; ++i) {
      const Fragment& f = fragments[met[begin + i]];
      if (streamer_.is_own(hits_[f.triangle].block))
        std::memcpy(bytes.data() + i * sizeof(Surface), &f.surface, sizeof(Surface));
    }
    streamer_.exchange()->unite(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(static_cast<void*>(&fragments[met[begin + i]].surface),
                  bytes.data() + i * sizeof(Surface), sizeof(Surface));
    }
  }
}

PixelIds StreamedGeometry::ids(std::uint32_t triangle) const {
  if (triangle == kInvalidId) return {};
  const Hit& hit = hits_[triangle].hit;
  return {hit.inst_id, hit.geom_id, hit.prim_id};
}

}  // namespace raysheaf
