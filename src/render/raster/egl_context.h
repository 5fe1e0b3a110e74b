// A headless OpenGL 4.5 core context, through EGL.
#pragma once

#include <string>

namespace raysheaf {

/// Needs no window system. Where several drivers would serve, a hardware device is taken before a
/// software one, and of several the one that CUDA counts as its first. Displays belong to the
/// process and are never terminated: EGL does not count who else uses them.
class EglContext {
 public:
  /// Throws `Error` (kNoGraphics) that says what was tried. The variable RAYSHEAF_NO_GL, set to
  /// anything but 0, has it fail at once.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes the context current in this thread for as long as it lives, and then again what was
  /// current before.
  class Current {
   public:
    /// Throws `Error` (kNoGraphics) where the driver refuses.
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
