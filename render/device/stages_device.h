// The stages of a frame on a given type of device; for the sources that create them.
#pragma once

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "base/bits.h"
#include "exec/stopwatch.h"
#include "render/device/cutouts_device.h"
#include "render/device/gl_link_device.h"
#include "render/device/light_loops_device.h"
#include "render/device/placing_device.h"
#include "render/device/resolve_loops_device.h"
#include "render/device/sets_device.h"
#include "render/device/shared_groups.h"
#include "scene/cutout.h"

namespace raysheaf {

template <class Device>
class DeviceStagesOn : public DeviceStages {
 public:
  /// The arguments construct the device.
  template <class... Args>
  explicit DeviceStagesOn(Args&&... args)
      : scene_(std::forward<Args>(args)...),
        device_(scene_.engine().device()),
        sets_(device_),
        batches_(scene_.engine()),
        cutouts_(device_, batches_),
        film_(device_),
        gl_link_(device_),
        resolver_(device_) {}

  void forget_scene(const FlatUpdate& update) override { scene_.forget(update); }
  void set_scene(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
                 const EnvironmentView& environment) override {
    scene_.set(executor, scene, textures, environment);
  }
  [[nodiscard]] std::optional<Box> place(const FlatScene& scene, View<const std::uint32_t> places,
                                         View<const MeshPose> poses) override {
    return scene_.place(scene, places, poses);
  }
  [[nodiscard]] std::vector<Sphere> shape_bounds(const FlatScene& scene,
                                                 View<const std::uint32_t> meshes) override {
    return scene_.bound(scene, meshes);
  }
  [[nodiscard]] bool has_scene() const override { return scene_.is_there(); }
  [[nodiscard]] bool draws_there() const override { return gl_link_.shares(); }
  [[nodiscard]] TriangleList triangles() const override { return scene_.triangles(); }

  void begin(const DeviceFrameInput& input) override {
    input_ = &input_place_.emplace(input);
    batches_.begin(*input_);
    upload(device_, input.lights, &lights_);
    film_.begin(input.options.width, input.options.height, input.options.count_pixel_tests);
    sharing_ = SharedGroups::among(input.ranks, input.options);
    cutouts_.begin({scene_view(), has_cutouts(*scene_.flat().description, input.blends),
                    input.blends, film_.tests()});
  }

  std::size_t look(const CameraFrame& frame) override {
    watch_.lap_ms();
    sample_ = frame.sample;
    const std::size_t pixels = pixel_count();
    triangles_seen_.resize_uninitialized("surfaces: names", pixels);
    if (input_->rasterize) {
      input_->meter.begin("raster", 1);
      const View<const std::uint32_t> seen =
          gl_link_.see(input_->rasterize, frame, pixels, scene_.triangles(), scene_view(),
                       input_->options.gbuffer);
      batches_.tell("device: " + gl_link_.way() + "; rays, hits and light stay there");
      resolver_.resolve(scene_.triangles(), bounds(), frame, seen, triangles_seen_.view());
      if (cutouts_.any()) {
        const auto of_rays = [this] { return &input_->tally.batch(RayKind::kPrimary, 0); };
        batches_.make_camera_rays(frame, bounds());
        cutouts_.see_through(Facing::kSkipBackOfSingleSided, kBounceKeyBits, triangles_seen_.data(),
                             of_rays);
      }
    } else {
      batches_.tell("device: rays, hits and light stay there");
      BatchStatistics& statistics = input_->tally.batch(RayKind::kPrimary, 0);
      batches_.make_camera_rays(frame, bounds());
      lap(&statistics.times_ms.raygen);
      const IndexedHit* const hits =
          cutouts_.closest({Facing::kSkipBackOfSingleSided, kBounceKeyBits, {}, {}}, &statistics);
      triangles_of_hits_on(device_, View<const IndexedHit>(hits, pixels), triangles_seen_.data());
    }
    input_->meter.begin("surfaces", 1);
    first_hits_ = sets_.make("surfaces: first", pixels);
    first_fragments_on(device_, scene_view(), frame, triangles_seen_.data(),
                       first_hits_->fragments.view());
    film_.see(first_hits_->view());
    lap(&input_->tally.statistics.raster_ms);
    return sharing_ == nullptr ? 1 : sharing_->parts();
  }

