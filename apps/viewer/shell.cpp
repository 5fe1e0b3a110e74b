#include "shell.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <cmath>
#include <cstdio>
#include <ctime>

#include "interface.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

/// The processor time of this thread.
double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// At most sixty frames per second: the remaining time belongs to the rays.
constexpr double kFrameSeconds = 1.0 / 60;
/// The intervals between polls while a result is expected, and otherwise.
constexpr double kBusyWait = 0.02, kIdleWait = 0.5;
/// The interval of the moves that measure latency: a mouse reports 125 times per second.
constexpr auto kFingerPeriod = std::chrono::microseconds(8000);

}  // namespace

ImGuiSession::ImGuiSession(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  // Calls the callbacks that the window has installed before.
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

ImGuiSession::~ImGuiSession() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void ImGuiSession::begin_frame(const InputEvent* pointer, bool pressed) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  if (pointer != nullptr) {
    io.MousePos = {pointer->x * io.DisplaySize.x, pointer->y * io.DisplaySize.y};
    io.MouseDown[0] = pressed;
  }
  ImGui::NewFrame();
}

void ImGuiSession::end_frame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool ImGuiSession::wants_mouse() const {
  return ImGui::GetIO().WantCaptureMouse;
}
bool ImGuiSession::wants_keys() const {
  return ImGui::GetIO().WantTextInput;
}

Finger::Finger(InputQueue& queue, double seconds, int button) {
  thread_ = std::thread([this, &queue, seconds, button] {
    const double start = Window::now_s();
    InputEvent event;
    event.button = button;
    const auto send = [&](InputEvent::Type type) {
      const double passed = Window::now_s() - start;
      event.type = type;
      event.x = static_cast<float>(0.5 + 0.12 * std::sin(passed * 1.7));
      event.y = static_cast<float>(0.5 + 0.06 * std::sin(passed * 2.9));
      event.time_s = Window::now_s();
      queue.push(event);
      Window::wake();
    };
    send(InputEvent::Type::kButtonDown);
    while (!stop_ && Window::now_s() - start < seconds) {
      send(InputEvent::Type::kMove);
      std::this_thread::sleep_for(kFingerPeriod);
    }
    send(InputEvent::Type::kButtonUp);
    done_ = true;
    Window::wake();
  });
}

Finger::~Finger() {
  stop_ = true;
  thread_.join();
}

Shell::Shell(Window& window, Model& model, bool scripted)
    : window_(window), model_(model), scripted_(scripted), imgui_(window.handle()) {}

double Shell::time_to_wait() const {
  if (frames_due_ > 0 || model_.moves()) {
    return std::max(0.0, kFrameSeconds - (Window::now_s() - last_frame_s_));
  }
  return scripted_ || model_.waits() ? kBusyWait : kIdleWait;
}

void Shell::handle_events() {
  for (const InputEvent& event : window_.input().take()) {
    model_.handle(event, imgui_.wants_mouse() && !finger_, imgui_.wants_keys());
    if (event.time_s > 0) answered_.push_back(event.time_s);
    wake();
  }
}

void Shell::turn(ScriptPlayer* player) {
  // Events that arrive before the next frame is due belong to that frame.
  window_.wait(time_to_wait());
  while (frames_due_ > 0) {
    const double left = kFrameSeconds - (Window::now_s() - last_frame_s_);
    if (left <= 0.0005) break;
    window_.wait(left);
  }
  handle_events();
  const Window::Pixels pixels = window_.framebuffer();
  if (pixels.width < 1 || pixels.height < 1) {  // minimised: poll again after the time of a frame
    last_frame_s_ = Window::now_s();
    return;
  }
  const Size size{static_cast<std::uint32_t>(pixels.width),
                  static_cast<std::uint32_t>(pixels.height)};
  if (size != model_.window()) wake();
  model_.set_window(size);
  const Window::Pixels units = window_.size();
  model_.settings.width = static_cast<std::uint32_t>(std::max(units.width, 320));
  model_.settings.height = static_cast<std::uint32_t>(std::max(units.height, 240));
  const std::uint64_t before = model_.version();
  model_.update(Window::now_s());
  if (player != nullptr) player->step(Window::now_s());
  if (model_.version() != before || model_.moves()) wake();
  if (frames_due_ <= 0) return;
  --frames_due_;
  draw();
}

void Shell::draw() {
  const double before_ms = cpu_ms();
  last_frame_s_ = Window::now_s();
  if (const float scale = window_.scale(); scale != scale_) {
    scale_ = scale;
    apply_theme(scale);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  const Window::Pixels size = window_.framebuffer();
  glViewport(0, 0, size.width, size.height);
  glClearColor(0.07f, 0.07f, 0.085f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  if (const Picture* picture = model_.picture(); picture != nullptr) {
    if (uploaded_ != model_.picture_count()) gl_picture_.upload(*picture);
    uploaded_ = model_.picture_count();
    gl_picture_.draw(*picture, model_.rig.camera(), model_.rig.distance(), model_.settings.divider,
                     size.width, size.height);
  }
  imgui_.begin_frame(pointer_ ? &*pointer_ : nullptr, pointer_pressed_);
  draw_interface(model_, scale_);
  imgui_.end_frame();
  finish_frame();
  frame_cpu_.add(cpu_ms() - before_ms);
}

void Shell::finish_frame() {
  if (!screenshot_.empty() && --screenshot_in_ <= 0) write_screenshot();
  window_.present();
  if (scripted_) {
    for (const std::string& error : window_.take_errors())
      throw Error(ErrorCode::kInternal, "OpenGL reports an error: " + error);
  }
  if (finger_) {
    glFinish();  // the measured time ends when the frame is complete
    const double now = Window::now_s();
    for (const double stamp : answered_) latency_.add((now - stamp) * 1e3);
    if (finger_->done()) {
      finger_.reset();
      latency_done_ = true;
      char text[120];
      std::snprintf(text, sizeof text,
                    "%zu frames, median %.1f ms of processor time on their thread\n",
                    frame_cpu_.count(), frame_cpu_.percentile(0.5));
      print(text);
    }
  }
  answered_.clear();
}

void Shell::write_screenshot() {
  const Window::Pixels size = window_.framebuffer();
  Image image;
  image.width = static_cast<std::uint32_t>(size.width);
  image.height = static_cast<std::uint32_t>(size.height);
  image.rgba = window_.read_pixels();
  write_png(image, std::exchange(screenshot_, ""));
}

void Shell::take_screenshot(const std::string& path) {
  screenshot_ = path;
  screenshot_in_ = 3;  // windows of the interface find their size in the second frame
  wake();
}

void Shell::resize(std::uint32_t width, std::uint32_t height) {
  window_.resize(width, height);
  wake();
}

void Shell::send(const InputEvent& event) {
  if (event.type != InputEvent::Type::kKeyDown && event.type != InputEvent::Type::kKeyUp &&
      event.type != InputEvent::Type::kDrop && event.type != InputEvent::Type::kScroll) {
    pointer_ = event;
    if (event.type == InputEvent::Type::kButtonDown) pointer_pressed_ = true;
    if (event.type == InputEvent::Type::kButtonUp) pointer_pressed_ = false;
  }
  model_.handle(event);
  wake();
}

void Shell::start_latency(double seconds, int button) {
  latency_.clear();
  frame_cpu_.clear();
  latency_done_ = false;
  finger_ = std::make_unique<Finger>(window_.input(), seconds, button);
}

const Latency* Shell::latency() const {
  return latency_done_ ? &latency_ : nullptr;
}

void Shell::print(const std::string& text) {
  if (print_to) print_to(text);
}

}  // namespace raysheaf::viewer
