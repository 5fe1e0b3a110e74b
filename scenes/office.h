// The furniture of the office, in metres. The floor is y = 0; the front faces +z.
#pragma once

#include "scenes/builder.h"

namespace raysheaf::builtin {

/// The office's materials, as indices.
struct OfficeMaterials {
  std::uint32_t white_wall, accent_wall, ceiling, floor, rug, trim;
  std::uint32_t oak, walnut, white, black, grey, silver, brass;
  std::uint32_t mirror, chrome, glass;
  std::uint32_t blue_fabric, orange_fabric, curtain, terracotta, porcelain, red_glaze, soil, coffee,
      paper;
  std::uint32_t leaf, light_leaf, lamp_glow, screen, view, landscape, art, paint_green;
};

[[nodiscard]] OfficeMaterials office_materials(Stage& stage);

// office_room.cpp
inline constexpr float kRoomHalfWidth = 3, kRoomHeight = 2.8f, kRoomBack = -4, kRoomFront = 3.8f;
void build_room(Stage& stage, const OfficeMaterials& m);
void hang_on_walls(Stage& stage, const OfficeMaterials& m);

// office_desk.cpp
[[nodiscard]] Kit desk(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit monitor(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit keyboard_and_mouse(Stage& stage, const OfficeMaterials& m);

// office_chair.cpp
[[nodiscard]] Kit chair(Stage& stage, const OfficeMaterials& m, std::uint32_t fabric);

// office_things.cpp
[[nodiscard]] Kit desk_lamp(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit mug(Stage& stage, const OfficeMaterials& m, std::uint32_t glaze);
[[nodiscard]] Kit glass_ball(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit glass_drop(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit pen_cup(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit paper_stack(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit waste_bin(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit ceiling_lamp(Stage& stage, const OfficeMaterials& m);

// office_plant.cpp
[[nodiscard]] Kit small_plant(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit tall_plant(Stage& stage, const OfficeMaterials& m);

// office_shelf.cpp
/// Eight bindings, 1 m high, 1 m deep and 1 m thick, to be scaled; their backs face +z.
[[nodiscard]] std::vector<std::uint32_t> books(Stage& stage, const OfficeMaterials& m);
[[nodiscard]] Kit bookshelf(Stage& stage, const OfficeMaterials& m,
                            const std::vector<std::uint32_t>& books, std::uint64_t seed);

}  // namespace raysheaf::builtin
