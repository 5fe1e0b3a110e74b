// Implements the public streamed queries.
#include <algorithm>
#include <optional>
#include <string>

#include "api/query_check.h"
#include "api/scene/context_impl.h"
#include "api/scene/scene_impl.h"
#include "out_of_core/streamer.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// The process's memory in addition to the rays and the blocks.
constexpr std::uint64_t kQueryBaseBytes = std::uint64_t{32} << 20;

void check(const StreamOptions& options, std::size_t rays, std::size_t answers, const char* name) {
  if (answers != rays)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(answers) + " results for " + std::to_string(rays) + " rays", name);
  if (rays > kMostItems)
    throw Error(ErrorCode::kUnsupported, std::to_string(rays) + " rays are more than 2^31 - 1",
                "rays");
  if (options.threads > kMostThreads)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from 0 to 1024, not " + std::to_string(options.threads), "threads");
  check_parts(options);
}

/// Calls `body(streamer, request, report)` as the options require.
template <class Body>
void stream(const GeometrySource& source, std::span<const Ray> rays, const StreamOptions& options,
            const Body& body) {
  std::optional<Executor> own;
  if (options.context == nullptr) own.emplace(options.threads);
  const Executor& executor = own ? *own : ContextAccess::executor(*options.context);
  const DeviceBackend* device =
      options.context != nullptr ? ContextAccess::backend(*options.context) : nullptr;
  if (options.check) check_rays(executor, {rays.data(), rays.size()});
  const std::uint64_t taken = kQueryBaseBytes + rays.size() * kStreamRayBytes;
  const std::uint32_t slots = slots_for(options.memory_bytes, taken, rays.size());
  Streamer streamer(executor, source, options, slots, device);
  ProgressMeter meter(options.progress);
  StreamRequest request;
  request.stage = "rays";
  request.meter = &meter;
  request.count = options.statistics != nullptr;
  QueryReport report;
  body(&streamer, request, &report);
  const StreamStatistics all = of_all(streamer.statistics(), options.exchange);
  if (options.statistics != nullptr) add(all, options.statistics);
}

}  // namespace

void closest_hit(const GeometrySource& source, std::span<const Ray> rays, std::span<Hit> hits,
                 const StreamOptions& options) {
  answered([&] {
    check(options, rays.size(), hits.size(), "hits");
    std::vector<StreamHit> found(rays.size());
    stream(source, rays, options, [&](Streamer* s, const StreamRequest& request, auto* report) {
      s->closest({rays.data(), rays.size()}, request, found, report);
    });
    std::transform(found.begin(), found.end(), hits.begin(),
                   [](const StreamHit& hit) { return hit.hit; });
  });
}

void any_hit(const GeometrySource& source, std::span<const Ray> rays,
             std::span<std::uint8_t> occluded, const StreamOptions& options) {
  answered([&] {
    check(options, rays.size(), occluded.size(), "occluded");
    stream(source, rays, options, [&](Streamer* s, const StreamRequest& request, auto* report) {
      s->any({rays.data(), rays.size()}, request, {occluded.data(), occluded.size()}, report);
    });
  });
}

}  // namespace raysheaf
