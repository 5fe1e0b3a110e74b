// Finds the test scenes: in RAYSHEAF_SCENES, or in ../shared/scenes next to the checkout.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace raysheaf::test {

/// The folder, or an empty path if there is none.
inline std::filesystem::path scenes_directory() {
  if (const char* named = std::getenv("RAYSHEAF_SCENES"); named != nullptr && *named != '\0')
    return named;
  const std::filesystem::path beside =
      std::filesystem::path(RAYSHEAF_SOURCE_DIR) / "../shared/scenes";
  return std::filesystem::is_directory(beside) ? beside : std::filesystem::path{};
}

}  // namespace raysheaf::test

/// Sets `path` to a scene's file, or skips the test if the scenes are missing.
#define RAYSHEAF_SCENE_OR_SKIP(path, relative)                                         \
  const std::string path = (raysheaf::test::scenes_directory() / (relative)).string(); \
  if (raysheaf::test::scenes_directory().empty() || !std::filesystem::exists(path))    \
  GTEST_SKIP() << "no scene " << (relative) << " (set RAYSHEAF_SCENES)"
