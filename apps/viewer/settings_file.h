// The file that remembers: a line a setting, its name and its value.
#pragma once

#include <string>

#include "view_settings.h"

namespace raysheaf::viewer {

/// $XDG_CONFIG_HOME/raysheaf/view, or ~/.config/raysheaf/view; empty where neither is known.
[[nodiscard]] std::string default_settings_path();

struct LoadedSettings {
  ViewSettings settings;
  std::string sentence;  ///< why the file was ignored; empty where it was not
};

/// A missing file is no failure: the defaults. Of one that is broken nothing is taken.
[[nodiscard]] LoadedSettings load_settings(const std::string& path);

/// Replaces the whole file, or leaves it as it was; makes its folder. Throws `Error` (kIo).
void save_settings(const ViewSettings& settings, const std::string& path);

}  // namespace raysheaf::viewer
