// The backend of a given type of device; for the sources that open one.
#pragma once

#include <string>
#include <tuple>

#include "device/backend.h"
#include "device/measure_device.h"
#include "device/queries_device.h"
#include "out_of_core/block_tracer_device.h"

namespace raysheaf {

/// Everything that it creates has a device of its own, which `Args` construct.
template <class Device, class... Args>
class BackendOn : public DeviceBackend {
 public:
  explicit BackendOn(Args... args) : args_(args...), device_(args...), name_(device_.name()) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::unique_ptr<DeviceQueries> make_queries() const override {
    return make<DeviceQueriesOn<Device>>();
  }
  [[nodiscard]] std::unique_ptr<BlockTracer> make_block_tracer(
      const Executor& executor, const BlockLimits& limits) const override {
    return make<BlockTracerOn<Device>>(executor, limits);
  }
  [[nodiscard]] bool is_device_memory(const void* pointer, const char* name) const override {
    return device_.is_device_memory(pointer, name);
  }
  void write(void* to, const void* from, std::size_t bytes,
             const DeviceQuery& query) const override {
    const std::unique_ptr<Device> device = make<Device>();
    wait_for_streams(*device, query);
    device->copy("copy: hits", to, from, bytes);
  }
  [[nodiscard]] bool reads_host_memory() const override { return device_.reads_host_memory(); }
  [[nodiscard]] DeviceSpeed speed() const override { return measure_speed(*make<Device>()); }

 protected:
  template <class T, class... First>
  [[nodiscard]] std::unique_ptr<T> make(const First&... first) const {
    return std::apply([&](const Args&... args) { return std::make_unique<T>(first..., args...); },
                      args_);
  }

 private:
  std::tuple<Args...> args_;
  Device device_;
  std::string name_;
};

}  // namespace raysheaf
