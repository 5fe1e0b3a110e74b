#include "paper/base/flat_arrays.h"

#include "base/bits.h"
#include "exec/executor.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

void store(const Vec3 (&corners)[3], const Sphere& sphere, std::size_t i,
           AlignedVector<float> (&vertex)[3][3], AlignedVector<float> (&spheres)[4]) {
  for (int k = 0; k < 3; ++k) {
    vertex[k][0][i] = corners[k].x;
    vertex[k][1][i] = corners[k].y;
    vertex[k][2][i] = corners[k].z;
  }
  spheres[0][i] = sphere.center.x;
  spheres[1][i] = sphere.center.y;
  spheres[2][i] = sphere.center.z;
  spheres[3][i] = sphere.radius;
}

}  // namespace

FlatArrays::FlatArrays(const Executor& executor, const FlatScene& scene)
    : count_(scene.triangle_count), bounds_(scene.bounds) {
  const std::size_t padded = std::size_t{div_ceil(count_, kTriangleBlock)} * kTriangleBlock;
  for (auto& corner : vertex_) {
    for (auto& axis : corner) axis.resize(padded);
  }
  for (auto& field : sphere_) field.resize(padded);
  flags_.resize(padded);
  read(executor, scene.source(), 0, count_);
  pad();
}

void FlatArrays::move(const Executor& executor, const FlatScene& scene,
                      View<const std::uint32_t> meshes) {
  for (std::size_t i = 0; i < meshes.size;) {
    const FlatMesh& first = scene.meshes[meshes[i]];
    std::uint32_t count = first.triangle_count;
    std::size_t next = i + 1;  // neighbours are read together
    for (; next < meshes.size && meshes[next] == meshes[next - 1] + 1; ++next)
      count += scene.meshes[meshes[next]].triangle_count;
    read(executor, scene.source(), first.first_triangle, count);
    i = next;
  }
  bounds_ = scene.bounds;
  pad();
}

void FlatArrays::read(const Executor& executor, const TriangleSource& source, std::uint32_t first,
                      std::uint32_t count) {
  executor.for_each_block(count, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    const auto read_part = [&](const TriangleRun& run, std::uint32_t from, std::uint32_t to) {
      for (std::uint32_t t = from; t < to; ++t) {
        const std::array<Vec3, 3> found = run.corners(t);
        Vec3 corners[3] = {found[0], found[1], found[2]};
        collapse_flat(corners);
        const std::size_t i = std::size_t{run.first} + t;
        store(corners, conservative_triangle_sphere(corners[0], corners[1], corners[2]), i, vertex_,
              sphere_);
        flags_[i] = source.flags[i];
      }
    };
    source.for_each_part(first + static_cast<std::uint32_t>(begin),
                         first + static_cast<std::uint32_t>(end), read_part);
  });
}

void FlatArrays::pad() {
  if (count_ == 0) return;
  const Vec3 point = view().corner(count_ - 1, 0);
  for (std::size_t i = count_; i < flags_.size(); ++i) {
    store({point, point, point}, {point, kPaddingRadius}, i, vertex_, sphere_);
    flags_[i] = flags_[count_ - 1];
  }
}

TriangleView FlatArrays::view() const {
  TriangleView view;
  view.count = count_;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) view.vertex[k][axis] = vertex_[k][axis].data();
  }
  for (int field = 0; field < 4; ++field) view.sphere[field] = sphere_[field].data();
  view.flags = flags_.data();
  view.bounds = bounds_;
  return view;
}

}  // namespace raysheaf
