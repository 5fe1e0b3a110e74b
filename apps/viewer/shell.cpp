#include "shell.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

#include "interface.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "theme.h"

namespace raysheaf::viewer {
namespace {

/// The processor time of this thread, or of all threads.
double cpu_ms(clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// At most sixty frames per second: the remaining time belongs to the rays.
constexpr double kFrameSeconds = 1.0 / 60;
/// The intervals between polls while a result is expected, and otherwise.
constexpr double kBusyWait = 0.02, kIdleWait = 0.5;
/// The interval of the moves that measure latency: a mouse reports 125 times per second.
constexpr auto kFingerPeriod = std::chrono::microseconds(8000);

constexpr Vec3 kBackground{0.07f, 0.07f, 0.085f};

Size part_of(Size whole, float part) {
  const auto side = [part](std::uint32_t of_whole) {
    return static_cast<std::uint32_t>(
        std::max(1L, std::lround(static_cast<float>(of_whole) * part)));
  };
  return {side(whole.width), side(whole.height)};
}

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
    : window_(window), model_(model), scripted_(scripted), imgui_(window.handle()) {
  model_.offer_preview(true);
}

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
  const Size pixels{static_cast<std::uint32_t>(size.width),
                    static_cast<std::uint32_t>(size.height)};
  glViewport(0, 0, size.width, size.height);
  glClearColor(kBackground.x, kBackground.y, kBackground.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  draw_image(pixels);
  imgui_.begin_frame(pointer_ ? &*pointer_ : nullptr, pointer_pressed_);
  draw_interface(model_, scale_);
  imgui_.end_frame();
  if (shown_ == Shown::kPreview) measure_preview();
  finish_frame();
  frame_cpu_.add(cpu_ms() - before_ms);
}

void Shell::draw_image(Size size) {
  if (std::exchange(scene_, model_.scene_count()) != model_.scene_count()) {
    preview_resolution_ = {};
    is_first_preview_ = true;
    model_.offer_preview(true);
  }
  prepare_preview(size);
  const Picture* picture = model_.picture();
  if (picture != nullptr && uploaded_ != model_.picture_count()) {
    gl_picture_.upload(*picture);
    uploaded_ = model_.picture_count();
  }
  shown_part_ = 1;
  const bool has_lines = model_.settings.grid || model_.settings.wireframe;
  if (model_.facts() && (model_.shows_preview() || has_lines)) {
    draw_with_lines(size);
    return;
  }
  shown_ = Shown::kNothing;
  if (picture == nullptr) return;
  const Camera& camera = model_.rig.camera();
  shown_ = same_camera(camera, picture->request.camera) ? Shown::kPicture : Shown::kMovedPicture;
  shown_part_ = static_cast<float>(picture->size.width) / static_cast<float>(size.width);
  gl_picture_.draw(*picture, camera, model_.rig.distance(), model_.settings.divider,
                   static_cast<int>(size.width), static_cast<int>(size.height));
}

void Shell::prepare_preview(Size size) {
  if (!is_first_preview_ || !model_.facts() || !model_.mesh_is_current()) return;
  is_first_preview_ = false;
  // Stands for the traced image, which comes later. Drivers compile programs again for other
  // formats, and for sides that are powers of two.
  constexpr std::uint32_t kSide = 3;
  Picture picture;
  picture.request.camera = model_.rig.camera();
  picture.size = {kSide, kSide};
  picture.depth.assign(kSide * kSide, -1.0f);
  Image& image = picture.sides[0].image;
  image.width = image.height = kSide;
  image.rgba.assign(std::size_t{4} * kSide * kSide, 0);
  gl_picture_.upload(picture);
  gl_picture_.upload_depth(picture);
  uploaded_ = 0;
  gl_scene_.upload(model_.mesh());
  const auto draw_once = [&] {
    gl_scene_.begin(part_of(size, preview_resolution_.part()), model_.rig.camera(),
                    model_.facts()->bounds, picture.sky);
    gl_scene_.draw_preview(&picture, gl_picture_, picture.light);
    gl_scene_.finish(size);
    glFinish();
  };
  draw_once();
  for (float part = 0; part != preview_resolution_.part();) {
    part = preview_resolution_.part();
    const double before_s = Window::now_s();
    draw_once();
    preview_resolution_.took((Window::now_s() - before_s) * 1e3);
  }
  glClearColor(kBackground.x, kBackground.y, kBackground.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

void Shell::draw_with_lines(Size size) {
  const bool is_preview = model_.shows_preview();
  if (is_preview && !model_.rests()) shown_part_ = preview_resolution_.part();
  const Picture* picture = is_preview ? model_.reprojected() : model_.picture();
  const Vec3 background = model_.picture() != nullptr ? model_.picture()->sky : Picture().sky;
  gl_scene_.upload(model_.mesh());
  gl_scene_.begin(part_of(size, shown_part_), model_.rig.camera(), model_.facts()->bounds,
                  background);
  if (is_preview) {
    if (picture != nullptr) gl_picture_.upload_depth(*picture);
    const float light = model_.picture() != nullptr ? model_.picture()->light : 0.7f;
    gl_scene_.draw_preview(picture, gl_picture_, light);
    shown_ = Shown::kPreview;
  } else {
    shown_ = Shown::kNothing;
    if (picture != nullptr) {
      shown_part_ = static_cast<float>(picture->size.width) / static_cast<float>(size.width);
      gl_scene_.draw_picture(*picture, gl_picture_, model_.rig.distance(), model_.settings.divider);
      shown_ = same_camera(model_.rig.camera(), picture->request.camera) ? Shown::kPicture
                                                                         : Shown::kMovedPicture;
    }
    if (model_.mesh_is_current()) gl_scene_.draw_depth();
  }
  if (model_.settings.wireframe && model_.mesh_is_current()) gl_scene_.draw_edges();
  if (model_.settings.grid) gl_scene_.draw_grid(model_.rig.up());
  gl_scene_.finish(size);
}

void Shell::measure_preview() {
  glFinish();
  if (std::exchange(is_first_preview_, false) || model_.rests()) return;
  preview_resolution_.took((Window::now_s() - last_frame_s_) * 1e3);
  if (preview_resolution_.too_slow()) model_.offer_preview(false);
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
    previews_ += shown_ == Shown::kPreview ? 1 : 0;
    least_part_ = std::min(least_part_, shown_part_);
    if (finger_->done()) finish_latency();
  }
  answered_.clear();
}

void Shell::finish_latency() {
  finger_.reset();
  latency_done_ = true;
  char text[320];
  const Size window = model_.window();
  const auto side = [this](std::uint32_t whole) {
    return std::lround(static_cast<float>(whole) * least_part_);
  };
  const double all_ms = cpu_ms(CLOCK_PROCESS_CPUTIME_ID) - started_cpu_ms_;
  std::snprintf(text, sizeof text,
                "%zu frames, median %.1f ms of processor time on their thread, mean %.1f ms on all "
                "threads; %zu show the preview; the smallest image is %ldx%ld in a window of "
                "%ux%u\n",
                frame_cpu_.count(), frame_cpu_.percentile(0.5),
                all_ms / static_cast<double>(std::max<std::size_t>(frame_cpu_.count(), 1)),
                previews_, side(window.width), side(window.height), window.width, window.height);
  print(text);
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
  previews_ = 0;
  least_part_ = 1;
  started_cpu_ms_ = cpu_ms(CLOCK_PROCESS_CPUTIME_ID);
  latency_done_ = false;
  finger_ = std::make_unique<Finger>(window_.input(), seconds, button);
}

const Latency* Shell::latency() const {
  return latency_done_ ? &latency_ : nullptr;
}

std::optional<std::string> Shell::value(const std::string& name) const {
  const auto number = [](float value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", static_cast<double>(value));
    return std::string(text);
  };
  if (name == "shown-part") return number(shown_part_);
  if (name == "least-part" && latency_done_) return number(least_part_);
  if (name != "shown") return std::nullopt;
  switch (shown_) {
    case Shown::kPicture:
      return "picture";
    case Shown::kMovedPicture:
      return "moved-picture";
    case Shown::kPreview:
      return "preview";
    case Shown::kNothing:
      break;
  }
  return "nothing";
}

void Shell::print(const std::string& text) {
  if (print_to) print_to(text);
}

}  // namespace raysheaf::viewer
