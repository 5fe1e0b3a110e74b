// A window with an OpenGL context, and its events. Only window.cpp and shell.cpp include GLFW.
#pragma once

#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "input.h"

struct GLFWwindow;

namespace raysheaf::viewer {

/// Events in the order of their arrival, from any thread.
class InputQueue {
 public:
  void push(InputEvent event);
  [[nodiscard]] std::deque<InputEvent> take();

 private:
  std::mutex mutex_;
  std::deque<InputEvent> events_;
};

struct WindowOptions {
  std::uint32_t width = 1280, height = 800;
  bool check_errors = false;  ///< report errors of OpenGL when they happen
};

class Window {
 public:
  /// Throws `Error` (kNoGraphics) without a display, or without OpenGL 3.3.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Waits for events for at most this time; 0 does not wait.
  void wait(double seconds);
  [[nodiscard]] InputQueue& input() { return input_; }
  [[nodiscard]] bool closing() const;
  void present();
  void resize(std::uint32_t width, std::uint32_t height);
  /// Wakes `wait`, from any thread.
  static void wake();
  [[nodiscard]] static double now_s();

  struct Pixels {
    int width = 0, height = 0;
  };
  [[nodiscard]] Pixels framebuffer() const;
  [[nodiscard]] Pixels size() const;  ///< in the window system's own units
  /// The scale of the display: 1, or 2 if its pixels are small.
  [[nodiscard]] float scale() const;
  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  /// The errors of OpenGL since the last call; empty without errors.
  [[nodiscard]] std::vector<std::string> take_errors();
  /// The pixels that were drawn and not yet presented: RGBA bytes, rows from the top.
  [[nodiscard]] std::vector<std::uint8_t> read_pixels() const;

 private:
  void install_callbacks();

  GLFWwindow* window_ = nullptr;
  InputQueue input_;
  std::vector<std::string> errors_;
};

}  // namespace raysheaf::viewer
