// Batches of a frame's rays on a given type of device: tracing in place, counts, times. For the
// sources that create its stages.
#pragma once

#include <string>
#include <utility>

#include "device/queries_device.h"
#include "render/device/device_batch_tracer.h"
#include "render/device/frame_stages.h"
#include "render/device/stage_loops_device.h"
#include "render/rays/raygen.h"

namespace raysheaf {

template <class Device>
class DeviceBatches {
 public:
  /// `engine` must outlive this object; it holds the triangles.
  explicit DeviceBatches(DeviceQueriesOn<Device>& engine)
      : engine_(engine), device_(engine.device()) {}

  /// `input` must not change until the next call.
  void begin(const DeviceFrameInput& input) { input_ = &input; }

  /// Sets the sentence that the plans of later batches begin with.
  void tell(std::string where_all_is) { where_all_is_ = std::move(where_all_is); }

  /// Makes room for the rays of the next batch.
  [[nodiscard]] Ray* rays(const char* stage, std::size_t count) {
    rays_.resize_uninitialized(stage, count);
    return rays_.data();
  }
  /// Makes room for their keys; null if the method has none.
  [[nodiscard]] std::uint32_t* keys(const char* stage) {
    const bool sorts = orders_rays() && input_->method.key != RayKey::kRaster;
    keys_.resize_uninitialized(stage, sorts ? rays_.size() : 0);
    return sorts ? keys_.data() : nullptr;
  }

  /// The camera's rays, one for each pixel.
  void make_camera_rays(const CameraFrame& frame, const Box& bounds) {
    Ray* const of_pixels = rays("raygen: camera", std::size_t{frame.width} * frame.height);
    camera_rays_on(device_, frame, bounds, of_pixels, keys("raygen: camera"));
  }

  [[nodiscard]] View<const Ray> all_rays() const { return rays_.view_const(); }
  [[nodiscard]] View<const std::uint32_t> all_keys() const { return keys_.view_const(); }
  /// Exchanges the current batch.
  void swap(DeviceBuffer<Ray>* rays, DeviceBuffer<std::uint32_t>* keys) {
    rays_.swap(*rays);
    keys_.swap(*keys);
  }

  /// The closest hits of the rays, valid until the next batch.
  const IndexedHit* closest(Facing facing, std::uint32_t key_bits, BatchStatistics* statistics) {
    begin_batch(statistics);
    QueryReport report;
    find_closest({facing, key_bits}, &report, statistics);
    count_found_on(device_, hits_.view_const(), found_.data());
    finish_batch(report, statistics);
    return hits_.data();
  }

  /// 1 for each ray that hits anything, else 0; valid until the next batch.
  std::uint8_t* occluded(std::uint32_t key_bits, BatchStatistics* statistics) {
    begin_batch(statistics);
    occluded_.resize_uninitialized("trace: any hits", rays_.size());
    QueryReport report;
    if (orders_rays()) {
      find_closest({Facing::kBoth, key_bits, input_->options.early_out}, &report, statistics);
      occluded_by_hits_on(device_, hits_.view_const(), occluded_.data());
    } else {
      engine_.any_hit(rays_.view_const(), query(Facing::kBoth, statistics->kind, &report),
                      occluded_.view());
    }
    count_occluded_on(device_, occluded_.view_const(), found_.data());
    finish_batch(report, statistics);
    return occluded_.data();
  }

  /// The tests of the last batch's rays, if pixels' tests are counted.
  [[nodiscard]] RayTests tests() const {
    if (is_brute()) return {nullptr, engine_.triangles().count()};
    return {ray_tests_.data(), 0};
  }

  /// The answer for `count` rays that hit nothing.
  const std::uint8_t* unoccluded(std::size_t count) {
    occluded_.resize_uninitialized("trace: any hits", count);
    device_.fill("trace: any hits", occluded_.view(), 0);
    return occluded_.data();
  }

 private:
  [[nodiscard]] bool orders_rays() const { return input_->ordered != nullptr; }
  [[nodiscard]] bool is_brute() const { return input_->options.method == Method::kBrute; }

  [[nodiscard]] DeviceQuery query(Facing facing, RayKind kind, QueryReport* report) {
    DeviceQuery query;
    query.facing = facing;
    query.brute = is_brute();
    if (input_->options.count_pixel_tests && !query.brute) {
      ray_tests_.resize_uninitialized("count: pixels", rays_.size());
      query.ray_tests = ray_tests_.view();
    }
    query.count = true;
    query.in_order = entry_of(kind).in_order;
    query.report = report;
    return query;
  }

  struct Closest {
    Facing facing = Facing::kBoth;
    std::uint32_t key_bits = 32;
    bool early_out = false;  ///< any hit suffices
  };

  void find_closest(const Closest& ask, QueryReport* report, BatchStatistics* statistics) {
    hits_.resize_uninitialized("trace: closest hits", rays_.size());
    if (!orders_rays())
      return engine_.closest_hit(rays_.view_const(), query(ask.facing, statistics->kind, report),
                                 hits_.view());
    device_.synchronize("trace: closest hits");  // the tracer uses another stream
    const BatchOptions options{input_->method, ask.facing, 0, ask.early_out};
    input_->ordered->trace(rays_.view_const(), keys_.view_const(), ask.key_bits, options,
                           hits_.view(), statistics, report);
  }

  void begin_batch(BatchStatistics* statistics) {
    input_->meter.begin(stage_name(statistics->kind, statistics->bounce), 1);
    statistics->rays += rays_.size();
    found_.resize_uninitialized("count", 1);
    device_.fill("count", found_.view(), 0);
  }
  void finish_batch(const QueryReport& report, BatchStatistics* statistics) {
    statistics->hits += device_.read("count", found_.data());
    statistics->plan.push_back(where_all_is_);
    add_engine_report(report, 0, statistics);
  }

  DeviceQueriesOn<Device>& engine_;
  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  const DeviceFrameInput* input_ = nullptr;
  std::string where_all_is_;
  DeviceBuffer<Ray> rays_{memory_};
  DeviceBuffer<std::uint32_t> keys_{memory_};
  DeviceBuffer<IndexedHit> hits_{memory_};
  DeviceBuffer<std::uint8_t> occluded_{memory_};
  DeviceBuffer<std::uint64_t> found_{memory_};
  DeviceBuffer<float> ray_tests_{memory_};
};

}  // namespace raysheaf
