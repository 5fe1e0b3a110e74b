#include "render/raster/rasterizer.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "exec/executor.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "render/raster/egl_context.h"
#include "render/raster/pack.h"
#include "render/raster/visibility_pass.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

/// Triangles a draw call: what bounds the memory that corners stream through to 36 MiB.
constexpr std::uint32_t kBatch = 1u << 20, kGbufferBatch = kBatch / 4;
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
      gbuffer_pass_.reset();
    } catch (const Error&) {
      // The objects are destroyed with their context; their owners must not call OpenGL without
      // one.
      static_cast<void>(pass_.release());
      static_cast<void>(gbuffer_pass_.release());
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const std::string& description() const { return description_; }

  [[nodiscard]] std::uint64_t drawn_triangles() const { return drawn_; }

  std::vector<std::uint32_t> visible_triangles(const Executor& executor, const FlatScene& scene,
                                               const PictureView& view, SlotDevice* device,
                                               std::vector<std::uint32_t>* drawn,
                                               const GbufferRequest* gbuffer) {
    const std::lock_guard lock(mutex_);
    const EglContext::Current current(context_);
    const CameraFrame& frame = view.frame;
    const std::size_t pixels = std::size_t{frame.width} * frame.height;
    const Drawing drawing{executor, scene, view, pass_for(gbuffer), gbuffer};
    VisibilityPass& pass = drawing.pass;
    const bool has_gbuffer = gbuffer != nullptr;
    if (device != nullptr && drawn == nullptr && draw_there(*device, drawing) &&
        device->take({pass.pack(), pixels, {}, has_gbuffer}))
      return {};
    pass.begin(frame.width, frame.height, view.clip, frame.eye);
    std::uint32_t slots = 0;
    for_each_batch(drawing, [&](std::uint32_t first, std::uint32_t count) {
      slots += draw(drawing, first, count, slots);
      return true;
    });
    drawn_ = slots;
    const View<const std::uint32_t> names(triangle_of_slot_.data(), slots);
    if (drawn != nullptr) drawn->assign(names.begin(), names.end());
    if (device != nullptr && device->take({pass.pack(), pixels, names, has_gbuffer})) return {};
    std::vector<std::uint32_t> picture(pixels);
    has_gbuffer ? read_gbuffer(drawing, picture) : pass.read(picture);
    executor.for_each(pixels, kPixelGrain,
                      [&](std::size_t i) { picture[i] = triangle_of_slot(names, picture[i]); });
    return picture;
  }

 private:
  struct Drawing {
    const Executor& executor;
    const FlatScene& scene;
    const PictureView& view;
    VisibilityPass& pass;
    const GbufferRequest* gbuffer;
  };

  VisibilityPass& pass_for(const GbufferRequest* gbuffer) {
    if (gbuffer == nullptr) return *pass_;
    if (gbuffer_pass_ == nullptr)
      gbuffer_pass_ = std::make_unique<VisibilityPass>(DrawnTargets::kGbuffer);
    return *gbuffer_pass_;
  }

  /// `body(first, count)` for the triangles of each draw call, until one returns false.
  template <class Body>
  static bool for_each_batch(const Drawing& drawing, const Body& body) {
    const std::uint32_t most = drawing.gbuffer != nullptr ? kGbufferBatch : kBatch;
    for (std::uint32_t first = 0; first < drawing.scene.triangle_count;) {
      const std::uint32_t count = std::min(most, drawing.scene.triangle_count - first);
      if (!body(first, count)) return false;
      first += count;
    }
    return true;
  }

  /// Draws what may show of `count` triangles from `first` on; returns how many that is.
  std::uint32_t draw(const Drawing& drawing, std::uint32_t first, std::uint32_t count,
                     std::uint32_t first_slot) {
    const auto& [executor, scene, view, pass, gbuffer] = drawing;
    const std::uint32_t shown = packer_.choose(executor, scene, view, first, count);
    if (shown == 0) return 0;
    triangle_of_slot_.resize(std::max(triangle_of_slot_.size(), std::size_t{first_slot} + shown));
    std::uint32_t* const names = triangle_of_slot_.data() + first_slot;
    const MappingGuard guard{pass};
    void* const corners = pass.map(shown);
    if (gbuffer != nullptr) {
      packer_.pack(executor, scene, gbuffer->textures, view, static_cast<GbufferCorner*>(corners),
                   names);
    } else {
      packer_.pack(executor, scene, view, static_cast<float*>(corners), names);
    }
    pass.unmap();
    pass.draw(shown, first_slot);
    return shown;
  }

  /// Has the device write the corners of its triangles, which are the scene's, into OpenGL's
  /// memory, and draws them; false where it does not write there.
  bool draw_there(SlotDevice& device, const Drawing& drawing) {
    const auto& [executor, scene, view, pass, gbuffer] = drawing;
    pass.begin(view.frame.width, view.frame.height, view.clip, view.frame.eye);
    std::uint32_t slots = 0;
    const bool done = for_each_batch(drawing, [&](std::uint32_t first, std::uint32_t count) {
      const GlMemory corners = drawing.pass.corners(count);
      const std::optional<std::uint32_t> shown =
          device.pack({corners, drawing.view, first, count, slots, drawing.gbuffer != nullptr});
      if (!shown) return false;
      drawing.pass.draw(*shown, slots);
      slots += *shown;
      return true;
    });
    drawn_ = slots;
    return done;
  }

  /// All targets, and the slots that they name.
  static void read_gbuffer(const Drawing& drawing, View<std::uint32_t> slots) {
    Gbuffer& targets = *drawing.gbuffer->targets;
    std::uint32_t number = 0;
    for (std::vector<Vec4>* target :
         {&targets.position, &targets.normal, &targets.diffuse, &targets.specular}) {
      target->resize(slots.size);
      drawing.pass.read(number++, View<Vec4>(*target));
    }
    drawing.executor.for_each(slots.size, kPixelGrain, [&](std::size_t i) {
      slots.data[i] = slot_of_texels(targets.position[i].w, targets.normal[i].w);
    });
  }

  std::mutex mutex_;
  EglContext context_;
  std::unique_ptr<VisibilityPass> pass_, gbuffer_pass_;  ///< the other of the first G-buffer on
  std::string description_;
  std::uint64_t drawn_ = 0;
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

std::vector<std::uint32_t> Rasterizer::visible_triangles(
    const Executor& executor, const FlatScene& scene, const CameraFrame& frame, SlotDevice* device,
    std::vector<std::uint32_t>* drawn, const GbufferRequest* gbuffer) {
  const std::uint32_t width = frame.width, height = frame.height;
  if (width == 0 || height == 0) {
    throw Error(ErrorCode::kInvalidArgument, "an image of " + std::to_string(width) + " x " +
                                                 std::to_string(height) + " has no pixels");
  }
  if (!(frame.z_far > frame.z_near)) {
    const std::size_t pixels = std::size_t{width} * height;
    if (drawn != nullptr) drawn->clear();
    if (gbuffer != nullptr) {
      const std::vector<Vec4> nothing(pixels);
      *gbuffer->targets = {std::vector<Vec4>(pixels, Vec4{0, 0, 0, -1}), nothing, nothing, nothing};
    }
    return std::vector<std::uint32_t>(pixels, kInvalidId);
  }
  return impl_->visible_triangles(executor, scene,
                                  {frame, clip_matrix(frame, farthest_depth(frame, scene.bounds))},
                                  device, drawn, gbuffer);
}

std::uint64_t Rasterizer::drawn_triangles() const {
  return impl_->drawn_triangles();
}

}  // namespace raysheaf
