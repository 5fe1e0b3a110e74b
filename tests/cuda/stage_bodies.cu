// Compiles the bodies of base/, geom/ and the stages for the device.
#include "cuda/compile_case.h"
#include "cuda/key_cases.h"
#include "cuda/stage_cases.h"
#include "raygen/published_body.h"
#include "raygen/sky_body.h"

namespace raysheaf::test {
std::vector<CompiledCase> compiled_stage_cases() {
  return {compiled<VectorCase>("Vector"),
          compiled<AffineCase>("Affine"),
          compiled<BitsCase>("Bits"),
          compiled<RoundingCase>("Rounding"),
          compiled<SphereCase>("Sphere"),
          compiled<ConeCase>("Cone"),
          compiled<RayBoundCase>("RayBound"),
          compiled<FlattenCase>("Flatten"),
          compiled<SurfaceCase>("Surface"),
          compiled<TextureCase>("Texture"),
          compiled<StagedSurfaceCase>("StagedSurface"),
          compiled<PointLightCase>("PointLight"),
          compiled<CameraCase>("Camera"),
          compiled<SampleCase>("Sample"),
          compiled<KeyCase>("Key"),
          compiled<CurveCase>("Curve"),
          compiled<RayKeyCase>("RayKey"),
          compiled<KeyCellCase>("KeyCell"),
          compiled<ScatterCase>("Scatter"),
          compiled<OffsetCase>("Offset"),
          compiled<ShadeCase>("Shade"),
          compiled<OrderCase>("Order"),
          compiled<ConeSphereCase>("ConeSphere"),
          compiled<TriangleCase>("Triangle"),
          compiled<ResolveCase>("Resolve")};
}

/// What two machines need not agree on, or a device cannot make input for: compiled, never run.
/// Sines, cosines and their inverses are a library's own. A Light has a name, a std::string; a
/// device can only read one where it lies.
__global__ void run_others(const Light* lights, const Fragment* fragments, LightReach reach,
                           const TextureSlot* slots, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const Light& light = lights[i];
  const Fragment& f = fragments[i];
  const LightSample sample = sample_light(light, f.surface.position);
  const Ray ray = shadow_ray(f, choose_on_light(f, light, i, {i, 4}), reach);
  out[i].put(light_window(light, sample.to_light, sample.distance), faces_light(f, sample));
  out[i].put(ray, shadow_place(light, ray, reach), lit_by(f, sample));
  const SpotEdge edge = spot_edge(light);
  out[i].put(point_light(light).cos_outer, edge.cos_outer, edge.span, takes_light(f),
             offset_extent(f.surface.normal));
  out[i].put(std::uint32_t{rays_of(f, scatter(f))});
  out[i].put(transform_uv(placed_texture(slots[i]), {sample.distance, ray.t_max}));
}

/// The same of lights with a size, a lens and a sky.
__global__ void run_soft_light(const Light* lights, const Fragment* fragments, EnvironmentView sky,
                               CameraFrame frame, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const Light& light = lights[i];
  const Fragment& f = fragments[i];
  const Vec2 chosen = sample_pair({i, 8}, choice_seed(Choice::kSky, i, f.path, 0));
  const LightSample ball = sample_ball(light, f.surface.position, chosen);
  const LightSample plate = sample_rectangle(light, f.surface.position, chosen);
  out[i].put(sample_point(light, f.surface.position).point);
  out[i].put(has_size(light), ball.point, plate.point, off_light(ball.point, plate.point, 1));
  const RectanglePlace place = place_by_solid_angle({-1, -1, 1, 1, -1}, chosen);
  out[i].put(place.x, place.y, place.solid_angle, tangents(f.surface.normal).s);
  out[i].put(through_lens(frame, pinhole_ray(frame, i, i), on_disc(chosen)));
  const LightSample found = choose_in_sky(f, sky, i % kSkyStrategies, {i, 8});
  out[i].put(lit_by_sky(f, found), found.irradiance);
  const SurfaceLobes lobes = surface_lobes(f);
  out[i].put(glossy_density(lobes, found.to_light), glossy_direction(lobes, chosen));
  out[i].put(surface_density(lobes, found.to_light), surface_direction(lobes, chosen));
  out[i].put(matte_direction(lobes, chosen), environment_radiance(sky, found.to_light));
  out[i].put(environment_glow(f, scatter(f), sky, i % 2 == 0, i % 3 == 0));
}

__global__ void run_sky_map(EnvironmentView sky, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const ChosenDirection chosen = choose_direction(sky, {unit_fraction(i), unit_fraction(~i)});
  const Vec2 place = map_place(sky, turned(chosen.direction, sky.cos_rotation, sky.sin_rotation));
  out[i].put(map_direction(sky, place), direction_density(sky, chosen.direction));
  out[i].put(environment_texel(sky, i, -1), density_of_part(sky, 0.5f, place.y));
  out[i].put(choose_part(sky.row_ends, sky.height, place.x).index);
}

__global__ void run_angle_keys(const KeyContext context, const Ray* rays, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const Ray& ray = rays[i];
  const bool as_coded = i % 2 == 0;
  out[i].put(spherical(ray.direction), curve_key(context, {ray, {}, i, 0}));
  out[i].put(saturated(published_azimuth(ray.direction, as_coded), 31));
  out[i].put(published_shadow_key(i % 4, ray.direction, as_coded));
  out[i].put(published_bounce_key(RayKind::kRefraction, ray.origin, ray.direction, as_coded));
}

}  // namespace raysheaf::test
