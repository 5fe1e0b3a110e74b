#include "window.h"

#include <epoxy/gl.h>
// epoxy must come first: otherwise GLFW would include the system's GL header.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "raysheaf/error.h"

namespace raysheaf::viewer {
namespace {

std::string last_error;  // GLFW calls back on the thread that called it, the main one

void keep_error(int /*code*/, const char* text) {
  last_error = text;
}

[[noreturn]] void refuse(const std::string& what) {
  std::string sentence = what;
  if (!last_error.empty()) sentence += ": " + last_error;
  throw Error(ErrorCode::kNoGraphics, sentence);
}

std::string key_name(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) return {static_cast<char>('a' + key - GLFW_KEY_A)};
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return {static_cast<char>('0' + key - GLFW_KEY_0)};
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
    return {static_cast<char>('0' + key - GLFW_KEY_KP_0)};
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) return "f" + std::to_string(key - GLFW_KEY_F1 + 1);
  static const std::map<int, std::string> names = {
      {GLFW_KEY_SPACE, "space"},     {GLFW_KEY_ESCAPE, "escape"},
      {GLFW_KEY_TAB, "tab"},         {GLFW_KEY_LEFT, "left"},
      {GLFW_KEY_RIGHT, "right"},     {GLFW_KEY_UP, "up"},
      {GLFW_KEY_DOWN, "down"},       {GLFW_KEY_MINUS, "-"},
      {GLFW_KEY_EQUAL, "="},         {GLFW_KEY_LEFT_BRACKET, "["},
      {GLFW_KEY_HOME, "home"},       {GLFW_KEY_RIGHT_BRACKET, "]"},
      {GLFW_KEY_END, "end"},         {GLFW_KEY_COMMA, ","},
      {GLFW_KEY_PERIOD, "."},        {GLFW_KEY_ENTER, "enter"},
      {GLFW_KEY_KP_ENTER, "enter"},  {GLFW_KEY_BACKSPACE, "backspace"},
      {GLFW_KEY_KP_DECIMAL, "home"}, {GLFW_KEY_KP_ADD, "kp+"},
      {GLFW_KEY_KP_SUBTRACT, "kp-"},
  };
  const auto found = names.find(key);
  return found != names.end() ? found->second : "";
}

Window* of(GLFWwindow* window) {
  return static_cast<Window*>(glfwGetWindowUserPointer(window));
}

InputEvent event_now(GLFWwindow* window, InputEvent::Type type) {
  InputEvent event;
  event.type = type;
  event.time_s = Window::now_s();
  double x = 0, y = 0;
  glfwGetCursorPos(window, &x, &y);
  const Window::Pixels size = of(window)->size();
  event.x = static_cast<float>(x) / static_cast<float>(std::max(size.width, 1));
  event.y = static_cast<float>(y) / static_cast<float>(std::max(size.height, 1));
  return event;
}

void on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int modifiers) {
  if (action == GLFW_REPEAT) return;
  InputEvent event = event_now(
      window, action == GLFW_PRESS ? InputEvent::Type::kKeyDown : InputEvent::Type::kKeyUp);
  event.text = key_name(key);
  event.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
  event.control = (modifiers & GLFW_MOD_CONTROL) != 0;
  if (!event.text.empty()) of(window)->input().push(std::move(event));
}

void on_button(GLFWwindow* window, int button, int action, int modifiers) {
  InputEvent event = event_now(
      window, action == GLFW_PRESS ? InputEvent::Type::kButtonDown : InputEvent::Type::kButtonUp);
  event.button = button;
  event.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
  event.control = (modifiers & GLFW_MOD_CONTROL) != 0;
  of(window)->input().push(std::move(event));
}

void on_move(GLFWwindow* window, double /*x*/, double /*y*/) {
  of(window)->input().push(event_now(window, InputEvent::Type::kMove));
}

void on_scroll(GLFWwindow* window, double x, double y) {
  InputEvent event = event_now(window, InputEvent::Type::kScroll);
  event.x = static_cast<float>(x);
  event.y = static_cast<float>(y);
  of(window)->input().push(std::move(event));
}

void on_drop(GLFWwindow* window, int count, const char** paths) {
  if (count < 1) return;
  InputEvent event = event_now(window, InputEvent::Type::kDrop);
  event.text = paths[0];
  of(window)->input().push(std::move(event));
}

void APIENTRY keep_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity,
                           GLsizei /*length*/, const GLchar* message, const void* errors) {
  if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
  static_cast<std::vector<std::string>*>(const_cast<void*>(errors))->emplace_back(message);
}

}  // namespace

void InputQueue::push(InputEvent event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

std::deque<InputEvent> InputQueue::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

Window::Window(const WindowOptions& options) {
  last_error.clear();
  glfwSetErrorCallback(keep_error);
  if (glfwInit() == GLFW_FALSE) refuse("cannot open a window");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.check_errors ? GLFW_TRUE : GLFW_FALSE);
  window_ = glfwCreateWindow(static_cast<int>(options.width), static_cast<int>(options.height),
                             "raysheaf", nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string why = last_error;
    glfwTerminate();
    last_error = why;
    refuse("cannot open a window with OpenGL 3.3");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowSizeLimits(window_, 64, 64, GLFW_DONT_CARE, GLFW_DONT_CARE);
  if (options.check_errors && epoxy_has_gl_extension("GL_KHR_debug")) {
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(keep_message, &errors_);
  }
  install_callbacks();
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::install_callbacks() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, on_key);
  glfwSetMouseButtonCallback(window_, on_button);
  glfwSetCursorPosCallback(window_, on_move);
  glfwSetScrollCallback(window_, on_scroll);
  glfwSetDropCallback(window_, on_drop);
}

void Window::wait(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
}

bool Window::closing() const {
  return glfwWindowShouldClose(window_) != 0;
}
void Window::present() {
  glfwSwapBuffers(window_);
}
void Window::resize(std::uint32_t width, std::uint32_t height) {
  glfwSetWindowSize(window_, static_cast<int>(width), static_cast<int>(height));
}
void Window::wake() {
  glfwPostEmptyEvent();
}
double Window::now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Window::Pixels Window::framebuffer() const {
  Pixels pixels;
  glfwGetFramebufferSize(window_, &pixels.width, &pixels.height);
  return pixels;
}
Window::Pixels Window::size() const {
  Pixels pixels;
  glfwGetWindowSize(window_, &pixels.width, &pixels.height);
  return pixels;
}
float Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::clamp(std::max(x, y), 0.5f, 4.0f);
}

std::vector<std::string> Window::take_errors() {
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
    errors_.push_back("error " + std::to_string(error));
  return std::exchange(errors_, {});
}

std::vector<std::uint8_t> Window::read_pixels() const {
  const Pixels size = framebuffer();
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  std::vector<std::uint8_t> below(4 * width * height), pixels(below.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, below.data());
  for (std::size_t row = 0; row < height; ++row)
    std::copy_n(below.begin() + static_cast<std::ptrdiff_t>(4 * width * (height - 1 - row)),
                4 * width, pixels.begin() + static_cast<std::ptrdiff_t>(4 * width * row));
  for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = 255;
  return pixels;
}

}  // namespace raysheaf::viewer
