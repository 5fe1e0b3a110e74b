#include "lab/as_published.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <numeric>

#include "exec/stopwatch.h"
#include "lab/as_published_body.h"
#include "paper/base/flat_arrays.h"
#include "paper/order/order.h"

namespace raysheaf {
namespace {

using namespace as_published;

/// Trimmed raster order; OpenGL counts rows from below.
std::vector<std::uint32_t> raster_order(const RayBatch& batch, std::uint32_t width,
                                        const Quirks& quirks) {
  std::vector<std::uint32_t> order(batch.rays.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto light = [&](std::uint32_t i) { return batch.lights.empty() ? 0 : batch.lights[i]; };
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    if (light(a) != light(b)) return light(a) < light(b);
    return batch.pixels[a] / width > batch.pixels[b] / width;
  };
  if (quirks.rows_from_below) std::stable_sort(order.begin(), order.end(), before);
  const std::size_t dropped = std::min<std::size_t>(quirks.dropped_rays, order.size());
  order.erase(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(dropped));
  return order;
}

std::uint32_t key_of(const RayBatch& batch, std::uint32_t i, const Quirks& quirks) {
  if (!quirks.hash_as_coded) return batch.keys[i];
  const Ray& ray = batch.rays[i];
  const Vec3 d = normalized(ray.direction);
  return batch.kind == RayKind::kShadow ? shadow_hash(batch.lights[i], d, quirks.azimuth_as_coded)
                                        : reflection_hash(ray.origin, d, quirks.azimuth_as_coded);
}

std::vector<std::uint32_t> sorted(const Executor& executor, const RayBatch& batch,
                                  const std::vector<std::uint32_t>& raster, const Quirks& quirks,
                                  BatchStatistics* statistics) {
  std::vector<std::uint32_t> keys(raster.size()), places(raster.size()), order(raster.size());
  executor.for_each(keys.size(), kWorkGrain,
                    [&](std::size_t i) { keys[i] = key_of(batch, raster[i], quirks); });
  statistics->chunks =
      order_by_key(executor, keys, places, quirks.hash_as_coded ? 32 : batch.key_bits);
  executor.for_each(order.size(), kWorkGrain, [&](std::size_t i) { order[i] = raster[places[i]]; });
  return order;
}

Node leaf_of(const RayBatch& batch, View<const std::uint32_t> order) {
  const Ray& first = batch.rays[order[0]];
  Node node{first.origin, 0, normalized(first.direction), 0};
  for (std::size_t i = 1; i < order.size; ++i) {
    const Ray& ray = batch.rays[order[i]];
    merge_sphere(node, ray.origin, 0);
    extend_cone(node, normalized(ray.direction));
  }
  return node;
}

Node parent_of(View<const Node> children) {
  Node node = children[0];
  for (std::size_t i = 1; i < children.size; ++i) {
    merge_sphere(node, children[i].center, children[i].radius);
    merge_cone(node, children[i]);
  }
  return node;
}

using Levels = std::vector<std::vector<Node>>;

template <class Item, class Make>
std::vector<Node> level_over(const Executor& executor, View<const Item> below, std::size_t b,
                             const Make& make) {
  std::vector<Node> nodes((below.size + b - 1) / b);
  executor.for_each(nodes.size(), std::max<std::size_t>(1, kWorkGrain / b), [&](std::size_t i) {
    nodes[i] = make(below.slice(i * b, std::min(b, below.size - i * b)));
  });
  return nodes;
}

Levels build(const Executor& executor, const RayBatch& batch, View<const std::uint32_t> order,
             PublishedShape shape) {
  Levels levels;
  levels.push_back(
      level_over(executor, order, shape.branching,
                 [&](View<const std::uint32_t> rays) { return leaf_of(batch, rays); }));
  while (levels.size() < shape.levels)
    levels.push_back(level_over(executor, View<const Node>(levels.back()), shape.branching,
                                [](View<const Node> below) { return parent_of(below); }));
  return levels;
}

/// Spheres in four arrays.
struct Balls {
  std::vector<float> x, y, z, radius;

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t count) {
    for (auto* values : {&x, &y, &z, &radius}) values->resize(count);
  }
  void set(std::size_t i, const Sphere& s) {
    x[i] = s.center.x, y[i] = s.center.y, z[i] = s.center.z, radius[i] = s.radius;
  }
};

Balls triangle_balls(const Executor& executor, const FlatScene& scene, bool undersized) {
  Balls balls;
  balls.resize(scene.triangle_count);
  const FlatArrays arrays(executor, scene);
  const TriangleView triangles = arrays.view();
  executor.for_each(balls.size(), kWorkGrain, [&](std::size_t i) {
    const auto field = [&](int k) { return triangles.sphere[k][i]; };
    balls.set(i, undersized ? undersized_sphere(triangles.corner(i, 0), triangles.corner(i, 1),
                                                triangles.corner(i, 2))
                            : Sphere{{field(0), field(1), field(2)}, field(3)});
  });
  return balls;
}

Balls mesh_balls(const Executor& executor, const FlatScene& scene, bool wrong) {
  Balls balls;
  balls.resize(scene.meshes.size());
  const SceneDescription& description = *scene.description;
  const std::vector<Sphere> object =
      wrong ? mesh_bounds(executor, description) : std::vector<Sphere>(description.meshes.size());
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const FlatMesh& mesh = scene.meshes[i];
    balls.set(i, wrong
                     ? unrotated(object[mesh.geom_id], description.instances[mesh.inst_id].to_world)
                     : mesh.bound);
  }
  return balls;
}

