// Meshes whose vertices move: what is mixed from two times holds the triangles of the time between.
#include "levels/moving_mesh.h"
#include "levels/instances.h"

namespace raysheaf::test {
namespace {

/// A mesh at two or more times, as one instance.
class Deforming {
 public:
  Deforming(std::uint32_t triangles, Random& random) {
    soups_.push_back(make_soup(Shape::kSmall, triangles, random));
    const float far = random.below(2) == 0 ? 1.0f : 1000.0f;
    for (Vec3& p : soups_[0].positions) p = p + Vec3{far, 0, -far};
    const std::size_t times = 2 + random.below(3);
    const float reach = std::exp(random.between(-9, 2));
    while (soups_.size() < times) {
      Soup next = soups_.back();
      const Affine turn = rotation(random.direction(), random.between(0, 2));
      for (Vec3& p : next.positions)
        p = random.below(2) == 0 ? transform_point(turn, p) : p + random.in_box(reach);
      soups_.push_back(std::move(next));
    }
    for (const Soup& soup : soups_) times_.emplace_back(soup.positions);
    instance.positions = times_[0];
    instance.triangle_count = soups_[0].count();
    instance.times = View<const View<const Vec3>>(times_);
    build_mesh_tree(Executor(1), soups_[0].source(), &tree);
  }

  PlacedInstance instance;
  ObjectTree tree;

 private:
  std::vector<Soup> soups_;
  std::vector<View<const Vec3>> times_;
};

/// By how much a point is outside of the box.
float outside(const Box& box, Vec3 p) {
  return max_component(max(max(box.min - p, p - box.max), Vec3()));
}

TEST(MovingMesh, HoldsItsTriangles) {
  Random random(1);
  float worst = 0;
  for (int n = 0; n < 60; ++n) {
    Deforming mesh(n < 50 ? 60 : 3000, random);
    const MovingMesh moving(Executor(2), mesh.instance, &mesh.tree);
    for (int k = 0; k < 12; ++k) {
      const float time = k < 5 ? static_cast<float>(k) / 4 : random.unit();
      const MeshInstant at = moving.at(time);
      const InstanceCorners corners(mesh.instance, time);
      ASSERT_EQ(at.error, moving.error());
      for (std::size_t number = 0; number < mesh.tree.nodes.size(); ++number) {
        BvhNode room;
        const BvhNode& node = at.nodes.at(number, &room);
        for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
          ASSERT_EQ(c < node.children, node.bound[0][c] <= node.bound[3][c]);
          if (c >= node.children || !node.is_leaf(c)) continue;
          for (std::uint32_t i = 0; i < node.count[c]; ++i) {
            const std::size_t q = node.first[c] + i / 4, lane = i % 4;
            TriangleQuad mixed;
            const TriangleQuad& quad = at.quads.at(q, &mixed);
            const auto right = corners(mesh.tree.quads[q].id[lane]);
            const auto corner = [&](const TriangleQuad& of, std::size_t v) {
              return Vec3{of.vertex[v][0][lane], of.vertex[v][1][lane], of.vertex[v][2][lane]};
            };
            for (std::size_t v = 0; v < 3; ++v) {
              const Vec3 exact =
                  at.instant.mixed(corner(at.quads.before[q], v), corner(at.quads.after[q], v));
              ASSERT_EQ(std::memcmp(&exact, &right[v], sizeof(Vec3)), 0);
              const float error = std::max(max_component(abs(corner(quad, v) - exact)),
                                           outside(node.box(c), exact));
              ASSERT_LE(error, at.error);
              worst = std::max(worst, error / at.error);
            }
            ASSERT_GE(quad.reach[lane],
                      reach_of(corner(quad, 0), corner(quad, 1), corner(quad, 2)));
          }
        }
      }
    }
  }
  EXPECT_GT(worst, 0.1f);  // the bound is not much larger than need be
}

TEST(MovingMesh, IsInItsBoxesInTheWorld) {
  Random random(2);
  for (int n = 0; n < 300; ++n) {
    Deforming mesh(random.below(9) == 0 ? 2000 : 30, random);
    const MovingMesh moving(Executor(1), mesh.instance, &mesh.tree);
    std::vector<Affine> motion;
    for (std::uint32_t k = 0; k < 2 + random.below(3); ++k)
      motion.push_back(random_map(kKinds[random.below(9)], 1e3f, random));
    mesh.instance.to_world = motion[0];
    if (random.below(2) == 0) mesh.instance.motion = View<const Affine>(motion);
    LevelInstance instance;
    instance.tree = &mesh.tree;
    instance.moving = &moving;
    instance.placing = make_placing(motion[0], mesh.tree.bounds);
    const float begin = 0.9f * random.unit(), end = std::min(1.0f, begin + random.unit());
    const BoxFit fit = random.below(2) == 0 ? BoxFit::kQuick : BoxFit::kClose;
    const Box box = world_box(instance, fit, mesh.instance.motion, begin, end);
    for (int k = 0; k < 20; ++k) {
      const float time = std::clamp(random.between(begin, end), begin, end);
      const InstanceCorners corners(mesh.instance, time);
      for (std::uint32_t i = 0; i < 60; ++i)
        for (const Vec3 p : corners(random.below(corners.count()))) ASSERT_EQ(outside(box, p), 0);
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
