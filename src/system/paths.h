// Names of files as text: the bytes that the system uses, or UTF-8 on Windows, whose names are
// UTF-16.
#pragma once

#include <filesystem>
#include <string>

namespace raysheaf::system {

/// Bytes of Windows names that are not UTF-8 become U+FFFD, which names no file.
[[nodiscard]] std::filesystem::path path_of(const std::string& text);
[[nodiscard]] std::string text_of(const std::filesystem::path& path);

/// Whether the system takes some part of the path for anything but the name in its folder that it
/// spells: on Windows a device ("aux.png"), or a name that ends in a dot or space, which are
/// dropped.
[[nodiscard]] bool has_special_name(const std::filesystem::path& path);

}  // namespace raysheaf::system
