// The courtyard's parts, all added to one mesh. In metres; y = 0 is the court's paving.
#pragma once

#include "scenes/builder.h"

namespace raysheaf::builtin {

struct AtriumMaterials {
  std::uint32_t blocks, paving, limestone, marble, plaster, wood, roof, bronze;
  std::uint32_t red_cloth, blue_cloth, gold_cloth, terracotta, soil, leaf, water;
};

inline constexpr float kBay = 2, kHalfWidth = 4, kHalfLength = 10, kGalleryDepth = 2.6f;
inline constexpr float kPlinth = 0.15f, kFloorHeight = 4.4f, kSlab = 0.3f, kEaves = 8.1f;
inline constexpr float kWallHalf = 0.2f;  ///< half the thickness of an arcade
inline constexpr float kArchRadius = 0.78f;

/// One of the four sides of the court. The origin of its frame is the middle of the arcade, x
/// points along it and z into the court.
struct Side {
  Affine frame;
  int bays;
  [[nodiscard]] float length() const { return kBay * static_cast<float>(bays); }
};

/// A storey of the arcades.
struct Storey {
  float floor, springing, top;
  bool is_upper;
};

// atrium_columns.cpp; each column rises from y = 0 around the y axis of `frame`.
void add_fluted_column(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                       float height);
void add_slender_column(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                        float height);
void add_pier(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame, float height);
void add_baluster(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame);

// atrium_arcade.cpp
void add_arcade(MeshBuilder& builder, const AtriumMaterials& m, const Side& side,
                const Storey& storey);
void add_balustrade(MeshBuilder& builder, const AtriumMaterials& m, const Side& side, float floor);
void add_cornice(MeshBuilder& builder, const AtriumMaterials& m, const Side& side, float y);

// atrium_building.cpp
void add_floors_and_walls(MeshBuilder& builder, const AtriumMaterials& m);
void add_gallery(MeshBuilder& builder, const AtriumMaterials& m, const Side& side);
void add_roof(MeshBuilder& builder, const AtriumMaterials& m, const Side& side);

// atrium_things.cpp
void add_banner(MeshBuilder& builder, std::uint32_t cloth, std::uint32_t rod, const Affine& frame);
void add_potted_plant(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                      std::uint64_t seed);
void add_fountain(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame);

}  // namespace raysheaf::builtin
