#include "raster/gbuffer.h"

namespace raysheaf {
namespace {

Vec4 packed(Vec3 v, float w) {
  return {v.x, v.y, v.z, w};
}

}  // namespace

GBuffer fetch_gbuffer(const Executor& executor, View<const Fragment> fragments) {
  GBuffer g;
  for (auto* image : {&g.position, &g.normal, &g.diffuse, &g.specular})
    image->resize(fragments.size);
  executor.for_each(fragments.size, kCopyGrain, [&](std::size_t i) {
    const Fragment& f = fragments[i];
    if (f.triangle == kInvalidId) return;
    const Surface& s = f.surface;
    g.position[i] = packed(s.position, 1);
    g.normal[i] = packed(s.normal, s.roughness);
    g.diffuse[i] = packed(s.diffuse, s.transmission);
    g.specular[i] = packed(s.specular, s.ior);
  });
  return g;
}

}  // namespace raysheaf