  void follow_groups(std::size_t count, const FollowGroup& follow) override {
    const auto follow_one = [&](std::size_t group) {
      follow(*this, input_->meter, group);
      input_->tally.keep_plans(sample_.index * count + group);
    };
    if (sharing_ == nullptr) return follow_one(0);
    sharing_->follow_parts(sample_.index, follow_one, &input_->tally);
  }

  Set see(std::size_t group) override {
    if (sharing_ == nullptr) return std::move(first_hits_);
    const auto [begin, end] = sharing_->take_pixels(group);
    return sets_.part("surfaces: first", *first_hits_, begin, end);
  }

  Vec3 find_sky() override {
    const View<const Fragment> fragments = first_hits_->view();
    std::vector<SkyPart> parts(div_ceil(fragments.size, kSkyPart));
    sky_parts_.resize_uninitialized("shade: sky", parts.size());
    sky_parts_on(device_, fragments, lights_.view_const(), sky_parts_.view());
    device_.copy("shade: sky", parts.data(), sky_parts_.data(), parts.size() * sizeof parts[0]);
    lap(&input_->tally.statistics.shade_ms);
    return sky_of_parts(View<const SkyPart>(parts));
  }

  void glow(FragmentSet& set, const GlowInput& input) override {
    DeviceSet& s = of(set);
    watch_.lap_ms();
    s.radiance.resize_uninitialized("shade: glow", s.count);
    s.going_on.resize_uninitialized("shade: glow", input.last ? 0 : s.count);
    glow_on(device_, s.view(), input, scene_.environment(), s.radiance.data(),
            input.last ? nullptr : s.going_on.data());
    lap(&input_->tally.statistics.shade_ms);
  }

  std::uint32_t add_lights(FragmentSet& set, std::uint32_t bounce, std::uint32_t first) override {
    const std::size_t left = lights_.size() - first;
    const std::size_t count = std::clamp<std::size_t>(kMostDeviceSlots / set.size(), 1, left);
    add_what_arrives(of(set), bounce,
                     LightsSeen{lights_.view_const().slice(first, count), first,
                                static_cast<std::uint32_t>(lights_.size()), sample_},
                     bounce == 1);
    return static_cast<std::uint32_t>(count);
  }

  void add_environment(FragmentSet& set, std::uint32_t bounce) override {
    const EnvironmentView& sky = scene_.environment();
    if (sky.radiance != nullptr) add_what_arrives(of(set), bounce, SkySeen{sky, sample_}, false);
  }

  void deposit(const FragmentSet& set) override {
    watch_.lap_ms();
    deposit_on(device_, of(set).view(), of(set).radiance.data(), film_.view().beauty);
    lap(&input_->tally.statistics.shade_ms);
  }

  Set follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) override {
    const DeviceSet& s = of(set);
    watch_.lap_ms();
    flags_.resize_uninitialized("raygen: bounce", s.count);
    slots_.resize_uninitialized("raygen: bounce", s.count);
    flag_kind_on(device_, s.going_on.view_const(), bit_of(kind), flags_.data());
    const std::uint32_t count =
        device_.select("raygen: bounce", flags_.view_const(), slots_.view());
    if (count == 0) return nullptr;
    const View<const std::uint32_t> slots(slots_.data(), count);
    Ray* const rays = batches_.rays("raygen: bounce", count);
    weights_.resize_uninitialized("raygen: bounce", count);
    bounce_rays_on(device_, s.view(), slots, kind, bounds(),
                   {rays, weights_.data(), batches_.keys("raygen: bounce")});
    BatchStatistics& statistics = input_->tally.batch(kind, bounce);
    lap(&statistics.times_ms.raygen);
    const IndexedHit* const hits =
        cutouts_.closest({Facing::kBoth, kBounceKeyBits, s.view(), slots}, &statistics);
    watch_.lap_ms();
    auto arrived = sets_.make("surfaces: bounce", count);
    arrived_on(device_, scene_view(), s.view(),
               {slots, rays, weights_.data(), hits, static_cast<std::uint32_t>(kind)},
               arrived->fragments.data());
    lap(&input_->tally.statistics.shade_ms);
    return arrived;
  }

  Set merged(Set a, Set b) override {
    watch_.lap_ms();
    auto all =
        sets_.merged(of(*a), of(*b), static_cast<std::uint32_t>(std::bit_width(pixel_count() - 1)));
    lap(&input_->tally.statistics.shade_ms);
    return all;
  }

  Set split_off(FragmentSet& set, std::size_t first) override {
    DeviceSet& s = of(set);
    auto rest = sets_.part("order: fragments", s, first, s.count);
    s.count = first;
    return rest;
  }

