// The CPU as a device: implements exec/device.h with the CPU's threads in the CPU's memory.
//
// Loops are divided among the threads that a grid would have, few enough that each takes several
// items.
#pragma once

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "exec/device.h"
#include "exec/executor.h"
#include "exec/stage_clock.h"

namespace raysheaf {

/// Allocates from the heap, with a limit of `capacity` bytes. Thread-safe.
class HostAllocator : public DeviceAllocator {
 public:
  explicit HostAllocator(std::uint64_t capacity = std::uint64_t{1} << 40) : free_(capacity) {}
  HostAllocator(const HostAllocator&) = delete;
  HostAllocator& operator=(const HostAllocator&) = delete;

  [[nodiscard]] void* allocate(const char* stage, std::size_t bytes) override;
  void free(void* memory) noexcept override;
  /// Whether `pointer` points into memory of this allocator.
  [[nodiscard]] bool owns(const void* pointer) const;
  [[nodiscard]] std::uint64_t free_bytes() const;
  /// Bytes that devices have copied here from other memory.
  [[nodiscard]] std::uint64_t uploaded_bytes() const { return uploaded_; }
  void count_upload(const void* to, const void* from, std::size_t bytes) {
    if (owns(to) && !owns(from)) uploaded_ += bytes;
  }

  /// Called when a device begins and ends work that accesses the memory, from several threads at
  /// once. No other code may access the memory, which tests check (tests/support/guarded_memory.h).
  virtual void open() {}
  virtual void close() noexcept {}

 protected:
  /// Called from one thread at a time. Throws std::bad_alloc.
  [[nodiscard]] virtual void* take(std::size_t bytes);
  virtual void give_back(void* memory, std::size_t bytes) noexcept;

 private:
  mutable std::mutex mutex_;
  std::uint64_t free_;
  std::map<const std::uint8_t*, std::size_t> sizes_;  // by where they begin
  std::atomic<std::uint64_t> uploaded_{0};
};

/// A stream of a caller: its work runs only when somebody waits for it.
class EmulatedStream {
 public:
  void ask(std::function<void()> work) { works_.push_back(std::move(work)); }
  void finish() {
    for (const std::function<void()>& work : std::exchange(works_, {})) work();
  }

 private:
  std::vector<std::function<void()>> works_;
};

class EmulatedUplink;
class EmulatedDownlink;
class EmulatedGlBuffer;

class EmulatedDevice {
 public:
  using Uplink = EmulatedUplink;
  using Downlink = EmulatedDownlink;
  using GlBuffer = EmulatedGlBuffer;
  static constexpr std::size_t kMeasuredBytes = std::size_t{1} << 22;
  static constexpr std::size_t kMeasuredItems = std::size_t{1} << 12;

  /// All arguments outlive the device. `allocator` takes its memory from `memory`, and replaces it.
  /// `most_blocks`: the maximum per loop.
  EmulatedDevice(const Executor& executor, HostAllocator& memory,
                 DeviceAllocator* allocator = nullptr, std::uint32_t most_blocks = 64)
      : executor_(executor),
        memory_(memory),
        allocator_(allocator != nullptr ? *allocator : memory),
        most_blocks_(most_blocks) {}

  template <class Body>
  void for_each(const char* stage, std::size_t count, const Body& body) {
    const Lap lap(*this, stage);
    const LaunchShape shape = launch_shape(count, most_blocks_);
    executor_.for_each(shape.blocks, 1, [&](std::size_t block) {
      for (std::size_t t = block * shape.threads; t < (block + 1) * shape.threads; ++t)
        for_items_of_thread(t, shape.stride(), count, body);
    });
  }

  void exclusive_scan(const char* stage, View<const std::uint32_t> in, View<std::uint64_t> out);
  [[nodiscard]] std::uint32_t select(const char* stage, View<const std::uint8_t> flags,
                                     View<std::uint32_t> out);
  void sort_pairs(const char* stage, SortColumns<std::uint32_t>* columns, BitRange bits);
  void sort_pairs(const char* stage, SortColumns<std::uint64_t>* columns, BitRange bits);
  void sort_keys(const char* stage, SortColumns<std::uint64_t>* columns, BitRange bits);
  [[nodiscard]] std::uint32_t run_lengths(const char* stage, View<const std::uint32_t> keys,
                                          RunColumns out);

  template <class T>
  void fill(const char* stage, View<T> view, std::uint8_t byte) {
    const Lap lap(*this, stage);
    if (!view.empty()) std::memset(static_cast<void*>(view.data), byte, view.size * sizeof(T));
  }
  void copy(const char* stage, void* to, const void* from, std::size_t bytes) {
    const Lap lap(*this, stage);
    if (bytes == 0) return;
    memory_.count_upload(to, from, bytes);
    std::memcpy(to, from, bytes);
  }
  template <class T>
  [[nodiscard]] T read(const char* stage, const T* place) {
    const Lap lap(*this, stage);
    return *place;
  }
  void synchronize(const char* /*stage*/) {}
  void start_clock(const char* /*stage*/) { clock_start_ = Clock::now(); }
  [[nodiscard]] double stop_clock(const char* /*stage*/) { return ms_since(clock_start_); }
  [[nodiscard]] bool is_device_memory(const void* pointer, const char* /*name*/) const {
    return memory_.owns(pointer);
  }
  /// `stream`: an EmulatedStream, or null.
  void wait_for(const char* stage, void* stream) {
    const Lap lap(*this, stage);
    if (stream != nullptr) static_cast<EmulatedStream*>(stream)->finish();
  }
  [[nodiscard]] DeviceAllocator& allocator() { return allocator_; }
  [[nodiscard]] std::uint64_t free_bytes() const { return memory_.free_bytes(); }
  [[nodiscard]] bool reads_host_memory() const { return true; }
  [[nodiscard]] std::string name() const { return "the CPU, emulating a device"; }

  /// Starts or stops keeping times.
  void keep_times(bool keep) {
    keeps_times_ = keep;
    times_.clear();
  }
  /// The times of the stages since `keep_times`.
  [[nodiscard]] std::vector<StageTime> times() { return times_; }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] static double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }

  /// Measures a verb and marks the memory as accessed meanwhile.
  class Lap {
   public:
    Lap(EmulatedDevice& device, const char* stage) : device_(device), stage_(stage) {
      device_.memory_.open();
    }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;
    ~Lap() {
      device_.memory_.close();
      if (device_.keeps_times_) add_stage_time(stage_, ms_since(start_), &device_.times_);
    }

   private:
    EmulatedDevice& device_;
    const char* stage_;
    Clock::time_point start_ = Clock::now();
  };

  template <class Key>
  void sort(const char* stage, SortColumns<Key>* columns, BitRange bits);

  const Executor& executor_;
  HostAllocator& memory_;
  DeviceAllocator& allocator_;
  std::uint32_t most_blocks_;
  bool keeps_times_ = false;
  std::vector<StageTime> times_;
  Clock::time_point clock_start_ = Clock::now();
};

}  // namespace raysheaf
