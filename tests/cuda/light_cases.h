// Lights, a lens and a sky on devices, including sines and cosines.
#pragma once

#include "base/trigonometry.h"
#include "cuda/stage_cases.h"
#include "render/rays/sky_body.h"

namespace raysheaf::test {

struct TrigonometryCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const double small = static_cast<double>(draws.between(-0.78f, 0.78f));
    const double angle = static_cast<double>(draws.between(-1000, 1000));
    const portable::SineCosine turn = portable::sine_cosine(angle);
    const double x = static_cast<double>(draws.between(-2, 2));
    const double y = static_cast<double>(draws.unit());
    out.put(portable::polynomial(small, 1.0, 2.0, 3.0), portable::small_sine(small));
    out.put(portable::small_cosine(small), turn.sine, turn.cosine);
    out.put(portable::angle_of(y, x), portable::arc_cosine(x / 2));
    out.put(on_circle(draws.unit()));
  }
};

RAYSHEAF_HD inline PlacedLight random_light(Draws& draws) {
  PlacedLight light;
  light.position = draws.in_box(9);
  light.direction = draws.direction();
  light.right = tangents(light.direction).s;
  light.intensity = abs(draws.in_box(9));
  light.range = draws.between(1, 20);
  light.radius = draws.between(0, 2);
  light.width = draws.between(0.1f, 3);
  light.height = draws.between(0.1f, 3);
  light.has_range = draws.below(2) == 0;
  light.is_spot = draws.below(2) == 0;
  light.is_directional = draws.below(4) == 0;
  light.is_rectangle = draws.below(3) == 0;
  light.cos_outer = draws.unit();
  light.span = 0.25f;
  return light;
}

RAYSHEAF_HD inline void put_sample(const LightSample& seen, Words& out) {
  out.put(seen.to_light, seen.distance, seen.irradiance, seen.point);
}

struct LightCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const PlacedLight light = random_light(draws);
    const Vec3 position = draws.in_box(9);
    const float across = draws.unit(), along = draws.unit();
    put_sample(sample_point(light, position), out);
    put_sample(sample_ball(light, position, {across, along}), out);
    put_sample(sample_rectangle(light, position, {across, along}), out);
    const RectanglePlace place = place_by_solid_angle({-1, -1, 1, 1, -1}, {across, along});
    out.put(static_cast<float>(place.x), static_cast<float>(place.y),
            static_cast<float>(place.solid_angle));
    out.put(light_window(light, draws.direction(), across), has_size(light));
    out.put(off_light(position, light.direction, along));
  }
};

struct ChosenLightCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const PlacedLight light = random_light(draws);
    const Fragment f = random_fragment(draws);
    const std::uint32_t index = draws.below(9);
    const LightSample seen = choose_on_light(f, light, index, {index, index < 3 ? 1u : 16u});
    const LightReach reach = light_reach({{-9, -9, -9}, {11, 13, 15}});
    const Ray ray = shadow_ray(f, seen, reach);
    out.put(takes_light(f), faces_light(f, seen), ray, shadow_place(light, ray, reach));
    out.put(lit_by(f, seen), sample_light(light, f.surface.position).irradiance);
  }
};

struct LensCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    CameraFrame frame = random_frame(draws);
    frame.lens_radius = draws.unit();
    frame.focus = draws.between(1, 9);
    frame.sample = {draws.below(16), 16};
    const std::uint32_t x = draws.below(frame.width), y = draws.below(frame.height);
    out.put(camera_ray(frame, x, y));
    const float across = draws.unit(), along = draws.unit();
    out.put(through_lens(frame, pinhole_ray(frame, column_right(frame, x) - row_up(frame, y)),
                         on_disc({across, along})));
  }
};

/// Four by two texels, and the tables for sampling them.
struct SmallSky {
  Vec3 radiance[8];
  float row_ends[2], texel_ends[8];

  RAYSHEAF_HD explicit SmallSky(Draws& draws) {
    for (Vec3& texel : radiance) texel = abs(draws.in_box(4));
    row_ends[0] = draws.unit();
    row_ends[1] = 1;
    for (int i = 0; i < 8; ++i) texel_ends[i] = 0.25f * static_cast<float>(i % 4 + 1);
  }
  [[nodiscard]] RAYSHEAF_HD EnvironmentView view() const {
    return {radiance, row_ends, texel_ends, 4, 2, 1.5f, 0.8f, 0.6f};
  }
};

struct SkyMapCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const SmallSky small(draws);
    const EnvironmentView sky = small.view();
    const float across = draws.unit(), along = draws.unit();
    const ChosenDirection chosen = choose_direction(sky, {across, along});
    const Vec3 way = draws.direction();
    const Vec2 place = map_place(sky, way);
    out.put(chosen.direction, chosen.density, place, map_direction(sky, place));
    out.put(turned(way, sky.cos_rotation, sky.sin_rotation), direction_density(sky, way));
    out.put(environment_radiance(sky, way), environment_texel(sky, -1, 2));
    out.put(density_of_part(sky, 0.5f, along), choose_part(sky.row_ends, 2, along).index);
  }
};

struct SkyLightCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const SmallSky small(draws);
    const EnvironmentView sky = small.view();
    const Fragment f = random_fragment(draws);
    const std::uint32_t strategy = draws.below(kSkyStrategies), index = draws.below(8);
    const LightSample found = choose_in_sky(f, sky, strategy, {index, 8});
    const SurfaceLobes lobes = surface_lobes(f);
    const float across = draws.unit(), along = draws.unit();
    put_sample(found, out);
    out.put(lit_by_sky(f, found), glossy_density(lobes, found.to_light));
    out.put(glossy_direction(lobes, {across, along}), matte_direction(lobes, {across, along}));
    out.put(surface_direction(lobes, {across, along}), surface_density(lobes, found.to_light));
    const std::uint32_t reflects = draws.below(2) == 0 ? kReflects : 0;
    const std::uint32_t refracts = draws.below(2) == 0 ? kRefracts : 0;
    out.put(environment_glow(f, scatter(f), sky, reflects | refracts));
  }
};

}  // namespace raysheaf::test
