// Evaluates a material at a point of its surface.
#pragma once

#include "geom/surface_body.h"
#include "render/surface/surface.h"
#include "render/surface/texture_body.h"
#include "scene/cutout.h"

namespace raysheaf {

/// A material in the form from which surfaces are computed.
struct PlacedMaterial {
  Vec3 base_color{1, 1, 1}, emission{0, 0, 0}, specular_color{1, 1, 1};
  PlacedTexture base_color_texture, metallic_roughness_texture, emission_texture, normal_texture;
  float normal_scale = 1;
  float alpha = 1, alpha_cutoff = 0;
  float metallic = 0, roughness = 1, specular = 1, transmission = 0, ior = 1.5f;
  bool unlit = false, alpha_blend = false, thin = false;
};

[[nodiscard]] inline PlacedMaterial placed_material(const Material& m) {
  PlacedMaterial placed;
  placed.base_color = {m.base_color.x, m.base_color.y, m.base_color.z};
  placed.emission = m.emission;
  placed.specular_color = m.specular_color;
  placed.base_color_texture = placed_texture(m.base_color_texture);
  placed.metallic_roughness_texture = placed_texture(m.metallic_roughness_texture);
  placed.emission_texture = placed_texture(m.emission_texture);
  placed.normal_texture = placed_texture(m.normal_texture);
  placed.normal_scale = m.normal_scale;
  placed.alpha = m.base_color.w;
  placed.alpha_cutoff = m.alpha_cutoff;
  placed.alpha_blend = m.alpha_blend;
  placed.metallic = m.metallic;
  placed.roughness = m.roughness;
  placed.specular = m.specular;
  placed.transmission = m.transmission;
  placed.ior = m.ior;
  placed.unlit = m.unlit;
  placed.thin = m.thin;
  return placed;
}

/// Whether its normal texture changes shading normals, if there are texture coordinates.
RAYSHEAF_HD inline bool is_bumpy(const PlacedMaterial& m) {
  return m.normal_texture.texture != kInvalidId && !m.unlit;
}

/// Texture coordinates of a triangle's corners, those of the mesh.
struct TriangleUv {
  Vec2 first[3], second[3];
};
RAYSHEAF_HD inline PlaceUv mixed(const TriangleUv& uv, float u, float v) {
  return {mixed(uv.first, u, v), mixed(uv.second, u, v)};
}

/// The shading normal at a point, from a bumpy material's texture. `all`: coordinates of the
/// corners.
RAYSHEAF_HD inline Vec3 textured_normal(const PlacedMaterial& m, const TextureTable& table,
                                        const Vec3 (&corner)[3], const TriangleUv& all, float u,
                                        float v, const PlacedSurface& placed) {
  const Vec2(&uv)[3] = m.normal_texture.second_uvs ? all.second : all.first;
  const Vec4 texel = look_up(table, m.normal_texture, table.as_is, mixed(all, u, v));
  // Textures with two channels have no blue, so only the magnitude along the normal is used.
  const Vec3 bump{(2 * texel.x - 1) * m.normal_scale, (2 * texel.y - 1) * m.normal_scale,
                  std::fabs(2 * texel.z - 1)};
  const Vec2 of_texture[3] = {transform_uv(m.normal_texture, uv[0]),
                              transform_uv(m.normal_texture, uv[1]),
                              transform_uv(m.normal_texture, uv[2])};
  const Vec3 normal = placed.front ? placed.normal : -placed.normal;
  const Vec3 bumped = bumped_normal(corner, of_texture, normal, bump);
  return placed.front ? bumped : -bumped;
}

/// Whether its colours are the same everywhere.
RAYSHEAF_HD inline bool is_plain(const PlacedMaterial& m) {
  return m.base_color_texture.texture == kInvalidId &&
         m.metallic_roughness_texture.texture == kInvalidId &&
         m.emission_texture.texture == kInvalidId;
}

/// The factors from textures and vertex colours for a material.
struct TextureColors {
  Vec3 base{1, 1, 1}, rough_metal{1, 1, 1}, emission{1, 1, 1};
};

RAYSHEAF_HD inline TextureColors texture_colors(const PlacedMaterial& m, const TextureTable& table,
                                                const PlaceUv& uv) {
  const auto rgb = [](Vec4 color) { return Vec3{color.x, color.y, color.z}; };
  TextureColors colors;
  colors.base = rgb(look_up(table, m.base_color_texture, table.from_srgb, uv));
  if (m.unlit) return colors;
  colors.rough_metal = rgb(look_up(table, m.metallic_roughness_texture, table.as_is, uv));
  colors.emission = rgb(look_up(table, m.emission_texture, table.from_srgb, uv));
  return colors;
}

/// Sets the material's part of a surface, except for the material's number. A mesh without texture
/// coordinates and colours uses only the material's factors.
RAYSHEAF_HD inline void set_material(const PlacedMaterial& m, const TextureColors& colors,
                                     Surface* surface) {
  const Vec3 base = m.base_color * colors.base;
  surface->unlit = m.unlit;
  if (m.unlit) {
    surface->emission = base;
    return;
  }
  const float metallic = m.metallic * colors.rough_metal.z;
  const float normal_reflectance = (m.ior - 1) / (m.ior + 1);
  const Vec3 dielectric =
      min(m.specular_color * (normal_reflectance * normal_reflectance), {1, 1, 1}) * m.specular;
  surface->roughness = m.roughness * colors.rough_metal.y;
  surface->transmission = m.transmission * (1 - metallic);
  surface->transmission_color = base;
  surface->ior = m.ior >= 1 ? m.ior : 1;
  surface->thin = m.thin;
  surface->diffuse = base * ((1 - metallic) * (1 - m.transmission));
  surface->specular = lerp(dielectric, base, metallic);
  surface->coat = dielectric;
  surface->specular_edge = m.specular + (1 - m.specular) * metallic;
  surface->coat_edge = m.specular;
  surface->emission = m.emission * colors.emission;
}

}  // namespace raysheaf
