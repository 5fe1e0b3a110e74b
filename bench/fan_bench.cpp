// Shadow rays of one point light: the fan of cells, and, if installed, Embree's rebuild and trace
// of the same rays, interleaved in one process. Argument: threads (0: all cores).
//
// RAYSHEAF_BENCH_TRIANGLES=1000000 uses that many generated triangles instead of a scene: a bumpy
// closed surface of small triangles seen from inside, and small triangles scattered in front of it.
#include "methods/fan/fan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "support.h"

#ifdef RAYSHEAF_BENCH_EMBREE
#include <embree3/rtcore.h>
#endif

namespace raysheaf::bench {
namespace {

struct Fan {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> indices;
  std::vector<TriangleRun> runs;
  LargeVector<Ray> rays;

  Fan() {
    const char* asked = std::getenv("RAYSHEAF_BENCH_TRIANGLES");
    if (asked != nullptr && *asked != '\0')
      generate(static_cast<std::uint32_t>(std::atol(asked)));
    else
      take_scene();
    runs.push_back(
        {positions.data(), indices.data(), 0, static_cast<std::uint32_t>(indices.size())});
  }
  [[nodiscard]] TriangleSource source() const {
    return {View<const TriangleRun>(runs), static_cast<std::uint32_t>(indices.size()), nullptr};
  }

 private:
  void take_scene() {
    const FlatScene& flat = input().flat;
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i) {
      for (const Vec3 corner : flat.corners(i)) positions.push_back(corner);
      indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    rays = input().shadow_rays(Executor(), input().fragments).rays;
  }

  /// A wavy sphere with half of the triangles, and the other half as small triangles inside.
  void generate(std::uint32_t count) {
    const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<float>(count) / 4));
    for (std::uint32_t i = 0; i <= side; ++i) {
      for (std::uint32_t k = 0; k <= side; ++k) positions.push_back(on_sphere(i, k, side));
    }
    for (std::uint32_t i = 0; i < side; ++i) {
      for (std::uint32_t k = 0; k < side; ++k) {
        const std::uint32_t a = i * (side + 1) + k, b = a + side + 1;
        indices.push_back({a, b, a + 1});
        indices.push_back({b, b + 1, a + 1});
      }
    }
    std::uint32_t state = 1;
    const auto random = [&] {
      state = state * 1664525u + 1013904223u;
      return static_cast<float>(state >> 8) * 0x1p-23f - 1;
    };
    const float size = 8 / std::sqrt(static_cast<float>(count));
    while (indices.size() < count) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      const Vec3 p{7 * random(), 7 * random(), 7 * random()};
      positions.push_back(p);
      for (int k = 0; k < 2; ++k)
        positions.push_back(p + Vec3{random() * size, random() * size, random() * size});
      indices.push_back({first, first + 1, first + 2});
    }
    // Rays to a quarter of the surface, in rows as in an image.
    for (std::uint32_t y = 0; y < 505; ++y) {
      for (std::uint32_t x = 0; x < 505; ++x) {
        const float a = 0.8f + static_cast<float>(y) / 505, b = static_cast<float>(x) / 505 * 3;
        const Vec3 d{std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)};
        rays.push_back({{0.1f, 0.2f, 0.3f}, 0, d * 9.5f, 1});
      }
    }
  }

  static Vec3 on_sphere(std::uint32_t i, std::uint32_t k, std::uint32_t side) {
    const float a = static_cast<float>(i) / static_cast<float>(side) * 3.14159265f;
    const float b = static_cast<float>(k) / static_cast<float>(side) * 6.2831853f;
    const float r = 10 + 0.3f * std::sin(20 * a) * std::cos(30 * b);
    return {r * std::sin(a) * std::cos(b), r * std::cos(a), r * std::sin(a) * std::sin(b)};
  }
};

const Fan& fan() {
  static const Fan the_fan;
  return the_fan;
}

