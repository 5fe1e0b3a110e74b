// The window around a model: passes events in and draws frames.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "gl_picture.h"
#include "gl_scene.h"
#include "latency.h"
#include "model.h"
#include "script_player.h"
#include "window.h"

namespace raysheaf::viewer {

/// Dear ImGui for one window, for its whole lifetime.
class ImGuiSession {
 public:
  explicit ImGuiSession(GLFWwindow* window);
  ~ImGuiSession();
  ImGuiSession(const ImGuiSession&) = delete;
  ImGuiSession& operator=(const ImGuiSession&) = delete;

  /// `pointer`: the cursor of a script, in the window from 0 to 1; null: the real cursor.
  void begin_frame(const InputEvent* pointer, bool pressed);
  void end_frame();
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] bool wants_keys() const;
};

/// Simulates a dragged button on a clock of its own: each move gets its timestamp when it is sent,
/// however busy the window is.
class Finger {
 public:
  Finger(InputQueue& queue, double seconds, int button);
  ~Finger();
  Finger(const Finger&) = delete;
  Finger& operator=(const Finger&) = delete;
  [[nodiscard]] bool done() const { return done_; }

 private:
  std::atomic<bool> stop_{false}, done_{false};
  std::thread thread_;
};

class Shell : public ScriptHost {
 public:
  Shell(Window& window, Model& model, bool scripted);

  /// One iteration: events, model, and a frame if something is new. Throws `Error` (kInternal) for
  /// errors of OpenGL while a script plays.
  void turn(ScriptPlayer* player);
  /// Requests another frame.
  void wake() { frames_due_ = 3; }

  void take_screenshot(const std::string& path) override;
  [[nodiscard]] bool screenshot_done() const override { return screenshot_.empty(); }
  void resize(std::uint32_t width, std::uint32_t height) override;
  void send(const InputEvent& event) override;
  void start_latency(double seconds, int button) override;
  [[nodiscard]] const Latency* latency() const override;
  [[nodiscard]] std::optional<std::string> value(const std::string& name) const override;
  void print(const std::string& text) override;

  std::function<void(const std::string&)> print_to;

 private:
  [[nodiscard]] double time_to_wait() const;
  void handle_events();
  void draw();
  /// The image of the scene, without the interface.
  void draw_image(Size size);
  /// Draws the first preview of a scene unseen, before it is moved: the driver compiles the
  /// programs, which takes longer than a frame, and the size is found that is fast enough.
  void prepare_preview(Size size);
  void draw_with_lines(Size size);
  /// Finishes the commands of a preview, and learns how long they took.
  void measure_preview();
  void finish_frame();
  void finish_latency();
  void write_screenshot();

  Window& window_;
  Model& model_;
  const bool scripted_;
  ImGuiSession imgui_;
  GlPicture gl_picture_;
  GlScene gl_scene_;
  PreviewResolution preview_resolution_;
  std::uint64_t scene_ = 0;       ///< `Model::scene_count` when `preview_resolution_` began
  bool is_first_preview_ = true;  ///< of the scene, whose triangles it uploads

  /// The image of the scene in the last frame.
  enum class Shown : std::uint8_t { kNothing, kPicture, kMovedPicture, kPreview };
  Shown shown_ = Shown::kNothing;
  float shown_part_ = 1;  ///< its width, as a part of the window's
  float scale_ = 0;
  std::uint64_t uploaded_ = 0;
  int frames_due_ = 3;
  double last_frame_s_ = 0;
  std::optional<InputEvent> pointer_;  ///< that of a script
  bool pointer_pressed_ = false;
  std::string screenshot_;
  int screenshot_in_ = 0;         ///< number of frames
  std::vector<double> answered_;  ///< timestamps of the events that this frame responds to
  std::unique_ptr<Finger> finger_;
  Latency latency_;
  Latency frame_cpu_;         ///< processor time of this thread per frame
  std::size_t previews_ = 0;  ///< frames of the drag that showed the preview
  float least_part_ = 1;      ///< the least `shown_part_` of the drag
  double started_cpu_ms_ = 0;
  bool latency_done_ = false;
};

}  // namespace raysheaf::viewer
