// A device that shares memory with OpenGL: it packs the triangles to draw and reads the image.
#include "render/raster/slot_picture.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "exec/executor.h"
#include "pictures.h"
#include "render/raster/pack.h"
#include "render/raster/rasterizer.h"

namespace raysheaf::test {
namespace {

/// The device's data of an OpenGL buffer.
struct Lease {
  unsigned buffer;
  int* gone;
  Lease(unsigned b, int* g) : buffer(b), gone(g) {}
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() {
    EXPECT_EQ(glIsBuffer(buffer), GL_TRUE) << "the buffer went first";
    ++*gone;
  }
};

/// An emulated device: it shares OpenGL's memory as `packs` and `takes` allow.
class HostDevice final : public SlotDevice {
 public:
  HostDevice(const Executor& executor, const FlatScene& scene, bool packs, bool takes)
      : executor_(executor), scene_(scene), packs_(packs), takes_(takes) {}

  std::optional<std::uint32_t> pack(const PackedBatch& batch) override {
    if (!packs_) return std::nullopt;
    keep(batch.corners, &corners_gone);
    const std::uint32_t count =
        packer_.choose(executor_, scene_, batch.view, batch.first, batch.count);
    names_.resize(batch.first_slot + count);
    std::vector<float> corners(std::size_t{kFloatsPerTriangle} * count);
    packer_.pack(executor_, scene_, batch.view, corners.data(), names_.data() + batch.first_slot);
    const auto bytes = static_cast<GLsizeiptr>(corners.size() * sizeof corners[0]);
    void* const to = glMapNamedBufferRange(batch.corners.buffer, 0, bytes, GL_MAP_WRITE_BIT);
    std::memcpy(to, corners.data(), static_cast<std::size_t>(bytes));
    EXPECT_EQ(glUnmapNamedBuffer(batch.corners.buffer), GL_TRUE);
    return count;
  }
  bool take(const SlotPicture& picture) override {
    if (!takes_) return false;
    keep(picture.memory, &pictures_gone);
    EXPECT_EQ(picture.triangle_of_slot.empty(), packs_);
    if (!packs_) names_.assign(picture.triangle_of_slot.begin(), picture.triangle_of_slot.end());
    taken.resize(picture.pixels);
    glGetNamedBufferSubData(picture.memory.buffer, 0, static_cast<GLsizeiptr>(4 * taken.size()),
                            taken.data());
    for (std::uint32_t& pixel : taken)
      pixel = triangle_of_slot(View<const std::uint32_t>(names_), pixel);
    return true;
  }

  std::vector<std::uint32_t> taken;
  static inline int leases = 0, corners_gone = 0, pictures_gone = 0;

 private:
  static void keep(const GlMemory& memory, int* gone) {
    if (const auto* lease = std::any_cast<std::shared_ptr<Lease>>(memory.lease)) {
      EXPECT_EQ((*lease)->buffer, memory.buffer);
    } else {
      *memory.lease = std::make_shared<Lease>(memory.buffer, gone);
      ++leases;
    }
  }

  const Executor& executor_;
  const FlatScene& scene_;
  const bool packs_, takes_;
  TrianglePacker packer_;
  std::vector<std::uint32_t> names_;
};

TEST(SlotDevice, DrawsItsTrianglesAndTakesThePicture) {
  RAYSHEAF_GRAPHICS_OR_SKIP();
  auto rasterizer = std::make_unique<Rasterizer>();
  const Executor executor(2);
  for (const std::uint32_t size : {9u, 40u, 40u, 17u, 64u}) {  // images and corners grow twice
    const MadeScene scene = soup(10 * size, 0.5f, 7, {0, 0, -3});
    const CameraFrame frame = make_camera_frame({}, size, size + 3);
    const auto expected = rasterizer->visible_triangles(executor, scene, frame);
    EXPECT_TRUE(std::ranges::any_of(expected, [](std::uint32_t id) { return id != kInvalidId; }));
    for (const bool packs : {false, true}) {
      HostDevice device(executor, scene, packs, true), refusing(executor, scene, packs, false);
      EXPECT_EQ(rasterizer->visible_triangles(executor, scene, frame, &device),
                std::vector<std::uint32_t>());
      EXPECT_EQ(device.taken, expected);
      EXPECT_EQ(rasterizer->visible_triangles(executor, scene, frame, &refusing), expected);
    }
  }
  EXPECT_EQ(HostDevice::leases, 6);
  EXPECT_EQ(HostDevice::pictures_gone, 2);
  EXPECT_EQ(HostDevice::corners_gone, 2);
  rasterizer.reset();
  EXPECT_EQ(HostDevice::pictures_gone, 3);
  EXPECT_EQ(HostDevice::corners_gone, 3);
}

}  // namespace
}  // namespace raysheaf::test
