// The settings file: on each line the name of a setting and its value.
#pragma once

#include <string>

#include "view_settings.h"

namespace raysheaf::viewer {

/// $XDG_CONFIG_HOME/raysheaf/view, or ~/.config/raysheaf/view; empty if neither is known.
[[nodiscard]] std::string default_settings_path();

struct LoadedSettings {
  ViewSettings settings;
  std::string sentence;  ///< why the file was ignored; otherwise empty
};

/// Without a file it returns the defaults. An invalid file is ignored as a whole.
[[nodiscard]] LoadedSettings load_settings(const std::string& path);

/// Replaces the whole file, or leaves it unchanged; creates its folder. Throws `Error` (kIo).
void save_settings(const ViewSettings& settings, const std::string& path);

}  // namespace raysheaf::viewer
