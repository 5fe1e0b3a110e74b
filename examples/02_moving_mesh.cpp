// A surface whose vertices move in every frame, measured from above: update, commit, query.
#include <raysheaf/query.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr unsigned kSide = 32;  // vertices per side

/// The height of the water at a vertex.
float wave(unsigned x, unsigned y, int frame) {
  const auto time = 0.1f * static_cast<float>(frame);
  return std::sin(0.3f * static_cast<float>(x) + time) * std::cos(0.2f * static_cast<float>(y));
}

void move(std::vector<raysheaf::Vec3>* positions, int frame) {
  for (unsigned y = 0; y < kSide; ++y)
    for (unsigned x = 0; x < kSide; ++x)
      (*positions)[y * kSide + x] = {static_cast<float>(x), static_cast<float>(y),
                                     wave(x, y, frame)};
}

std::vector<raysheaf::Triangle> grid() {
  std::vector<raysheaf::Triangle> triangles;
  for (unsigned y = 0; y + 1 < kSide; ++y) {
    for (unsigned x = 0; x + 1 < kSide; ++x) {
      const unsigned i = y * kSide + x;
      triangles.push_back({i, i + 1, i + kSide});
      triangles.push_back({i + 1, i + kSide + 1, i + kSide});
    }
  }
  return triangles;
}

}  // namespace

int main() {
  using namespace raysheaf;
  constexpr float kHeight = 10;  // height of the instrument

  std::vector<Vec3> positions(kSide * kSide);
  move(&positions, 0);
  Scene scene;
  const MeshId water = scene.add(positions, grid());

  // One ray down to every vertex.
  std::vector<Ray> rays;
  for (const Vec3 p : positions) rays.push_back({{p.x, p.y, kHeight}, 0, {0, 0, -1}});
  std::vector<Hit> hits(rays.size());  // reused in every frame

  int wrong = 0;
  constexpr int kFrames = 30;
  for (int frame = 0; frame < kFrames; ++frame) {
    move(&positions, frame);
    scene.update(water, positions);  // the same triangles; `replace` takes different ones
    scene.commit();
    closest_hit(scene, rays, hits);
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (!(std::fabs(kHeight - hits[i].t - positions[i].z) < 1e-4f)) ++wrong;
  }
  if (wrong == 0)
    std::printf("%d frames, every depth right\n", kFrames);
  else
    std::printf("%d depths are wrong\n", wrong);
}