constexpr std::size_t kChunk = 2048;  // of marks, which stay in the first-level cache

template <ConeTest kTest>
void mark(const ReadyNode& node, const Balls& balls, std::size_t first, std::size_t count,
          std::uint8_t* marks) {
  const float* x = balls.x.data() + first;
  const float* y = balls.y.data() + first;
  const float* z = balls.z.data() + first;
  const float* radius = balls.radius.data() + first;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 v{x[i] - node.center.x, y[i] - node.center.y, z[i] - node.center.z};
    const float along = dot(v, node.axis);
    const Vec3 aside = v - node.axis * along;
    marks[i] = static_cast<std::uint8_t>(
        meets<kTest>(node, along, dot(aside, aside), node.radius + radius[i]));
  }
}

void mark_chunk(ConeTest test, const ReadyNode& node, const Balls& balls, std::size_t first,
                std::size_t count, std::uint8_t* marks) {
  if (node.all) {
    std::memset(marks, 1, count);
  } else if (test == ConeTest::kExact) {
    mark<ConeTest::kExact>(node, balls, first, count, marks);
  } else if (test == ConeTest::kSigned) {
    mark<ConeTest::kSigned>(node, balls, first, count, marks);
  } else {
    mark<ConeTest::kUnsigned>(node, balls, first, count, marks);
  }
}

/// Calls `take(i)` for the spheres in [first, first + count) that the node intersects.
template <class Take>
void for_each_met(ConeTest test, const Node& node, const Balls& balls, std::size_t first,
                  std::size_t count, const Take& take) {
  const ReadyNode ready(node);
  alignas(8) std::uint8_t marks[kChunk];
  for (std::size_t done = 0; done < count; done += kChunk) {
    const std::size_t size = std::min(kChunk, count - done);
    mark_chunk(test, ready, balls, first + done, size, marks);
    std::memset(marks + size, 0, std::min<std::size_t>(8, kChunk - size));
    for (std::size_t i = 0; i < size; i += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, marks + i, 8);
      if (eight == 0) continue;
      for (std::size_t k = i; k < i + 8; ++k)
        if (marks[k] != 0) take(first + done + k);
    }
  }
}

/// Spheres that a node intersects, up to the capacity.
struct MetList {
  Balls balls;
  std::size_t count = 0;
  void add(const Balls& from, std::size_t i) {
    balls.x[count] = from.x[i], balls.y[count] = from.y[i], balls.z[count] = from.z[i];
    balls.radius[count] = from.radius[i];
    ++count;
  }
};

struct Counts {
  std::uint64_t mesh_sphere_tests = 0, final_tests = 0;
  std::vector<std::uint64_t> tests, hits;  ///< [0] is level 1
};

class Counter {
 public:
  Counter(const FlatScene& scene, const Levels& levels, const Balls& triangles, const Balls& meshes,
          std::size_t ray_count, PublishedShape shape, const Quirks& quirks)
      : scene_(scene),
        levels_(levels),
        triangles_(triangles),
        meshes_(meshes),
        ray_count_(ray_count),
        shape_(shape),
        quirks_(quirks),
        lists_(levels.size()) {
    counts_.tests.resize(levels.size());
    counts_.hits.resize(levels.size());
    for (MetList& list : lists_) list.balls.resize(triangles.size());
  }

