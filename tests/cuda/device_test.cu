// Tests the operations of the CUDA device, and the error message on a machine without one.
#include <cstring>

#include "exec/cuda/cuda_launch.h"
#include "exec/cuda/cuda_links.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "support/random.h"
#include "tests/exec/device_properties.h"

namespace raysheaf::test {
namespace {

bool there_is_a_device() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

TEST(CudaDevice, KeepsTheContractOfDevices) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device";
  CudaDevice device;
  expect_all_verbs(device);
}

TEST(CudaDevice, SaysInTheWordsOfCudaThatThereIsNone) {
  if (there_is_a_device()) GTEST_SKIP() << "there is a CUDA device";
  try {
    const CudaDevice device;
    FAIL() << "there is a device after all";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
    EXPECT_EQ(error.place(), "CUDA device");
    EXPECT_TRUE(error.sentence().starts_with("CUDA says: ")) << error.sentence();
  }
}

TEST(CudaDevice, SaysWhichStageRanOutOfMemoryAndGoesOn) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device";
  CudaDevice device;
  DeviceBuffer<std::uint8_t> huge(device.allocator());
  try {
    huge.resize_uninitialized("a stage", std::size_t{1} << 50);
    FAIL() << "there was memory";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    EXPECT_EQ(error.place(), "a stage");
  }
  expect_moved_memory(device);
}

/// Triangles and rays for both, and the CPU's answers.
struct Asked {
  std::vector<Vec3> soup;
  std::vector<Ray> rays;
  std::vector<Hit> expected;

  Asked() : rays(6000), expected(rays.size()) {
    Random random(1);
    for (std::uint32_t i = 0; i < 200; ++i) {
      const Vec3 at = random.in_box(4);
      for (int k = 0; k < 3; ++k) soup.push_back(at + random.in_box(1));
    }
    for (Ray& ray : rays) {
      ray.origin = random.in_box(6);
      ray.direction = random.in_box(1);
    }
    Scene scene;
    scene.add_soup(soup);
    scene.commit();
    closest_hit(scene, rays, expected);
  }
};

TEST(CudaDevice, CountsWhatItKeepsAsFree) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device";
  constexpr std::size_t kLarge = std::size_t{1} << 28;
  CudaDevice device;
  {
    DeviceBuffer<std::uint8_t> large(device.allocator());
    large.resize_uninitialized("a stage", kLarge);
  }
  device.synchronize("a stage");
  const std::uint64_t kept = device.free_bytes();
  DeviceBuffer<std::uint8_t> again(device.allocator());
  again.resize_uninitialized("a stage", kLarge);
  // Other programs may allocate and free memory meanwhile.
  EXPECT_GE(kept, device.free_bytes() + kLarge / 2);
}

TEST(CudaDevice, QueriesTakePointersOfTheDeviceAndAStream) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device";
  const Asked asked;
  Scene scene(Context({.device = Device::kCuda}));
  scene.add_soup(asked.soup);
  scene.commit();
  const std::size_t count = asked.rays.size();
  cudaStream_t stream = nullptr;
  Ray* rays = nullptr;
  Hit* hits = nullptr;
  ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
  ASSERT_EQ(cudaMalloc(&rays, count * sizeof(Ray)), cudaSuccess);
  ASSERT_EQ(cudaMalloc(&hits, count * sizeof(Hit)), cudaSuccess);
  ASSERT_EQ(
      cudaMemcpyAsync(rays, asked.rays.data(), count * sizeof(Ray), cudaMemcpyHostToDevice, stream),
      cudaSuccess);
  QueryOptions options;
  options.stream = stream;
  closest_hit(scene, std::span<const Ray>(rays, count), std::span<Hit>(hits, count), options);
  std::vector<Hit> found(count);
  ASSERT_EQ(cudaMemcpy(found.data(), hits, count * sizeof(Hit), cudaMemcpyDeviceToHost),
            cudaSuccess);
  EXPECT_EQ(std::memcmp(found.data(), asked.expected.data(), count * sizeof(Hit)), 0);
  EXPECT_EQ(cudaFree(rays), cudaSuccess);
  EXPECT_EQ(cudaFree(hits), cudaSuccess);
  EXPECT_EQ(cudaStreamDestroy(stream), cudaSuccess);
}

TEST(CudaDevice, DoesNotWaitForAStreamThatIsBeingCaptured) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device";
  CudaDevice device;
  cudaStream_t stream = nullptr;
  ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
  ASSERT_EQ(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), cudaSuccess);
  try {
    device.wait_for("rays", stream);
    ADD_FAILURE() << "it waited";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_EQ(error.place(), "stream");
  }
  cudaGraph_t graph = nullptr;
  EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);  // the capture is still valid
  EXPECT_EQ(cudaGraphDestroy(graph), cudaSuccess);
  EXPECT_EQ(cudaStreamDestroy(stream), cudaSuccess);
}

TEST(CudaDevice, RefusesMemoryOfAnotherDevice) {
  cudaPointerAttributes said{};
  said.type = cudaMemoryTypeDevice;
  said.device = 2;
  EXPECT_TRUE(may_follow(said, 2, "hits"));
  try {
    static_cast<void>(may_follow(said, 0, "hits"));
    FAIL() << "a kernel would have followed it";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_STREQ(error.what(),
                 "hits: lies in the memory of CUDA device 2, and the context is on CUDA device 0");
  }
  said.type = cudaMemoryTypeManaged;  // accessible from every device
  EXPECT_TRUE(may_follow(said, 0, "hits"));
  said.type = cudaMemoryTypeHost;
  EXPECT_FALSE(may_follow(said, 0, "hits"));
}

TEST(CudaError, NamesTheStageAndSaysWhatCudaSays) {
  EXPECT_NO_THROW(check_cuda(cudaSuccess, "a stage"));
  const std::pair<cudaError_t, ErrorCode> errors[] = {
      {cudaErrorMemoryAllocation, ErrorCode::kOutOfMemory},
      {cudaErrorInsufficientDriver, ErrorCode::kUnsupported},
      {cudaErrorNoDevice, ErrorCode::kUnsupported},
      {cudaErrorNoKernelImageForDevice, ErrorCode::kUnsupported},
      {cudaErrorIllegalAddress, ErrorCode::kInternal}};
  for (const auto& [status, code] : errors) {
    try {
      check_cuda(status, "a stage");
      FAIL() << cudaGetErrorName(status);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_EQ(error.place(), "a stage");
      EXPECT_NE(error.sentence().find(cudaGetErrorString(status)), std::string::npos);
    }
  }
}

TEST(CudaError, IgnoredErrorsAreCleared) {
  if (!there_is_a_device()) GTEST_SKIP() << "there is no CUDA device, which is never forgotten";
  EXPECT_NE(cudaSetDevice(-1), cudaSuccess);
  EXPECT_NE(cudaPeekAtLastError(), cudaSuccess);
  ignore_cuda(cudaSetDevice(-1));
  EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess);
}

}  // namespace
}  // namespace raysheaf::test
