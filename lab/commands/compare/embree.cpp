// Embree's devices, scenes and builds.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <mutex>

#include "lab/commands/compare/calls.h"
#include "lab/commands/compare/embree_library.h"
#include "lab/commands/compare/peer.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

/// Treats denormals as zero during its lifetime, as Embree's manual requires. The threads of other
/// libraries do not keep this setting.
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

/// The quality of the whole scene and of its geometries. A dynamic scene has one tree per geometry
/// and one over the geometries; other scenes have one tree over all triangles, if Embree has such a
/// builder.
struct EmbreeBuild {
  const char* name;
  embree::Quality scene, geometry;
  bool dynamic;
  CompareMode mode;
};

constexpr embree::Quality kLow = embree::Quality::kLow, kMedium = embree::Quality::kMedium,
                          kHigh = embree::Quality::kHigh;

constexpr EmbreeBuild kBuilds[] = {
    {"LOW", kLow, kLow, false, CompareMode::kRebuild},
    {"LOW dynamic", kLow, kLow, true, CompareMode::kRebuild},
    {"MEDIUM", kMedium, kMedium, false, CompareMode::kRebuild},
    {"MEDIUM dynamic", kMedium, kMedium, true, CompareMode::kRebuild},
    {"REFIT", kLow, embree::Quality::kRefit, true, CompareMode::kRefit},
    {"HIGH", kHigh, kHigh, false, CompareMode::kStatic},
    {"MEDIUM", kMedium, kMedium, false, CompareMode::kStatic},
};

const EmbreeBuild& best_build() {
  return *std::find_if(std::begin(kBuilds), std::end(kBuilds),
                       [](const EmbreeBuild& build) { return build.scene == kHigh; });
}