  FilmSums film(bool /*taken*/) override {
    FilmSums sums = film_.sums(input_->executor, scene_.flat());
    if (sharing_ != nullptr) sharing_->unite(&sums);
    if (input_->options.gbuffer) sums.result.gbuffer = gl_link_.gbuffer();
    return sums;
  }

 private:
  static DeviceSet& of(FragmentSet& set) { return static_cast<DeviceSet&>(set); }
  static const DeviceSet& of(const FragmentSet& set) { return static_cast<const DeviceSet&>(set); }

  [[nodiscard]] std::size_t pixel_count() const {
    return std::size_t{input_->options.width} * input_->options.height;
  }
  [[nodiscard]] StagedSceneView scene_view() const { return scene_.view(); }
  [[nodiscard]] const Box& bounds() const { return scene_.flat().bounds; }

  /// Waits for the device, and adds the time since the last lap.
  void lap(double* ms) {
    device_.synchronize("stages");
    *ms += watch_.lap_ms();
  }

  /// Adds the light that reaches the fragments to their radiance. `counts`: the fragments are
  /// primary hits, for which the film counts lights.
  template <class Lights>
  void add_what_arrives(DeviceSet& set, std::uint32_t bounce, const Lights& lights, bool counts) {
    const std::size_t slots = lights.size() * set.count;
    check_item_count("raygen: shadow", slots);
    watch_.lap_ms();
    visibility_.resize_uninitialized("shade: visibility", slots);
    flags_.resize_uninitialized("raygen: shadow", slots);
    slots_.resize_uninitialized("raygen: shadow", slots);
    facing_on(device_, set.view(), lights, flags_.data());
    const std::uint32_t rays = device_.select("raygen: shadow", flags_.view_const(), slots_.view());
    const View<const std::uint32_t> chosen(slots_.data(), rays);
    device_.fill("shade: visibility", visibility_.view(),
                 static_cast<std::uint8_t>(Visibility::kNoRay));
    const std::uint8_t* const occluded = cast_shadows(set, bounce, lights, chosen);
    visibility_on(device_, chosen, occluded, visibility_.data());
    lights_on(device_, set.view(), lights, visibility_.data(), set.radiance.data(), counts,
              film_.view());
    lap(&input_->tally.statistics.shade_ms);
  }

  /// Returns for each of `slots` whether anything is between fragment and light.
  template <class Lights>
  const std::uint8_t* cast_shadows(const DeviceSet& set, std::uint32_t bounce, const Lights& lights,
                                   View<const std::uint32_t> slots) {
    if (!input_->options.shadows) return batches_.unoccluded(slots.size);
    const LightReach reach = light_reach(bounds());
    Ray* const rays = batches_.rays("raygen: shadow", slots.size);
    std::uint32_t* const keys = batches_.keys("raygen: shadow");
    shadow_rays_on(device_, set.view(), lights, slots, reach, rays, keys);
    BatchStatistics& statistics = input_->tally.batch(RayKind::kShadow, bounce);
    lap(&statistics.times_ms.raygen);
    if (slots.empty()) return nullptr;
    const BatchOnDevice batch{Facing::kBoth, lights.layout().key_bits(), set.view(), slots};
    const std::uint8_t* const occluded = cutouts_.occluded(batch, &statistics);
    watch_.lap_ms();
    return occluded;
  }

  SceneThere<Device> scene_;
  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceSets<Device> sets_;
  DeviceBatches<Device> batches_;
  DeviceCutouts<Device> cutouts_;
  FilmOnDevice<Device> film_;
  GlLink<Device> gl_link_;
  ResolverOn<Device> resolver_;
  std::optional<DeviceFrameInput> input_place_;
  const DeviceFrameInput* input_ = nullptr;
  SampleOf sample_;
  std::unique_ptr<DeviceSet> first_hits_;  ///< until `see` returns them
  std::unique_ptr<SharedGroups> sharing_;  ///< with other processes; null: this is the only one
  Stopwatch watch_;

  DeviceBuffer<PlacedLight> lights_{memory_};
  // For one batch.
  DeviceBuffer<std::uint32_t> triangles_seen_{memory_}, slots_{memory_};
  DeviceBuffer<std::uint8_t> flags_{memory_}, visibility_{memory_};
  DeviceBuffer<Vec3> weights_{memory_};
  DeviceBuffer<SkyPart> sky_parts_{memory_};
};

}  // namespace raysheaf
