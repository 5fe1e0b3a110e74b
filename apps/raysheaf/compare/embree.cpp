// Embree 3: its device, its scenes and their builds.
#include <embree3/rtcore.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

#include <atomic>
#include <mutex>

#include "compare/calls.h"
#include "compare/peer.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

/// Denormals are zero while it lives, as Embree's manual asks for. Nobody else's threads keep it.
class FlushedDenormals {
 public:
#if defined(__SSE2__)
  FlushedDenormals() : before_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushedDenormals() {
    _mm_setcsr(before_);
  }
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

 private:
  unsigned before_;
#else
  FlushedDenormals() {}
#endif
};

/// The quality of the whole scene and of its geometries. A dynamic scene has a tree a geometry and
/// one over them; the others have one over all triangles, where Embree has such a builder.
struct EmbreeBuild {
  const char* name;
  RTCBuildQuality scene, geometry;
  bool dynamic;
  CompareMode mode;
};

constexpr EmbreeBuild kBuilds[] = {
    {"LOW", RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_LOW, false, CompareMode::kRebuild},
    {"LOW dynamic", RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_LOW, true, CompareMode::kRebuild},
    {"MEDIUM", RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_MEDIUM, false, CompareMode::kRebuild},
    {"MEDIUM dynamic", RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_MEDIUM, true,
     CompareMode::kRebuild},
    {"REFIT", RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_REFIT, true, CompareMode::kRefit},
    {"HIGH", RTC_BUILD_QUALITY_HIGH, RTC_BUILD_QUALITY_HIGH, false, CompareMode::kStatic},
};

}  // namespace

class PeerDevice::Impl {
 public:
  explicit Impl(std::uint32_t threads)
      : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())),
        arena_(static_cast<int>(threads)) {
    if (device_ == nullptr) throw Error(ErrorCode::kInternal, "Embree has no device", "Embree");
    rtcSetDeviceErrorFunction(device_, remember, this);
    rtcSetDeviceMemoryMonitorFunction(device_, count, this);
  }
  ~Impl() { rtcReleaseDevice(device_); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] RTCDevice device() const { return device_; }
  [[nodiscard]] oneapi::tbb::task_arena& arena() { return arena_; }
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_));
  }

  /// Throws what went wrong since the last call.
  void check() {
    const std::lock_guard lock(mutex_);
    if (error_ == RTC_ERROR_NONE) return;
    const ErrorCode code =
        error_ == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::kOutOfMemory : ErrorCode::kInternal;
    error_ = RTC_ERROR_NONE;
    throw Error(code, message_, "Embree");
  }

 private:
  static void remember(void* self, RTCError error, const char* message) {
    auto& impl = *static_cast<Impl*>(self);
    const std::lock_guard lock(impl.mutex_);
    impl.error_ = error;
    impl.message_ = message != nullptr ? message : "an error without a name";
  }
  static bool count(void* self, ssize_t bytes, bool) {
    static_cast<Impl*>(self)->bytes_ += bytes;
    return true;
  }

  std::atomic<std::int64_t> bytes_ = 0;
  std::mutex mutex_;
  RTCError error_ = RTC_ERROR_NONE;
  std::string message_;
  RTCDevice device_;
  oneapi::tbb::task_arena arena_;
};

class PeerScene::Impl {
 public:
  Impl(PeerDevice::Impl& device, const EmbreeBuild& build)
      : device_(device), build_(build), scene_(rtcNewScene(device.device())) {
    rtcSetSceneBuildQuality(scene_, build.scene);
    rtcSetSceneFlags(scene_, build.dynamic ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE);
    device_.check();
  }
  ~Impl() {
    for (RTCGeometry geometry : geometries_) rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set(std::span<const MeshView> meshes, bool indices_too) {
    const FlushedDenormals flushed;
    while (geometries_.size() < meshes.size()) add();
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      RTCGeometry geometry = geometries_[i];
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 meshes[i].positions.data(), 0, sizeof(Vec3),
                                 meshes[i].positions.size());
      if (indices_too)
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   meshes[i].triangles.data(), 0, 3 * sizeof(std::uint32_t),
                                   meshes[i].triangles.size());
      rtcCommitGeometry(geometry);
    }
    rtcCommitScene(scene_);
    device_.check();
  }

  template <class Out, class Call>
  void trace(std::span<const Ray> rays, std::span<Out> out, bool coherent, const Call& call) {
    device_.arena().execute([&] {
      using Range = oneapi::tbb::blocked_range<std::size_t>;
      const std::size_t tasks = (rays.size() + kRaysATask - 1) / kRaysATask;
      oneapi::tbb::parallel_for(Range(0, tasks, 1), [&](const Range& range) {
        const FlushedDenormals flushed;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags =
            coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        for (std::size_t task = range.begin(); task < range.end(); ++task) {
          const std::size_t first = task * kRaysATask;
          const std::size_t count = std::min(kRaysATask, rays.size() - first);
          call(scene_, context, rays.subspan(first, count), out.subspan(first, count));
        }
      });
    });
    device_.check();
  }

 private:
  void add() {
    RTCGeometry geometry = rtcNewGeometry(device_.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, build_.geometry);
    rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(geometries_.size()));
    geometries_.push_back(geometry);
  }

  PeerDevice::Impl& device_;
  const EmbreeBuild& build_;
  RTCScene scene_;
  std::vector<RTCGeometry> geometries_;
};

std::string peer_name() {
  return "Embree " RTC_VERSION_STRING;
}

std::vector<PeerBuild> peer_builds(CompareMode mode) {
  std::vector<PeerBuild> all;
  for (std::uint32_t i = 0; i < std::size(kBuilds); ++i)
    if (kBuilds[i].mode == mode) all.push_back({kBuilds[i].name, i});
  return all;
}

std::vector<PeerCall> peer_calls(bool any_hit) {
  std::vector<PeerCall> all;
  for (const EmbreeCall& call : embree_calls())
    all.push_back(
        {any_hit ? call.any_name : call.closest_name, static_cast<std::uint32_t>(all.size())});
  return all;
}

PeerDevice::PeerDevice(std::uint32_t threads) : impl_(std::make_unique<Impl>(threads)) {}
PeerDevice::~PeerDevice() = default;

std::uint64_t PeerDevice::memory_bytes() const {
  return impl_->memory_bytes();
}

PeerScene::PeerScene(PeerDevice& device, const PeerBuild& build)
    : impl_(std::make_unique<Impl>(*device.impl_, kBuilds[build.index])) {}
PeerScene::~PeerScene() = default;

void PeerScene::set_meshes(std::span<const MeshView> meshes) {
  impl_->set(meshes, true);
}

void PeerScene::move_meshes(std::span<const MeshView> meshes) {
  impl_->set(meshes, false);
}

void PeerScene::closest_hit(std::span<const Ray> rays, std::span<Hit> hits, const PeerCall& call) {
  const EmbreeCall& c = embree_calls()[call.index];
  impl_->trace(rays, hits, c.coherent, c.closest);
}

void PeerScene::any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded,
                        const PeerCall& call) {
  const EmbreeCall& c = embree_calls()[call.index];
  impl_->trace(rays, occluded, c.coherent, c.any);
}

}  // namespace raysheaf::app
