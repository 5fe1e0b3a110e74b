// Small procedural images. Those for surfaces repeat without a seam.
#pragma once

#include "raysheaf/scene_description.h"

namespace raysheaf::builtin {

[[nodiscard]] Image wood_grain();    ///< grain along u
[[nodiscard]] Image floor_planks();  ///< eight rows of boards along u
[[nodiscard]] Image rug();           ///< a border and diamonds
[[nodiscard]] Image landscape();     ///< hills in the evening
[[nodiscard]] Image abstract_art();  ///< discs and bars
[[nodiscard]] Image window_view();   ///< sky, clouds and trees
[[nodiscard]] Image screen_text();   ///< an editor with coloured lines
[[nodiscard]] Image paving();        ///< stone slabs in two sizes
[[nodiscard]] Image stone_blocks();  ///< courses of ashlar

}  // namespace raysheaf::builtin
