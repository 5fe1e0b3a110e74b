// The window round a model: events in, frames out.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "gl_picture.h"
#include "latency.h"
#include "model.h"
#include "script_player.h"
#include "window.h"

namespace raysheaf::viewer {

/// Dear ImGui for one window, from birth to death.
class ImGuiSession {
 public:
  explicit ImGuiSession(GLFWwindow* window);
  ~ImGuiSession();
  ImGuiSession(const ImGuiSession&) = delete;
  ImGuiSession& operator=(const ImGuiSession&) = delete;

  /// `pointer`: where a script's cursor is, in the window from 0 to 1; null: the real one.
  void begin_frame(const InputEvent* pointer, bool pressed);
  void end_frame();
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] bool wants_keys() const;
};

/// A hand that holds a button and moves, on a clock of its own: what it sends is stamped when it is
/// sent, however busy the window is.
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

  /// One turn: events, model, and a frame where something is new. Throws `Error` (kInternal) for
  /// what OpenGL dislikes, where a script plays.
  void turn(ScriptPlayer* player);
  /// Another frame is due.
  void wake() { frames_due_ = 3; }

  void take_screenshot(const std::string& path) override;
  [[nodiscard]] bool screenshot_done() const override { return screenshot_.empty(); }
  void resize(std::uint32_t width, std::uint32_t height) override;
  void send(const InputEvent& event) override;
  void start_latency(double seconds, int button) override;
  [[nodiscard]] const Latency* latency() const override;
  void print(const std::string& text) override;

  std::function<void(const std::string&)> print_to;

 private:
  [[nodiscard]] double time_to_wait() const;
  void handle_events();
  void draw();
  void finish_frame();
  void write_screenshot();

  Window& window_;
  Model& model_;
  const bool scripted_;
  ImGuiSession imgui_;
  GlPicture gl_picture_;
  float scale_ = 0;
  std::uint64_t uploaded_ = 0;
  int frames_due_ = 3;
  double last_frame_s_ = 0, turned_s_ = 0;
  std::optional<InputEvent> pointer_;  ///< a script's
  bool pointer_pressed_ = false;
  std::string screenshot_;
  int screenshot_in_ = 0;         ///< frames
  std::vector<double> answered_;  ///< stamps of the events that this frame answers
  std::unique_ptr<Finger> finger_;
  Latency latency_;
  Latency frame_cpu_;  ///< what frames take of this thread
  bool latency_done_ = false;
};

}  // namespace raysheaf::viewer
