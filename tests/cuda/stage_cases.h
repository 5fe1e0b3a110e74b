// Every device function of the stages, on random input; a few are in stage_bodies.cu instead.
#pragma once

#include "animation/shape_body.h"
#include "base/mirrors_body.h"
#include "cuda/geometry_cases.h"
#include "geom/surface_body.h"
#include "intersect/facing_body.h"
#include "intersect/intersect_list.h"
#include "intersect/triangle_body.h"
#include "paper/order/order_body.h"
#include "paper/ray_hierarchy/cone_sphere_body.h"
#include "render/device/cutout_loops_device.h"
#include "render/device/staged_scene.h"
#include "render/rays/camera_body.h"
#include "render/rays/sample_body.h"
#include "render/rays/scatter_body.h"
#include "render/rays/shadow_body.h"
#include "render/shade/shade_body.h"
#include "render/surface/texture_body.h"
#include "scene/flatten_body.h"
#include "scene/mesh_bound_body.h"

namespace raysheaf::test {

struct FlattenCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    const Vec3 a = draws.in_box(2) * scale, b = draws.in_box(2) * scale;
    const Vec3 c = draws.below(4) == 0 ? b : draws.in_box(2) * scale;
    const Sphere sphere = conservative_triangle_sphere(a, b, c);
    out.put(has_no_area(a, b, c), squared_distance_in_double(a, b), sphere.center, sphere.radius);
    const Sphere shape = shape_sphere(shape_center({min(a, b), max(a, b)}), draws.unit() * scale);
    out.put(shape.center, shape.radius);
    const Affine map = draws.map();
    const Sphere moved = transformed(sphere, map);
    out.put(largest_stretch(map), moved.center, moved.radius);
    Vec3 corner[3] = {a, b, c};
    out.put(mirrors(map), place_corners(map, corner));
    collapse_flat(corner);
    out.put(corner[0], corner[1], corner[2]);
  }
};

/// Three vertices on two joints, with a target that moves them and one that does not.
struct ShapeCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    Vec3 rest[3], normals[3], moves[3], moved[3], turned[3];
    float weights[2] = {draws.between(-1, 1), 0};
    if (draws.below(2) == 0) weights[1] = draws.unit();
    float pulls[6];
    std::uint32_t joints[6];
    for (int k = 0; k < 3; ++k) {
      rest[k] = draws.in_box(9);
      normals[k] = turned[k] = draws.direction();
      moves[k] = draws.in_box(1);
    }
    for (int i = 0; i < 6; ++i) {
      pulls[i] = draws.below(3) == 0 ? 0 : draws.unit();
      joints[i] = draws.below(2);
    }
    Affine maps[2];
    for (Affine& map : maps) map = draws.map();
    const TargetView targets[2] = {{moves, nullptr}, {nullptr, moves}};
    const ShapeView shape{View<const Vec3>(rest, 3),
                          View<const Vec3>(normals, 3),
                          View<const TargetView>(targets, 2),
                          View<const float>(weights, 2),
                          draws.below(2) * 2,
                          View<const std::uint32_t>(joints, 6),
                          View<const float>(pulls, 6),
                          View<const Affine>(maps, 2)};
    for (std::size_t v = 0; v < 3; ++v) deform_vertex(shape, v, moved, turned);
    out.put(moved[0], moved[1], moved[2], turned[0], turned[1], turned[2]);
    out.put(morphed(shape, &TargetView::normals, rest[1], 1));
    out.put(transform_point(blended(shape, 0), rest[2]));
    const std::uint32_t corners[3] = {2, 0, 1};
    flatten_normals_of(corners, moved, turned);
    out.put(turned[0]);
  }
};

struct SurfaceCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Vec3 a = draws.in_box(9), b = draws.in_box(9), c = draws.in_box(9);
    const float u = draws.unit(), v = draws.between(0, 1 - u);
    const MixedPoint point = mixed_point(a, b, c, u, v);
    const Wide normal = cross(difference(b, a), difference(c, a));
    out.put(point.position, point.reach, unit(normal, {0, 0, 1}), dot(normal, widened(a)));
    out.put(clearance(point, unit(normal, {0, 0, 1})));
    out.put(unit_normal(normal_map(draws.map()), a, {0, 0, 1}));
    const Vec3 geometric = draws.direction(), shading = draws.direction();
    out.put(on_side_of(geometric, shading));
  }
};

