// What the hand does, whoever reports it: the window, or a script.
#pragma once

#include <cstdint>
#include <string>

namespace raysheaf::viewer {

/// Keys by name: "a", "1", "f1", "space", "escape", "tab", "left", "[", ...; see docs/viewer.md.
struct InputEvent {
  enum class Type : std::uint8_t {
    kKeyDown,
    kKeyUp,
    kButtonDown,
    kButtonUp,
    kMove,
    kScroll,
    kDrop
  };
  Type type = Type::kMove;
  std::string text;    ///< the key, or the file that was dropped
  int button = 0;      ///< 0 left, 1 right, 2 middle
  float x = 0, y = 0;  ///< of the cursor, in the window from 0 to 1; of a scroll, its steps
  bool shift = false, control = false;
  double time_s = 0;  ///< when it happened, on the steady clock
};

}  // namespace raysheaf::viewer
