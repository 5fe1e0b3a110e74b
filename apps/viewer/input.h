// Input events, whether the window reports them or a script.
#pragma once

#include <cstdint>
#include <string>

namespace raysheaf::viewer {

/// Keys by name: "a", "1", "f1", "space", "escape", "tab", "left", "[", ...; see docs/viewer.md.
/// The digits of the keypad have the names of the others.
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
  std::string text;    ///< the key, or the dropped file
  int button = 0;      ///< 0 left, 1 right, 2 middle
  float x = 0, y = 0;  ///< position of the cursor in the window from 0 to 1, or steps of a scroll
  bool shift = false, control = false;
  double time_s = 0;  ///< when it happened, on the steady clock
};

}  // namespace raysheaf::viewer
