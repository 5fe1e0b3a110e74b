// A headless OpenGL 4.5 core context, through EGL.
#pragma once

#include <string>

namespace raysheaf {

/// Needs no window system. If several drivers are available, prefers hardware to software, and
/// among several hardware devices CUDA's first. Displays belong to the process and are never
/// terminated, because EGL does not count their users. The first context of a process sets
/// MESA_SHADER_CACHE_DISABLE, unless the user has set it or a folder for the cache: no file is
/// written.
class EglContext {
 public:
  /// Throws `Error` (kNoGraphics) that lists what was tried. Setting the variable RAYSHEAF_NO_GL to
  /// anything but 0 makes it fail at once.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes the context current in this thread, and restores the previous one at the end of its
  /// life.
  class Current {
   public:
    /// Throws `Error` (kNoGraphics) if the driver refuses.
    explicit Current(const EglContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const EglContext& context_;
    unsigned api_;
    void *display_, *draw_, *read_, *previous_;
  };

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace raysheaf
