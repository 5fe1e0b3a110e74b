// Compiles every body for the device. That it compiles is a check of its own; bodies_test.cu runs
// it where there is a device.
#include "cuda/compiled_cases.h"
#include "cuda/stage_cases.h"

namespace raysheaf::test {
namespace {

template <class Case>
__global__ void run_on_device(std::uint32_t count, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  Draws draws(i);
  Case{}(draws, out[i]);
}

template <class Case>
void run_on_host(std::uint32_t count, Words* out) {
  for (std::uint32_t i = 0; i < count; ++i) {
    Draws draws(i);
    Case{}(draws, out[i]);
  }
}

template <class Case>
CompiledCase compiled(const char* name) {
  return {name, run_on_host<Case>, run_on_device<Case>};
}

}  // namespace

std::vector<CompiledCase> compiled_cases() {
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
          compiled<CameraCase>("Camera"),
          compiled<KeyCase>("Key"),
          compiled<ScatterCase>("Scatter"),
          compiled<OffsetCase>("Offset"),
          compiled<ShadeCase>("Shade"),
          compiled<OrderCase>("Order"),
          compiled<ConeSphereCase>("ConeSphere"),
          compiled<TriangleCase>("Triangle"),
          compiled<ResolveCase>("Resolve")};
}

/// What two machines need not agree on, or a device cannot make input for: compiled, never run.
/// Sines and cosines are a library's own. A Light has a name, a std::string; a device can only read
/// one where it lies.
__global__ void run_others(const Light* lights, const Fragment* fragments, LightReach reach,
                           const TextureSlot* slots, Words* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const Light& light = lights[i];
  const Fragment& f = fragments[i];
  const LightSample sample = sample_light(light, f.surface.position);
  const Ray ray = shadow_ray(f, light, sample, reach);
  out[i].put(light_window(light, sample.to_light, sample.distance), faces_light(f, sample));
  out[i].put(ray, shadow_place(light, ray, reach), lit_by(f, light));
  out[i].put(transform_uv(slots[i], {sample.distance, ray.t_max}));
}

}  // namespace raysheaf::test