/// 40400 is "4.4.0".
std::string version_text(ssize_t version) {
  return std::to_string(version / 10'000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

}  // namespace

class PeerDevice::Impl {
 public:
  Impl(const EmbreeLibrary& library, std::uint32_t threads)
      : api_(library.api),
        device_(api_.new_device(("threads=" + std::to_string(threads)).c_str())),
        arena_(static_cast<int>(threads)) {
    if (device_ == nullptr)
      throw Error(ErrorCode::kInternal, "'" + library.file + "' has no device", "Embree");
    const ssize_t version = api_.device_property(device_, embree::DeviceProperty::kVersion);
    version_ = version_text(version);
    api_.major_version = static_cast<int>(version / 10'000);
    const bool known =
        api_.major_version == 4 || (api_.major_version == 3 && api_.intersect.stream_3 != nullptr &&
                                    api_.occluded.stream_3 != nullptr);
    if (!known) {
      api_.release_device(device_);
      throw Error(ErrorCode::kUnsupported,
                  "'" + library.file + "' is Embree " + version_ +
                      ", but only Embree 3 and 4 are supported",
                  "Embree");
    }
    api_.set_error_function(device_, remember, this);
    api_.set_memory_function(device_, count, this);
  }
  ~Impl() { api_.release_device(device_); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const embree::Api& api() const { return api_; }
  [[nodiscard]] embree::Device device() const { return device_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  [[nodiscard]] oneapi::tbb::task_arena& arena() { return arena_; }
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_));
  }

  /// Throws the error of the calls since the last check.
  void check() {
    const std::lock_guard lock(mutex_);
    if (failure_ == embree::Failure::kNone) return;
    const ErrorCode code =
        failure_ == embree::Failure::kOutOfMemory ? ErrorCode::kOutOfMemory : ErrorCode::kInternal;
    failure_ = embree::Failure::kNone;
    throw Error(code, message_, "Embree " + version_);
  }

 private:
  static void remember(void* self, embree::Failure failure, const char* message) {
    auto& impl = *static_cast<Impl*>(self);
    const std::lock_guard lock(impl.mutex_);
    impl.failure_ = failure;
    impl.message_ = message != nullptr ? message : "an error without a name";
  }
  static bool count(void* self, ssize_t bytes, bool) {
    static_cast<Impl*>(self)->bytes_ += bytes;
    return true;
  }

  std::atomic<std::int64_t> bytes_ = 0;
  std::mutex mutex_;
  embree::Failure failure_ = embree::Failure::kNone;
  std::string message_, version_;
  embree::Api api_;
  embree::Device device_;
  oneapi::tbb::task_arena arena_;
};

class PeerScene::Impl {
 public:
  Impl(PeerDevice::Impl& device, const EmbreeBuild& build)
      : device_(device),
        api_(device.api()),
        build_(build),
        scene_(api_.new_scene(device.device())) {
    api_.set_scene_quality(scene_, build.scene);
    api_.set_scene_flags(scene_,
                         build.dynamic ? embree::SceneFlag::kDynamic : embree::SceneFlag::kNone);
    device_.check();
  }
  ~Impl() {
    for (embree::Geometry geometry : geometries_) api_.release_geometry(geometry);
    api_.release_scene(scene_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void instance(Impl& mesh, std::size_t count) {
    while (geometries_.size() < count) {
      add(embree::GeometryType::kInstance);
      api_.set_instanced_scene(geometries_.back(), mesh.scene_);
    }
  }
  void move(std::span<const Affine> transforms) {
    const FlushedDenormals flushed;
    for (std::size_t i = 0; i < transforms.size(); ++i) {
      api_.set_transform(geometries_[i], 0, embree::Format::kFloat3x4RowMajor,
                         transforms[i].m.data());
      api_.commit_geometry(geometries_[i]);
    }
    api_.commit_scene(scene_);
    device_.check();
  }

  void set(std::span<const MeshView> meshes, bool indices_too) {
    const FlushedDenormals flushed;
    while (geometries_.size() < meshes.size()) add(embree::GeometryType::kTriangle);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      embree::Geometry geometry = geometries_[i];
      api_.share_buffer(geometry, embree::Buffer::kVertex, 0, embree::Format::kFloat3,
                        meshes[i].positions.data(), 0, sizeof(Vec3), meshes[i].positions.size());
      if (indices_too)
        api_.share_buffer(geometry, embree::Buffer::kIndex, 0, embree::Format::kUint3,
                          meshes[i].triangles.data(), 0, 3 * sizeof(std::uint32_t),
                          meshes[i].triangles.size());
      api_.commit_geometry(geometry);
    }
    api_.commit_scene(scene_);
    device_.check();
  }

  template <class Out, class Call>
  void trace(std::span<const Ray> rays, std::span<Out> out, bool coherent, const Call& call) {
    device_.arena().execute([&] {
      using Range = oneapi::tbb::blocked_range<std::size_t>;
      const std::size_t tasks = (rays.size() + kRaysATask - 1) / kRaysATask;
      oneapi::tbb::parallel_for(Range(0, tasks, 1), [&](const Range& range) {
        const FlushedDenormals flushed;
        EmbreeQuestion question(api_, scene_, coherent);
        for (std::size_t task = range.begin(); task < range.end(); ++task) {
          const std::size_t first = task * kRaysATask;
          const std::size_t count = std::min(kRaysATask, rays.size() - first);
          call(question, rays.subspan(first, count), out.subspan(first, count));
        }
      });
    });
    device_.check();
  }

  [[nodiscard]] PeerDevice::Impl& device() { return device_; }

 private:
  void add(embree::GeometryType type) {
    embree::Geometry geometry = api_.new_geometry(device_.device(), type);
    api_.set_geometry_quality(geometry, build_.geometry);
    api_.attach(scene_, geometry, static_cast<unsigned>(geometries_.size()));
    geometries_.push_back(geometry);
  }

  PeerDevice::Impl& device_;
  const embree::Api& api_;
  const EmbreeBuild& build_;
  embree::Scene scene_;
  std::vector<embree::Geometry> geometries_;
};

std::vector<PeerBuild> peer_builds(CompareMode mode) {
  std::vector<PeerBuild> all;
  for (std::uint32_t i = 0; i < std::size(kBuilds); ++i)
    if (kBuilds[i].mode == mode) all.push_back({kBuilds[i].name, i});
  return all;
}

std::vector<std::unique_ptr<PeerDevice>> open_peers(std::uint32_t threads) {
  std::vector<std::unique_ptr<PeerDevice>> all;
  for (const EmbreeLibrary& library : find_embree())
    all.push_back(std::make_unique<PeerDevice>(library, threads));
  return all;
}

PeerDevice::PeerDevice(const EmbreeLibrary& library, std::uint32_t threads)
    : impl_(std::make_unique<Impl>(library, threads)) {}
PeerDevice::~PeerDevice() = default;

const std::string& PeerDevice::version() const {
  return impl_->version();
}

std::vector<PeerCall> PeerDevice::calls(bool any_hit) const {
  std::vector<PeerCall> all;
  for (std::uint32_t i = 0; i < embree_calls().size(); ++i) {
    const EmbreeCall& call = embree_calls()[i];
    if (call.stream && impl_->api().major_version != 3) continue;
    all.push_back({any_hit ? call.any_name : call.closest_name, i});
  }
  return all;
}

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

void PeerScene::set_instances(const MeshView& mesh, std::span<const Affine> transforms) {
  mesh_ = std::make_unique<Impl>(impl_->device(), best_build());
  mesh_->set({&mesh, 1}, true);
  impl_->instance(*mesh_, transforms.size());
  impl_->move(transforms);
}

void PeerScene::move_instances(std::span<const Affine> transforms) {
  impl_->move(transforms);
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
