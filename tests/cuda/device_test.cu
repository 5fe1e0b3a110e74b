// The verbs of a device, on the device that there is; and what is said where there is none.
#include "exec/cuda/launch-inl.h"
#include "tests/exec/device_properties.h"

namespace raysheaf::test {
namespace {

bool there_is_a_device() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

TEST(CudaDevice, KeepsWhatDevicesPromise) {
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

}  // namespace
}  // namespace raysheaf::test
