// Plays a script: in each frame, as many commands as need no waiting.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "latency.h"
#include "model.h"
#include "script.h"

namespace raysheaf::viewer {

/// The actions of the window for a script.
class ScriptHost {
 public:
  virtual ~ScriptHost() = default;
  /// Saves the window as the next frames show it; `screenshot_done` returns whether that is done.
  virtual void take_screenshot(const std::string& path) = 0;
  [[nodiscard]] virtual bool screenshot_done() const = 0;
  virtual void resize(std::uint32_t width, std::uint32_t height) = 0;
  /// Sets the cursor, wherever the real one is.
  virtual void send(const InputEvent& event) = 0;
  /// For this time, sends moves of a held button from a separate thread.
  virtual void start_latency(double seconds, int button) = 0;
  /// Null while the drag runs.
  [[nodiscard]] virtual const Latency* latency() const = 0;
  /// A value of the window; none for other names.
  [[nodiscard]] virtual std::optional<std::string> value(const std::string& name) const = 0;
  virtual void print(const std::string& text) = 0;
};

class ScriptPlayer {
 public:
  ScriptPlayer(Script script, Model& model, ScriptHost& host);

  /// Plays until it must wait. Throws `Error` (kInvalidData, place "file:line") if an assertion
  /// fails, a name is unknown, or a wait takes longer than `patience_s`.
  void step(double now_s);
  [[nodiscard]] bool done() const { return !ready_ && next_ >= script_.commands.size(); }

  double patience_s = 120;

 private:
  using Words = std::vector<std::string>;
  /// Whether the awaited event has happened.
  using Ready = std::function<bool(double)>;

  void begin(const ScriptCommand& command, double now_s);
  /// Commands of the camera, of input, and all others; false if the command is not one of them.
  bool move_camera(const Words& words);
  bool use_hand(const Words& words, double now_s);
  bool wait_for(const Words& words, double now_s);
  void press(const std::string& key, bool down, double now_s);
  void drag(const Words& words, double now_s);
  void check(const Words& words);
  [[nodiscard]] std::string value(const std::string& name) const;
  void wait_until(Ready ready);

  const Script script_;
  Model& model_;
  ScriptHost& host_;
  std::size_t next_ = 0;
  Ready ready_;
  double since_s_ = 0;
};

}  // namespace raysheaf::viewer
