#include "raster/resolve.h"

#include <vector>

#include "exec/executor.h"
#include "raster/resolve_body.h"

namespace raysheaf {

void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const Camera& camera,
                         std::uint32_t width, std::uint32_t height, View<std::uint32_t> triangles) {
  const CameraFrame frame = make_camera_frame(camera, width, height);
  const std::vector<std::uint32_t> before(triangles.begin(), triangles.end());
  const auto corner = [&scene](std::uint32_t triangle, int k) { return scene.corner(triangle, k); };
  executor.for_each(height, 1, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < width; ++x) {
      const Neighbourhood near = neighbourhood(before, width, height, x, y);
      if (near.count == 1) continue;
      std::uint32_t& pixel = triangles[row * width + x];
      pixel = nearest_of(near, camera_ray(frame, x, y), corner, scene.flags.data(), pixel);
    }
  });
}

}  // namespace raysheaf
