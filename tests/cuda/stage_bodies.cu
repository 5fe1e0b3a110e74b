// Compiles the device functions of base/, geom/ and the stages.
#include "cuda/compile_case.h"
#include "cuda/key_cases.h"
#include "cuda/light_cases.h"
#include "cuda/resolve_cases.h"
#include "cuda/stage_cases.h"
#include "cuda/triangle_cases.h"
#include "paper/order/published_body.h"

namespace raysheaf::test {
std::vector<CompiledCase> compiled_stage_cases() {
  return {compiled<VectorCase>("Vector"),     compiled<AffineCase>("Affine"),
          compiled<BitsCase>("Bits"),         compiled<RoundingCase>("Rounding"),
          compiled<SphereCase>("Sphere"),     compiled<ConeCase>("Cone"),
          compiled<RayBoundCase>("RayBound"), compiled<FlattenCase>("Flatten"),
          compiled<ShapeCase>("Shape"),       compiled<SurfaceCase>("Surface"),
          compiled<TextureCase>("Texture"),   compiled<StagedSurfaceCase>("StagedSurface"),
          compiled<CutoutCase>("Cutout"),     compiled<TrigonometryCase>("Trigonometry"),
          compiled<LightCase>("Light"),       compiled<ChosenLightCase>("ChosenLight"),
          compiled<LensCase>("Lens"),         compiled<SkyMapCase>("SkyMap"),
          compiled<SkyLightCase>("SkyLight"), compiled<CameraCase>("Camera"),
          compiled<SampleCase>("Sample"),     compiled<KeyCase>("Key"),
          compiled<CurveCase>("Curve"),       compiled<RayKeyCase>("RayKey"),
          compiled<KeyCellCase>("KeyCell"),   compiled<ScatterCase>("Scatter"),
          compiled<OffsetCase>("Offset"),     compiled<ShadeCase>("Shade"),
          compiled<OrderCase>("Order"),       compiled<ConeSphereCase>("ConeSphere"),
          compiled<TriangleCase>("Triangle"), compiled<WideCase>("Wide"),
          compiled<ResolveCase>("Resolve"),   compiled<SilhouetteCase>("Silhouette")};
}

/// Functions whose input cannot be made on a device: they are compiled but never run. A Light has a
/// name, a std::string; a device can only read a light that the host has made.
__global__ void run_others(const Light* lights, const Fragment* fragments, const TextureSlot* slots,
                           Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const PlacedLight light = placed_light(lights[i]);
  const Fragment& f = fragments[i];
  const SpotEdge edge = spot_edge(lights[i]);
  out[i].put(edge.cos_outer, edge.span);
  out[i].put(std::uint32_t{rays_of(f, scatter(f))});
  out[i].put(transform_uv(placed_texture(slots[i]), {light.radius, light.range}));
}

/// The resolve lowers words that threads share, so they cannot lie in one thread's local memory.
__global__ void run_resolve(Resolve<SmallPicture::Two> resolve, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  look_from_pixel(resolve, i % 2, 0, i % SmallPicture::kPixels);
  out[i].put(seen_now(&resolve.sight[i % SmallPicture::kPixels]));
}

/// Angles come from library functions, so host and device may differ.
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
