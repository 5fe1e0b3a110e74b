#include "render/raster/rasterizer.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "exec/executor.h"
#include "raysheaf/error.h"
#include "render/raster/egl_context.h"
#include "render/raster/pack.h"
#include "render/raster/visibility_pass.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

/// Triangles per draw call: limits the memory for corners to 36 MiB.
constexpr std::uint32_t kBatch = 1u << 20;
constexpr std::size_t kPixelGrain = 1u << 14;

std::string words(GLenum name) {
  const GLubyte* const text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "unknown";
}

/// Unmaps the corners if an exception leaves them mapped.
struct MappingGuard {
  VisibilityPass& pass;
  ~MappingGuard() { pass.discard(); }
};

}  // namespace

class Rasterizer::Impl {
 public:
  Impl() {
    const EglContext::Current current(context_);
    description_ = words(GL_RENDERER) + ", OpenGL " + words(GL_VERSION);
    pass_ = std::make_unique<VisibilityPass>();
  }
  ~Impl() {
    try {
      const EglContext::Current current(context_);
      pass_.reset();
    } catch (const Error&) {
      // The objects are destroyed with their context; their owners must not call OpenGL without
      // one.
      static_cast<void>(pass_.release());
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const std::string& description() const { return description_; }

  std::vector<std::uint32_t> visible_triangles(const Executor& executor, const FlatScene& scene,
                                               const PictureView& view, SlotDevice* device,
                                               std::vector<std::uint32_t>* drawn) {
    const std::lock_guard lock(mutex_);
    const EglContext::Current current(context_);
    const CameraFrame& frame = view.frame;
    const std::size_t pixels = std::size_t{frame.width} * frame.height;
    if (device != nullptr && drawn == nullptr && draw_there(*device, scene.triangle_count, view) &&
        device->take({pass_->pack(), pixels, {}}))
      return {};
    pass_->begin(frame.width, frame.height, view.clip);
    std::uint32_t slots = 0;
    for (std::uint32_t first = 0; first < scene.triangle_count;) {
      const std::uint32_t count = std::min(kBatch, scene.triangle_count - first);
      slots += draw(executor, scene, view, first, count, slots);
      first += count;
    }
    const View<const std::uint32_t> names(triangle_of_slot_.data(), slots);
    if (drawn != nullptr) drawn->assign(names.begin(), names.end());
    if (device != nullptr && device->take({pass_->pack(), pixels, names})) return {};
    std::vector<std::uint32_t> picture(pixels);
    pass_->read(picture);
    executor.for_each(pixels, kPixelGrain,
                      [&](std::size_t i) { picture[i] = triangle_of_slot(names, picture[i]); });
    return picture;
  }

 private:
  /// Draws the triangles that may be visible, out of `count` from `first` on; returns how many.
  std::uint32_t draw(const Executor& executor, const FlatScene& scene, const PictureView& view,
                     std::uint32_t first, std::uint32_t count, std::uint32_t first_slot) {
    const std::uint32_t shown = packer_.choose(executor, scene, view, first, count);
    if (shown == 0) return 0;
    triangle_of_slot_.resize(std::max(triangle_of_slot_.size(), std::size_t{first_slot} + shown));
    const MappingGuard guard{*pass_};
    packer_.pack(executor, scene, view, pass_->map(shown), triangle_of_slot_.data() + first_slot);
    pass_->unmap();
    pass_->draw(shown, first_slot);
    return shown;
  }

  /// Lets the device write the corners of its `triangles` into OpenGL's memory, and draws them;
  /// returns false if it cannot.
  bool draw_there(SlotDevice& device, std::uint32_t triangles, const PictureView& view) {
    pass_->begin(view.frame.width, view.frame.height, view.clip);
    std::uint32_t slots = 0;
    for (std::uint32_t first = 0; first < triangles;) {
      const std::uint32_t count = std::min(kBatch, triangles - first);
      const GlMemory corners = pass_->corners(count);
      const std::optional<std::uint32_t> shown = device.pack({corners, view, first, count, slots});
      if (!shown) return false;
      pass_->draw(*shown, slots);
      slots += *shown;
      first += count;
    }
    return true;
  }

  std::mutex mutex_;
  EglContext context_;
  std::unique_ptr<VisibilityPass> pass_;
  std::string description_;
  TrianglePacker packer_;
  std::vector<std::uint32_t> triangle_of_slot_;
};

Rasterizer::Rasterizer() : impl_(std::make_unique<Impl>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;
Rasterizer& Rasterizer::operator=(Rasterizer&&) noexcept = default;

std::string Rasterizer::description() const {
  return impl_->description();
}

std::vector<std::uint32_t> Rasterizer::visible_triangles(const Executor& executor,
                                                         const FlatScene& scene,
                                                         const CameraFrame& frame,
                                                         SlotDevice* device,
                                                         std::vector<std::uint32_t>* drawn) {
  const std::uint32_t width = frame.width, height = frame.height;
  if (width == 0 || height == 0) {
    throw Error(ErrorCode::kInvalidArgument, "an image of " + std::to_string(width) + " x " +
                                                 std::to_string(height) + " has no pixels");
  }
  if (!(frame.z_far > frame.z_near)) {
    if (drawn != nullptr) drawn->clear();
    return std::vector<std::uint32_t>(std::size_t{width} * height, kInvalidId);
  }
  return impl_->visible_triangles(executor, scene,
                                  {frame, clip_matrix(frame, farthest_depth(frame, scene.bounds))},
                                  device, drawn);
}

}  // namespace raysheaf
