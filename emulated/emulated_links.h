// The links of an emulated device (exec/links.h). Each copy happens as late as allowed, so that
// code that does not wait for it finds the old content.
#pragma once

#include <cstddef>
#include <vector>

#include "emulated/emulated_device.h"
#include "exec/links.h"

namespace raysheaf {

class EmulatedUplink {
 public:
  explicit EmulatedUplink(EmulatedDevice& device) : device_(device) {}
  EmulatedUplink(const EmulatedUplink&) = delete;
  EmulatedUplink& operator=(const EmulatedUplink&) = delete;

  [[nodiscard]] std::byte* room(const char* stage, std::size_t bytes);
  void send(const char* stage, void* to, std::size_t bytes);
  void see(const char* stage);
  void done_with(const char* stage) { turns_.done_with(stage); }

 private:
  void arrive(const char* stage);

  EmulatedDevice& device_;
  UplinkTurns turns_;
  std::vector<std::byte> room_;
  void* to_ = nullptr;  // null: no copy is pending
  std::size_t bytes_ = 0;
};

class EmulatedDownlink {
 public:
  explicit EmulatedDownlink(EmulatedDevice& device) : device_(device) {}
  EmulatedDownlink(const EmulatedDownlink&) = delete;
  EmulatedDownlink& operator=(const EmulatedDownlink&) = delete;

  /// The emulated device has finished its work when a verb returns, so this copies at once.
  void ask(const char* stage, const void* from, std::size_t bytes);
  [[nodiscard]] const std::byte* wait(const char* /*stage*/) const { return room_.data(); }

 private:
  EmulatedDevice& device_;
  std::vector<std::byte> room_;
};

}  // namespace raysheaf