void any_hit(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  FanMemory memory;
  FanCounts counts;
  std::vector<std::uint8_t> occluded(fan().rays.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(occluded_in_fan(executor, fan().source(), fan().rays,
                                             {Facing::kBoth, true, &memory}, occluded, {},
                                             &counts));
  }
  const auto n = static_cast<double>(state.iterations());
  const auto rays = static_cast<double>(fan().rays.size());
  state.counters["order_ms"] = counts.order_ms / n;
  state.counters["stream_ms"] = counts.hierarchy_ms / n;
  state.counters["tiles_ms"] = counts.traverse_ms / n;
  state.counters["bound_tests_a_ray"] = static_cast<double>(counts.bound_tests) / n / rays;
  state.counters["ray_tests_a_ray"] = static_cast<double>(counts.triangle_tests) / n / rays;
  state.counters["percent"] = 100 *
                              static_cast<double>(counts.bound_tests + counts.triangle_tests) / n /
                              rays / static_cast<double>(fan().indices.size());
  state.counters["rays"] = rays;
  state.counters["triangles"] = static_cast<double>(fan().indices.size());
  state.counters["occluded"] =
      static_cast<double>(std::count(occluded.begin(), occluded.end(), 1)) / rays;
}
BENCHMARK(any_hit)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

#ifdef RAYSHEAF_BENCH_EMBREE

/// An Embree scene over the same arrays, rebuilt for each batch.
class Embree {
 public:
  explicit Embree(std::uint32_t threads)
      : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())),
        scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_LOW);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX,
                                                                0, RTC_FORMAT_FLOAT3, sizeof(Vec3),
                                                                fan().positions.size()));
    std::copy(fan().positions.begin(), fan().positions.end(), vertices);
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), fan().indices.size()));
    std::copy(fan().indices.begin(), fan().indices.end(), indices);
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
  }
  ~Embree() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void rebuild() {
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  /// Traces rays in packets of 16, in the order of the batch.
  void trace(const Executor& executor, View<std::uint8_t> occluded) const {
    const LargeVector<Ray>& rays = fan().rays;
    executor.for_each_block((rays.size() + 15) / 16, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) trace_packet(rays, p * 16, occluded);
    });
  }

 private:
  void trace_packet(const LargeVector<Ray>& rays, std::size_t first,
                    View<std::uint8_t> occluded) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) int valid[16];
    RTCRay16 p;
    for (std::size_t k = 0; k < 16; ++k) {
      valid[k] = first + k < rays.size() ? -1 : 0;
      const Ray& ray = rays[std::min(first + k, rays.size() - 1)];
      p.org_x[k] = ray.origin.x, p.org_y[k] = ray.origin.y, p.org_z[k] = ray.origin.z;
      p.dir_x[k] = ray.direction.x, p.dir_y[k] = ray.direction.y, p.dir_z[k] = ray.direction.z;
      p.tnear[k] = ray.t_min, p.tfar[k] = ray.t_max;
      p.time[k] = 0, p.mask[k] = ~0u, p.id[k] = 0, p.flags[k] = 0;
    }
    rtcOccluded16(valid, scene_, &context, &p);
    for (std::size_t k = 0; k < 16 && first + k < rays.size(); ++k)
      occluded[first + k] = p.tfar[k] < 0 ? 1 : 0;
  }

  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

/// Runs both, one after the other, in every iteration.
void against_embree(benchmark::State& state) {
  const Executor executor = executor_of(state, 0);
  Embree embree(executor.threads());
  FanMemory memory;
  std::vector<std::uint8_t> ours(fan().rays.size()), theirs(fan().rays.size());
  std::vector<double> fan_ms, build_ms, trace_ms, ratio;
  // With one thread, CPU time is measured, which other programs do not affect.
  const bool alone = executor.threads() == 1;
  const auto now_ms = [alone] {
    if (alone) return static_cast<double>(std::clock()) * 1e3 / CLOCKS_PER_SEC;
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double, std::milli>(now).count();
  };
  const auto timed = [&](std::vector<double>* out, const auto& body) {
    const double start = now_ms();
    body();
    out->push_back(now_ms() - start);
  };
  for (auto _ : state) {
    timed(&fan_ms, [&] {
      benchmark::DoNotOptimize(occluded_in_fan(executor, fan().source(), fan().rays,
                                               {Facing::kBoth, false, &memory}, ours, {}, nullptr));
    });
    timed(&build_ms, [&] { embree.rebuild(); });
    timed(&trace_ms, [&] { embree.trace(executor, theirs); });
    ratio.push_back(fan_ms.back() / (build_ms.back() + trace_ms.back()));
  }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  state.counters["fan_ms"] = median(fan_ms);
  state.counters["build_ms"] = median(build_ms);
  state.counters["trace_ms"] = median(trace_ms);
  state.counters["ratio"] = median(ratio);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) differ += ours[i] != theirs[i] ? 1 : 0;
  state.counters["differ"] = static_cast<double>(differ);
}
BENCHMARK(against_embree)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(15);

#endif

}  // namespace
}  // namespace raysheaf::bench
