// Plays a script: as much a frame as needs no waiting.
#pragma once

#include <functional>
#include <string>

#include "latency.h"
#include "model.h"
#include "script.h"

namespace raysheaf::viewer {

/// What the window does for a script.
class ScriptHost {
 public:
  virtual ~ScriptHost() = default;
  /// The window as the next frames show it; `screenshot_done` says when it is there.
  virtual void take_screenshot(const std::string& path) = 0;
  [[nodiscard]] virtual bool screenshot_done() const = 0;
  virtual void resize(std::uint32_t width, std::uint32_t height) = 0;
  /// The cursor, wherever the real one is.
  virtual void send(const InputEvent& event) = 0;
  /// Sends moves of a held button from a thread of its own for so long.
  virtual void start_latency(double seconds, int button) = 0;
  /// Null while it runs.
  [[nodiscard]] virtual const Latency* latency() const = 0;
  virtual void print(const std::string& text) = 0;
};

class ScriptPlayer {
 public:
  ScriptPlayer(Script script, Model& model, ScriptHost& host);

  /// Plays until something must be waited for. Throws `Error` (kInvalidData, place "file:line")
  /// where an assertion fails, a name is unknown or something is waited for longer than
  /// `patience_s`.
  void step(double now_s);
  [[nodiscard]] bool done() const { return !ready_ && next_ >= script_.commands.size(); }

  double patience_s = 120;

 private:
  using Words = std::vector<std::string>;
  /// Whether what is waited for has happened.
  using Ready = std::function<bool(double)>;

  void begin(const ScriptCommand& command, double now_s);
  /// Of the camera, of the hand and of all else; false where the command is none of those.
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
