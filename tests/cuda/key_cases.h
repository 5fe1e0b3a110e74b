// Every device function that computes ray keys, on random input. stage_bodies.cu has the keys of
// azimuths and polar angles instead.
#pragma once

#include "cuda/words.h"
#include "paper/order/key_body.h"
#include "render/rays/hash_body.h"

namespace raysheaf::test {

RAYSHEAF_HD inline Box random_box(Draws& draws) {
  const Vec3 corner = draws.in_box(5);
  return {corner, corner + abs(draws.in_box(9))};
}

struct KeyCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Vec3 direction = draws.direction();
    const Box box = random_box(draws);
    const std::uint32_t lights = 1 + draws.below(20);
    const ShadowKeyLayout layout = shadow_key_layout(lights);
    out.put(octahedral(direction), layout.key_bits(), quantized(draws.between(-0.1f, 1.1f), 6));
    out.put(shadow_key(layout, draws.below(lights), octahedral(direction)), spread_by_5(lights));
    out.put(hilbert_2(draws.below(256), 77, 8));
    out.put(bounce_key(box, draws.in_box(9), direction));
  }
};

template <int kDimensions>
RAYSHEAF_HD inline Cell<kDimensions> random_cell(Draws& draws, std::uint32_t bits) {
  Cell<kDimensions> cell;
  for (std::uint32_t& x : cell.axis) x = draws.bits() >> (32 - bits);
  return cell;
}

struct CurveCase {
  template <int kDimensions>
  RAYSHEAF_HD static void put_places(Draws& draws, Words& out) {
    const std::uint32_t bits = 1 + draws.below(kMostCellBits<kDimensions>);
    const Cell<kDimensions> cell = random_cell<kDimensions>(draws, bits);
    out.put(morton_place(cell), hilbert_place(cell, bits), spread<kDimensions>(cell.axis[0]));
  }
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    put_places<2>(draws, out);
    put_places<3>(draws, out);
    put_places<4>(draws, out);
    put_places<5>(draws, out);
    put_places<6>(draws, out);
    std::uint32_t first = draws.bits(), other = draws.bits();
    turn_back(draws.below(32), first, other);
    out.put(first, other, spread_groups<3, 16>(first & 0x1fffffu));
    const std::uint32_t group = 1 + draws.below(16);
    out.put(spread_mask(group, 2 + draws.below(5)));
    const Cell<2> square = random_cell<2>(draws, 9);
    const Cell<5> both = joined(square, random_cell<3>(draws, 9));
    for (const std::uint32_t x : both.axis) out.put(x);
  }
};

/// A cell whose computation uses no library function: not the spherical one.
RAYSHEAF_HD inline KeyCell random_key_cell(Draws& draws) {
  const KeyCell cells[5] = {KeyCell::kPixel, KeyCell::kOctahedral, KeyCell::kEnd,
                            KeyCell::kOctahedralAndStart, KeyCell::kStartAndEnd};
  return cells[draws.below(5)];
}

RAYSHEAF_HD inline std::uint32_t axes_of(KeyCell cell) {
  return cell == KeyCell::kEnd                  ? 3
         : cell == KeyCell::kOctahedralAndStart ? 5
         : cell == KeyCell::kStartAndEnd        ? 6
                                                : 2;
}

RAYSHEAF_HD inline KeyContext random_key_context(Draws& draws, KeyCell cell, std::uint32_t lights) {
  const bool pixel = cell == KeyCell::kPixel;
  const std::uint32_t key_bits = draws.below(2) == 0 ? 32 : 64;
  KeyContext context;
  context.cell = cell;
  context.hilbert = !pixel && draws.below(2) == 0;
  context.width = 640;
  context.pixel_bits = pixel ? bits_for(context.width) : 0;
  context.layout =
      key_layout(lights, axes_of(cell), key_bits, pixel ? context.pixel_bits : kMostAxisBits);
  context.cube = key_cube(random_box(draws));
  return context;
}

/// Half of the rays have an end; a quarter are perpendicular to an axis.
RAYSHEAF_HD inline Ray random_ray(Draws& draws) {
  Ray ray;
  ray.origin = draws.in_box(12);
  ray.direction = draws.in_box(2);
  if (draws.below(4) == 0) ray.direction.x = 0;
  if (draws.below(2) == 0) ray.t_max = draws.between(0, 9);
  return ray;
}

struct RayKeyCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const std::uint32_t lights = 1 + draws.below(20);
    const KeyContext context = random_key_context(draws, random_key_cell(draws), lights);
    KeyedRay keyed;
    keyed.ray = random_ray(draws);
    keyed.square = octahedral(keyed.ray.direction);
    keyed.pixel = draws.below(640 * 480);
    keyed.light = draws.below(lights);
    out.put(context.layout.bits(), context.layout.axis_bits, context.hilbert);
    out.put(context.cube.scale, curve_place(context, keyed), curve_key(context, keyed));
  }
};

struct KeyCellCase {
  template <int kDimensions>
  RAYSHEAF_HD static void put_cell(Words& out, const Cell<kDimensions>& cell) {
    for (const std::uint32_t x : cell.axis) out.put(x);
  }
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const KeyContext context = random_key_context(draws, KeyCell::kPixel, 1 + draws.below(4));
    const Ray ray = random_ray(draws);
    const RayEnds ends = ray_ends(context.cube.box, ray);
    float first = 0, last = draws.between(0, 9);
    clip_to_slab(-1, draws.between(0, 2), ray.origin.x, ray.direction.x, &first, &last);
    out.put(ends.start, ends.end, first, last, cell_of(draws.between(-0.1f, 1.1f), 24));
    put_cell(out, square_cell(octahedral(ray.direction), 16));
    put_cell(out, cube_cell(context.cube, ends.start, 21));
    const Cell<2> cell = pixel_cell(context, draws.below(640 * 480));
    put_cell(out, cell);
    out.put(place_on_curve(context, cell));
  }
};

}  // namespace raysheaf::test