struct CutoutCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Ray ray{draws.in_box(9), 0, draws.direction(), 9};
    PlacedMaterial m;
    m.alpha = draws.unit();
    m.alpha_cutoff = draws.below(2) == 0 ? 0 : draws.unit();
    m.alpha_blend = draws.below(2) == 0;
    m.base_color_texture.texture = draws.below(2) == 0 ? 0 : kInvalidId;
    const std::uint32_t triangle = draws.below(1000);
    const bool blends = draws.below(2) == 0;
    out.put(is_by_chance(m, blends));
    out.put(chance_of(ray, triangle), least_alpha(m),
            is_cutout(m, m.alpha, blends, draws.below(2) == 0));
    out.put(is_cut_away(m, draws.unit(), blends, ray, triangle));
    out.put(just_behind(draws.between(-1, 1)), just_behind(0));
    out.put(just_behind(draws.unit() * 0x1p-140f));
  }
};

/// Without a rotation, which needs a sine.
struct TextureCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    std::uint8_t rgba[3 * 2 * 4];
    for (std::uint8_t& x : rgba) x = static_cast<std::uint8_t>(draws.below(16));
    float decode[16];
    for (int i = 0; i < 16; ++i) decode[i] = static_cast<float>(i * i) / 225;
    TextureView texture{rgba, 3, 2};
    texture.wrap_u = static_cast<Wrap>(draws.below(3));
    texture.wrap_v = static_cast<Wrap>(draws.below(3));
    texture.filter = static_cast<Filter>(draws.below(2));
    TextureSlot slot;
    slot.scale = {draws.between(-3, 3), 2};
    const Vec2 uv =
        transform_uv(placed_texture(slot), {draws.between(-2, 2), draws.between(-2, 2)});
    out.put(uv, sample(texture, decode, uv), texel(texture, decode, 2, 1));
    out.put(mix({1, 2, 3, 4}, {4, 3, 2, 1}, uv.x), wrapped(texture.wrap_u, uv.y));
    out.put(wrapped_texel(texture.wrap_v, static_cast<std::int64_t>(draws.below(5)) - 1, 3));
  }
};

