// A CUDA device: the verbs of exec/device.h as kernels and calls of CUB, in sequence on a stream of
// its own. Each primitive has a small .cu file; exec/cuda/cuda_launch.h launches loops. Each verb
// restores the thread's current device.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exec/device.h"
#include "exec/stage_clock.h"

namespace raysheaf {

class CudaUplink;
class CudaDownlink;
class CudaGlBuffer;
class StreamAllocator;

class CudaDevice {
 public:
  using Uplink = CudaUplink;
  using Downlink = CudaDownlink;
  using GlBuffer = CudaGlBuffer;
  /// The bytes to copy and the threads to run when its speed is measured (device/measure_device.h).
  static constexpr std::size_t kMeasuredBytes = std::size_t{1} << 29;
  static constexpr std::size_t kMeasuredItems = std::size_t{1} << 22;

  /// Device `index` of this process. `allocator`, which must outlive it, replaces the device's own.
  /// Throws Error with CUDA's message if the device does not exist or if this build has no code for
  /// it.
  explicit CudaDevice(int index = 0, DeviceAllocator* allocator = nullptr);
  CudaDevice(const CudaDevice&) = delete;
  CudaDevice& operator=(const CudaDevice&) = delete;
  ~CudaDevice();

  template <class Body>
  void for_each(const char* stage, std::size_t count, const Body& body);
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
    fill_bytes(stage, view.data, view.size * sizeof(T), byte);
  }
  void copy(const char* stage, void* to, const void* from, std::size_t bytes);
  template <class T>
  [[nodiscard]] T read(const char* stage, const T* place) {
    T value;
    copy(stage, &value, place, sizeof value);
    synchronize(stage);
    return value;
  }
  void synchronize(const char* stage);
  void start_clock(const char* stage);
  [[nodiscard]] double stop_clock(const char* stage);
  [[nodiscard]] bool is_device_memory(const void* pointer, const char* name) const;
  [[nodiscard]] DeviceAllocator& allocator() { return *allocator_; }
  [[nodiscard]] std::uint64_t free_bytes() const;
  [[nodiscard]] bool reads_host_memory() const;

  void keep_times(bool keep);
  /// Waits for the device.
  [[nodiscard]] std::vector<StageTime> times();

  /// Orders the work that is queued here from now on after the work already queued on `stream` (a
  /// cudaStream_t, null: the default one). Throws Error (kInvalidArgument) if that stream is being
  /// captured into a graph.
  void wait_for(const char* stage, void* stream);
  /// The product's name and its compute capability.
  [[nodiscard]] const std::string& name() const { return name_; }

  // The device's index, for its links.
  [[nodiscard]] int index() const { return index_; }
  [[nodiscard]] void* stream() const { return stream_.handle; }  ///< a cudaStream_t

 private:
  /// Destroyed with the device, also if the device's constructor throws.
  struct OwnStream {
    explicit OwnStream(int of_device);
    OwnStream(const OwnStream&) = delete;
    OwnStream& operator=(const OwnStream&) = delete;
    ~OwnStream();

    int index;
    void* handle = nullptr;  // a cudaStream_t
  };
  struct Mark;
  /// A verb in progress: makes the device current, and marks its beginning and end if times are
  /// kept.
  class Verb;

  void fill_bytes(const char* stage, void* place, std::size_t bytes, std::uint8_t byte);
  [[nodiscard]] void* scratch(const char* stage, std::size_t bytes);
  /// Memory for a count by CUB.
  [[nodiscard]] std::uint32_t* counter(const char* stage);
  [[nodiscard]] std::uint32_t counted(const char* stage);
  /// Runs `call(temporary, bytes, stream)` of CUB twice; the first call returns how much temporary
  /// memory it needs.
  template <class Call>
  void run_cub(const char* stage, const Call& call);
  template <class Key>
  void sort(const char* stage, SortColumns<Key>* columns, BitRange bits);

  int index_;
  std::string name_;
  OwnStream stream_;
  std::unique_ptr<StreamAllocator> own_allocator_;
  DeviceAllocator* allocator_;
  DeviceBuffer<std::uint8_t> scratch_;
  DeviceBuffer<std::uint32_t> counter_;
  bool keeps_times_ = false;
  std::vector<Mark> marks_;
  void *clock_start_ = nullptr, *clock_stop_ = nullptr;  // cudaEvent_t, created on first use
};

}  // namespace raysheaf