  /// `culls`: the top node is tested with mesh spheres first.
  void run(std::size_t top_node, bool culls) {
    const std::size_t top = levels_.size() - 1;
    const Node& node = levels_[top][top_node];
    MetList& met = lists_[top];
    met.count = 0;
    if (!culls) {
      test(top, node, triangles_, 0, triangles_.size());
    } else {
      counts_.mesh_sphere_tests += meshes_.size();
      for_each_met(quirks_.cone_test, node, meshes_, 0, meshes_.size(), [&](std::size_t i) {
        test(top, node, triangles_, scene_.meshes[i].first_triangle,
             scene_.meshes[i].triangle_count);
      });
    }
    descend(top, top_node);
  }

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  void test(std::size_t level, const Node& node, const Balls& from, std::size_t first,
            std::size_t count) {
    MetList& met = lists_[level];
    const std::size_t before = met.count;
    for_each_met(quirks_.cone_test, node, from, first, count,
                 [&](std::size_t i) { met.add(from, i); });
    counts_.tests[level] += count;
    counts_.hits[level] += met.count - before;
  }

  /// Tests what the node of `level` intersects with each of its children, or rays. Missing ones
  /// count.
  void descend(std::size_t level, std::size_t node) {
    const MetList& met = lists_[level];
    const std::size_t b = shape_.branching, first = node * b;
    const std::size_t below = level == 0 ? ray_count_ : levels_[level - 1].size();
    const std::size_t real = std::min(b, below - first);
    const std::size_t missing = quirks_.padded_counting ? b - real : 0;
    if (level == 0) {
      counts_.final_tests += met.count * (real + missing);
      return;
    }
    counts_.tests[level - 1] += met.count * missing;
    for (std::size_t child = first; child < first + real; ++child) {
      lists_[level - 1].count = 0;
      test(level - 1, levels_[level - 1][child], met.balls, 0, met.count);
      descend(level - 1, child);
    }
  }

  const FlatScene& scene_;
  const Levels& levels_;
  const Balls& triangles_;
  const Balls& meshes_;
  std::size_t ray_count_;
  PublishedShape shape_;
  const Quirks& quirks_;
  std::vector<MetList> lists_;
  Counts counts_;
};

}  // namespace

BatchStatistics count_as_published(const Executor& executor, const FlatScene& scene,
                                   const RayBatch& batch, Method method, const Quirks& quirks,
                                   std::uint32_t width, PublishedShape shape) {
  BatchStatistics s;
  s.kind = batch.kind;
  s.bounce = batch.bounce;
  s.triangles = scene.triangle_count;
  s.levels.resize(shape.levels);
  for (std::uint32_t l = 0; l < shape.levels; ++l) s.levels[l].level = shape.levels - l;
  const bool culls = method == Method::kCrsh;
  Stopwatch watch;
  std::vector<std::uint32_t> order = raster_order(batch, width, quirks);
  s.rays = order.size();
  if (order.empty()) return s;
  if (culls) order = sorted(executor, batch, order, quirks, &s);
  s.times_ms.order = watch.lap_ms();
  const Levels levels = build(executor, batch, order, shape);
  s.times_ms.hierarchy = watch.lap_ms();
  const Balls triangles = triangle_balls(executor, scene, quirks.undersized_triangle_spheres);
  const Balls meshes = mesh_balls(executor, scene, quirks.unrotated_mesh_spheres);

  std::mutex mutex;
  executor.for_each_block(levels.back().size(), 16, [&](std::size_t begin, std::size_t end) {
    Counter counter(scene, levels, triangles, meshes, order.size(), shape, quirks);
    for (std::size_t i = begin; i < end; ++i) counter.run(i, culls);
    const Counts& counts = counter.counts();
    const std::lock_guard lock(mutex);
    s.mesh_sphere_tests += counts.mesh_sphere_tests;
    s.final_tests += counts.final_tests;
    for (std::uint32_t l = 0; l < shape.levels; ++l) {
      s.levels[shape.levels - 1 - l].tests += counts.tests[l];
      s.levels[shape.levels - 1 - l].hits += counts.hits[l];
    }
  });
  s.times_ms.traverse = watch.lap_ms();
  return s;
}

}  // namespace raysheaf