/// A triangle with all attributes, from the arrays of a scene.
struct StagedSurfaceCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    Vec3 corners[3], normals[3], vertex_colors[3];
    Vec2 uvs[3], second_uvs[3];
    float alphas[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = draws.in_box(9);
      normals[k] = draws.direction();
      uvs[k] = {draws.between(-2, 2), draws.between(-2, 2)};
      second_uvs[k] = {draws.between(-2, 2), draws.between(-2, 2)};
      alphas[k] = draws.unit();
      vertex_colors[k] = abs(draws.in_box(1));
    }
    const std::uint32_t mesh_of[1] = {0};
    const StagedTriangle triangles[1] = {{{2, 0, 1}}};
    const std::uint32_t numbers[1] = {draws.below(3)};
    StagedMesh meshes[1];
    meshes[0].material_count = draws.below(2);
    meshes[0].has_normals = draws.below(2) == 0;
    meshes[0].has_uvs = draws.below(2) == 0;
    meshes[0].has_second_uvs = draws.below(2) == 0;
    meshes[0].has_colors = draws.below(2) == 0;
    meshes[0].has_alphas = draws.below(2) == 0;
    meshes[0].mirrored = draws.below(2) == 0;
    meshes[0].normal_map = normal_map(draws.map());
    std::uint8_t rgba[2 * 2 * 4];
    for (std::uint8_t& x : rgba) x = static_cast<std::uint8_t>(draws.below(256));
    float decode[256];
    for (int i = 0; i < 256; ++i) decode[i] = static_cast<float>(i * i) / 65025;
    const TextureView textures[1] = {{rgba, 2, 2}};
    PlacedMaterial materials[3];
    for (PlacedMaterial& m : materials) {
      m.base_color = abs(draws.in_box(1));
      m.metallic = draws.unit();
      m.transmission = draws.below(2) == 0 ? 0 : draws.unit();
      m.ior = draws.between(0, 2);
      m.thin = draws.below(2) == 0;
      m.unlit = draws.below(8) == 0;
      m.alpha = draws.unit();
      m.alpha_cutoff = draws.below(2) == 0 ? 0 : draws.unit();
      m.alpha_blend = draws.below(2) == 0;
      if (draws.below(2) == 0) m.normal_texture.texture = 0;
      m.normal_scale = draws.unit();
      if (draws.below(2) != 0) continue;
      m.base_color_texture.texture = m.metallic_roughness_texture.texture = draws.below(2);
      m.base_color_texture.cosine = m.base_color_texture.sine = 0.70710678f;
      m.base_color_texture.rotated = draws.below(2) == 0;
      m.base_color_texture.second_uvs = draws.below(2) == 0;
    }
    const TextureTable table{View<const TextureView>(textures, 1), decode, decode};
    const StagedSceneView scene{View<const Vec3>(corners, 3),
                                View<const std::uint32_t>(mesh_of, 1),
                                View<const StagedMesh>(meshes, 1),
                                View<const StagedTriangle>(triangles, 1),
                                View<const Vec3>(normals, 3),
                                View<const Vec2>(uvs, 3),
                                View<const Vec2>(second_uvs, 3),
                                View<const Vec3>(vertex_colors, 3),
                                View<const float>(alphas, 3),
                                View<const std::uint32_t>(numbers, 1),
                                View<const PlacedMaterial>(materials, 3),
                                table};
    const float u = draws.unit(), v = draws.between(0, 1 - u);
    const Vec3 along = draws.direction();
    const Surface s = staged_surface(scene, 0, u, v, along);
    out.put(s.position, s.geometric_normal, s.normal, s.diffuse, s.specular, s.coat);
    out.put(s.transmission_color, s.emission, s.roughness, s.transmission, s.ior);
    out.put(s.specular_edge, s.coat_edge, s.clearance, s.unlit, s.thin, s.front);
    out.put(s.material);
    const Ray ray{s.position - along * 2, 0, along, 9};
    out.put(staged_is_cut_away(scene, ray, 0, draws.below(2) == 0));
    const Vec3 front = front_normal(corners, false);
    const PlacedSurface placed =
        placed_surface(corners, front, &normals, meshes[0].normal_map, u, v, along);
    out.put(placed.normal, staged_material(scene, meshes[0], 0), is_plain(materials[0]));
    const TriangleUv all = staged_uv(scene, meshes[0], triangles[0]);
    out.put(is_bumpy(materials[0])
                ? textured_normal(materials[0], table, corners, all, u, v, placed)
                : bumped_normal(corners, uvs, placed.normal, draws.in_box(1)));
    const TextureColors colors = texture_colors(materials[0], table, mixed(all, u, v));
    Surface look;
    set_material(materials[1], colors, &look);
    out.put(look.diffuse, look_up(table, materials[2].base_color_texture, decode, uvs[0]));
  }
};

/// The host makes the lights (see stage_bodies.cu); this case computes samples from their data.
struct SampleCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const std::uint32_t index = draws.bits(), seed = draws.bits();
    const FractionPair pair = scrambled_sobol(index, seed);
    out.put(pair.x, pair.y, reversed_bits(index), mixed_seed(index, seed), sobol_second(index));
    out.put(owen_scrambled(index, seed), unit_fraction(seed));
    out.put(sample_pair({index, 7}, choice_seed(Choice::kLight, seed, index, 3)));
  }
};

RAYSHEAF_HD inline CameraFrame random_frame(Draws& draws) {
  CameraFrame frame;
  frame.eye = draws.in_box(4);
  frame.right = draws.direction();
  frame.up = draws.direction();
  frame.forward = draws.direction();
  frame.half_width = draws.unit();
  frame.width = 640;
  frame.height = 480;
  frame.orthographic = draws.below(2) == 0;
  return frame;
}

struct CameraCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const CameraFrame frame = random_frame(draws);
    const std::uint32_t x = draws.below(frame.width), y = draws.below(frame.height);
    out.put(pixel_center(x, frame.width), camera_ray(frame, x, y));
  }
};

RAYSHEAF_HD inline Fragment random_fragment(Draws& draws) {
  Fragment f;
  f.triangle = draws.below(8) == 0 ? kInvalidId : 1;
  f.incoming = draws.direction();
  f.surface.position = draws.in_box(10);
  const Vec3 side = draws.direction();
  f.surface.geometric_normal = dot(side, f.incoming) > 0 ? -side : side;
  f.surface.normal = normalized(f.surface.geometric_normal + draws.in_box(0.3f));
  f.surface.diffuse = abs(draws.in_box(1));
  f.surface.specular = draws.below(4) == 0 ? Vec3{0, 0, 0} : abs(draws.in_box(1));
  f.surface.specular_edge = draws.unit();
  f.surface.coat_edge = draws.unit();
  f.surface.transmission_color = abs(draws.in_box(1));
  f.surface.roughness = draws.unit();
  f.surface.transmission = draws.below(2) == 0 ? 0 : draws.unit();
  f.surface.clearance = 1e-6f;
  f.surface.front = draws.below(2) == 0;
  f.surface.thin = draws.below(4) == 0;
  f.surface.unlit = draws.below(16) == 0;
  return f;
}

struct ScatterCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Fragment f = random_fragment(draws);
    const Scattering s = scatter(f);
    out.put(s.reflection, s.refraction, s.reflected_part, s.refracted_part, s.diffuse_part);
    out.put(meets_outside(f.surface), s.mirror, worth_tracing(f.surface.diffuse * 0.002f),
            mirror_direction(f));
    out.put(reflected(f.incoming, f.surface.normal), fresnel_dielectric(cos_arrival(f), 1.3f));
    Scattering parts = scattered_parts(f);
    split_at_glass(f.surface, 0.5f, &parts);
    out.put(refracted(f, 0.5f), fresnel_schlick(f.surface.specular, f.surface.specular_edge, 0.5f),
            parts.refracted_part);
    const Bounce mirror = bounce(f, RayKind::kReflection), glass = bounce(f, RayKind::kRefraction);
    out.put(mirror.direction, mirror.part, glass.direction, glass.part);
    const std::uint32_t rays = rays_of(f, s);
    out.put(rays, (rays & bit_of(RayKind::kRefraction)) != 0);
  }
};

struct OffsetCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Fragment f = random_fragment(draws);
    const float distance = draws.unit();
    out.put(offset_point(f.surface, draws.direction(), distance));
    const Vec3 corner = draws.in_box(3);
    const LightReach reach = light_reach({corner, corner + abs(draws.in_box(3))});
    out.put(reach.center, reach.radius, way_out(reach.bounds, reach.center, draws.direction()));
    out.put(faces_light(f, {draws.direction(), 1, {1, 1, 1}, {0, 0, 0}}));
  }
};

struct ShadeCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Fragment f = random_fragment(draws);
    const std::uint32_t traced = draws.below(2) == 0 ? kReflects : kRefracts;
    out.put(reflectance(f, draws.direction()), glow(f, scatter(f), {1, 2, 3}, traced));
    StudioRoom room;
    room.up = draws.direction();
    room.back = draws.direction();
    room.white = 1 + draws.unit();
    for (SoftBox& box : room.boxes) {
      box.axis = draws.direction();
      box.side = draws.direction();
      box.top = draws.direction();
      box.radiance = draws.unit();
    }
    out.put(room_glow(f, scatter(f), {1, 2, 3}, room, traced));
    out.put(studio_radiance(room, draws.direction(), f.surface.roughness));
    const float x = draws.between(-2, 2);
    out.put(smooth_step(x), blurred_interval(x, 0.5f, 0.25f), wall_brightness(x, 0.5f * x));
  }
};

struct OrderCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    std::uint32_t keys[8], starts[8];
    for (int i = 0; i < 8; ++i) {
      keys[i] = draws.below(3);
      starts[i] = i == 0 ? 0 : starts[i - 1] + 1 + draws.below(5);
    }
    out.put(begins_chunk(keys, 0), begins_chunk(keys, 5), chunk_at(starts, 8, draws.below(40)));
    const std::uint32_t slot = draws.below(9);
    out.put(chunk_of_head(1 + slot));
  }
};

struct ConeSphereCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const ConeSphereTest node = make_cone_sphere_test(random_ray_bound(draws));
    for (int i = 0; i < 8; ++i) {
      const Vec3 center = draws.in_box(12);
      out.put(meets(node, center, draws.unit()));
    }
  }
};

}  // namespace raysheaf::test
