// The library on a device gives the CPU's results bit for bit: on an emulated device, and on a CUDA
// device if the machine has one.
#include <cstring>

#include "api/api_support.h"
#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/points.h"
#include "raysheaf/render.h"
#include "support/guarded_memory.h"
#include "tests/support/device_memory.h"

namespace raysheaf::test {
namespace {

struct Filled {
  Scene scene;
  std::vector<MeshId> meshes;
  std::vector<InstanceId> instances;

  explicit Filled(const Context& context) : scene(context) {
    Random random(3);
    for (int m = 0; m < 3; ++m) {
      std::vector<Vec3> corners;
      for (int i = 0; i < 40; ++i) {
        const Vec3 at = random.in_box(4);
        for (int k = 0; k < 3; ++k) corners.push_back(at + random.in_box(1));
      }
      meshes.push_back(scene.add_soup(corners, {.place = m != 2}));
    }
    for (std::uint32_t i = 0; i < 4; ++i)
      instances.push_back(scene.instance(meshes[2], translation(random.in_box(3)), 1u << i));
    scene.commit();
  }
  void move() {
    Random random(4);
    for (const InstanceId instance : instances)
      scene.set_transform(instance, translation(random.in_box(3)));
    scene.commit();
  }
};

std::vector<Ray> rays_for(std::size_t count) {
  Random random(5);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({random.in_box(6), 0, random.in_box(1), kInfinity});
  return rays;
}

void expect_same_answers(const Scene& scene, const Scene& on_cpu, const std::vector<Ray>& rays,
                         const QueryOptions& options) {
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const std::vector<Hit> expected = closest_hit(on_cpu, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_TRUE(same(hits[i], expected[i])) << shown(hits[i]) << ", not " << shown(expected[i]);
  EXPECT_EQ(any_hit(scene, rays, options), any_hit(on_cpu, rays, options));
  EXPECT_EQ(hit_counts(scene, rays, options), hit_counts(on_cpu, rays, options));
  const HitRows rows = all_hits(scene, rays, options), right = all_hits(on_cpu, rays, options);
  ASSERT_EQ(rows.offsets, right.offsets);
  for (std::size_t i = 0; i < rows.hits.size(); ++i) ASSERT_TRUE(same(rows.hits[i], right.hits[i]));
}

/// The choices of hits that a device answers.
void expect_same_choices(const Scene& scene, const Scene& on_cpu, const std::vector<Ray>& rays,
                         QueryMethod method) {
  QueryOptions options;
  options.method = method;
  for (const Sides sides : {Sides::kFront, Sides::kBack}) {
    options.sides = sides;
    expect_same_answers(scene, on_cpu, rays, options);
  }
  std::vector<std::uint32_t> masks(rays.size());
  std::vector<TriangleId> skips(rays.size());
  const std::vector<Hit> hits = closest_hit(on_cpu, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    masks[i] = static_cast<std::uint32_t>(i % 8);
    if (i % 3 != 0) skips[i] = triangle_of(hits[i]);
  }
  options.ray_masks = masks;
  expect_same_answers(scene, on_cpu, rays, options);
  options = {};
  options.method = method;
  options.skip = skips;
  options.mask = 7;
  expect_same_answers(scene, on_cpu, rays, options);
}

void expect_cpu_answers(const Context& context) {
  Filled there(context), here(Context{});
  const std::vector<Ray> rays = rays_for(5000);
  const std::size_t before = there.scene.memory_bytes();
  for (int round = 0; round < 2; ++round) {
    for (const std::uint32_t mask : {0xffffffffu, 5u, 2u}) {
      QueryOptions options;
      options.mask = mask;
      expect_same_answers(there.scene, here.scene, rays, options);
      options.method = QueryMethod::kBrute;
      expect_same_answers(there.scene, here.scene, rays, options);
    }
    for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute})
      expect_same_choices(there.scene, here.scene, rays, method);
    there.move();
    here.move();
  }
  // Too many to be copied at once.
  expect_same_answers(there.scene, here.scene, rays_for(60000), {});
  there.move();
  QueryStatistics statistics;
  QueryOptions options;
  options.statistics = &statistics;
  options.count_tests = true;
  static_cast<void>(closest_hit(there.scene, rays, options));
  EXPECT_EQ(statistics.rays, rays.size());
  EXPECT_GT(statistics.tests(), 0u);
  EXPECT_EQ(statistics.plan.at(0), "object tree: refitted, because the same triangles have moved");
  EXPECT_GT(there.scene.memory_bytes(), before);  // including memory on the device
}

template <class T>
bool are_same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same_points(const Scene& scene, const Scene& on_cpu, const PointParts& points,
                        const PointOptions& options) {
  EXPECT_TRUE(are_same_bytes(closest_point(scene, points, options),
                             closest_point(on_cpu, points, options)));
  for (const std::size_t k : {1, 3, 500})
    EXPECT_TRUE(
        are_same_bytes(nearest(scene, points, k, options), nearest(on_cpu, points, k, options)))
        << k;
  EXPECT_TRUE(are_same_bytes(signed_distance(scene, points, options),
                             signed_distance(on_cpu, points, options)));
  EXPECT_EQ(contains(scene, points, options), contains(on_cpu, points, options));
}

void expect_cpu_points(const Context& context) {
  Filled there(context), here(Context{});
  Random random(6);
  std::vector<Vec3> points(400);
  std::vector<float> radii(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = random.in_box(5);
    radii[i] = i % 5 == 0 ? kInfinity : 3 * random.unit();
  }
  const PointParts parts(points.size(), NumberRows(&points[0].x), NumberRows(radii.data(), 1));
  for (int round = 0; round < 2; ++round) {
    for (const std::uint32_t mask : {0xffffffffu, 5u, 2u}) {
      for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
        PointOptions options;
        options.mask = mask;
        options.inside = rule;
        expect_same_points(there.scene, here.scene, parts, options);
        options.method = QueryMethod::kBrute;
        expect_same_points(there.scene, here.scene, parts, options);
      }
    }
    there.move();
    here.move();
  }
  QueryStatistics statistics;
  PointOptions options;
  options.statistics = &statistics;
  static_cast<void>(signed_distance(there.scene, points, options));
  EXPECT_EQ(statistics.rays, points.size());
  ASSERT_EQ(statistics.plan.size(), 3u);
  EXPECT_EQ(statistics.plan[0], "inside: the surface is open, so six rays a point vote");
  EXPECT_EQ(statistics.plan[1], "object tree: refitted, because the same triangles have moved");
  EXPECT_EQ(statistics.plan[2], "points: as they come, fewer than 4096; one thread a point");
  points[7].y = kNaN;
  expect_error(ErrorCode::kInvalidData, "points[7]", "the point is not finite",
               [&] { static_cast<void>(contains(there.scene, points)); });
}

struct Emulation {
  Executor executor{2};
  test::GuardedMemory memory;
  Context context =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory));
};

TEST(DeviceContext, AnswersAsTheCpu) {
  const Emulation emulation;
  EXPECT_EQ(emulation.context.device(), Device::kCuda);
  expect_cpu_answers(emulation.context);
}

/// Sixty instances of a mesh of 400 triangles.
struct Crowd {
  Scene scene;
  std::vector<InstanceId> instances;

  explicit Crowd(const Context& context) : scene(context) {
    Random random(11);
    std::vector<Vec3> corners;
    for (int i = 0; i < 400; ++i) {
      const Vec3 at = random.in_box(1);
      for (int k = 0; k < 3; ++k) corners.push_back(at + random.in_box(0.3f));
    }
    const MeshId mesh = scene.add_soup(corners, {.place = false});
    for (std::uint32_t i = 0; i < 60; ++i)
      instances.push_back(scene.instance(mesh, any_map(random), 1u << i % 3));
    scene.commit();
  }
  static Affine any_map(Random& random) {
    const Affine turn = rotation(random.direction(), random.between(-3, 3));
    return compose(translation(random.in_box(6)), compose(turn, scaling({1, -0.5f, 2})));
  }
  void move(std::uint64_t step, bool flat) {
    Random random(step);
    std::vector<Affine> maps;
    while (maps.size() < instances.size()) maps.push_back(any_map(random));
    if (flat) maps[7] = scaling({1, 0, 1});
    scene.set_transforms(instances, maps);
    scene.commit();
  }
};

/// Where instances move and few rays follow, rays enter them on the device; where one is flat, all
/// are placed.
void expect_entered(const Context& context) {
  Crowd there(context), here(Context{});
  const std::vector<Ray> rays = rays_for(300);
  for (std::uint64_t step = 0; step < 6; ++step) {
    SCOPED_TRACE(step);
    const bool flat = step == 3;
    if (step != 0) there.move(step, flat);
    if (step != 0) here.move(step, flat);
    QueryStatistics statistics;
    QueryOptions options;
    options.statistics = &statistics;
    options.count_tests = true;
    static_cast<void>(closest_hit(there.scene, rays, options));
    ASSERT_FALSE(statistics.plan.empty());
    EXPECT_EQ(statistics.plan[0].starts_with("instances: entered by the rays"), !flat)
        << statistics.plan[0];
    if (!flat) {
      EXPECT_TRUE(statistics.plan.at(1).starts_with("tree over instances: ")) << statistics.plan[1];
    }
    EXPECT_GT(statistics.triangle_tests, 0u);
    for (const std::uint32_t mask : {0xffffffffu, 5u}) {
      QueryOptions some;
      some.mask = mask;
      expect_same_answers(there.scene, here.scene, rays, some);
    }
    expect_same_choices(there.scene, here.scene, rays, QueryMethod::kDual);
  }
  EXPECT_TRUE(closest_point(there.scene, std::vector<Vec3>{{1, 2, 3}}).at(0).prim_id ==
              closest_point(here.scene, std::vector<Vec3>{{1, 2, 3}}).at(0).prim_id);
}

TEST(DeviceContext, RaysEnterInstancesThatMove) {
  const Emulation emulation;
  expect_entered(emulation.context);
}

TEST(DeviceContext, AnswersPointsAsTheCpu) {
  Emulation emulation;
  expect_cpu_points(emulation.context);
  // Many at once, in parts.
  const Filled there(emulation.context), here(Context{});
  Random random(8);
  std::vector<Vec3> points(2000);
  for (Vec3& p : points) p = random.in_box(5);
  EXPECT_TRUE(
      are_same_bytes(nearest(there.scene, points, 1100), nearest(here.scene, points, 1100)));
}

TEST(DeviceContext, AnswersAsTheCpuOnCuda) {
  try {
    expect_cpu_answers(Context({.device = Device::kCuda}));
    expect_cpu_points(Context({.device = Device::kCuda}));
    expect_entered(Context({.device = Device::kCuda}));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kUnsupported) throw;
    EXPECT_EQ(error.place(), "CUDA device");
    GTEST_SKIP() << error.what();
  }
}

TEST(DeviceContext, ScenesWithoutTrianglesAndBatchesWithoutRays) {
  const Emulation emulation;
  Scene scene(emulation.context);
  scene.commit();
  const std::vector<Ray> rays = rays_for(3);
  EXPECT_EQ(any_hit(scene, rays), (std::vector<std::uint8_t>{0, 0, 0}));
  EXPECT_EQ(closest_hit(scene, rays)[0].prim_id, kInvalidId);
  EXPECT_EQ(hit_counts(scene, rays), (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(all_hits(scene, rays).offsets.size(), 4u);
  const Filled filled(emulation.context);
  EXPECT_TRUE(closest_hit(filled.scene, std::vector<Ray>()).empty());
}

TEST(DeviceContext, RendersAsTheCpu) {
  const Emulation emulation;
  const SceneDescription scene = builtin_scene("cornell");
  RenderOptions options;
  options.width = options.height = 48;
  options.primary = Primary::kTrace;
  const RenderResult there = render(emulation.context, scene, options);
  const RenderResult here = render(scene, options);
  for (std::size_t i = 0; i < here.beauty.size(); ++i)
    ASSERT_TRUE(here.beauty[i] == there.beauty[i]) << i;
  EXPECT_EQ(there.statistics.device, "cuda");
  EXPECT_EQ(here.statistics.device, "cpu");
  options.method = Method::kGl10;
  options.count_pixel_tests = true;
  expect_error(ErrorCode::kUnsupported, "tests", "gl10 do not count tests per pixel",
               [&] { static_cast<void>(render(emulation.context, scene, options)); });
  options.count_pixel_tests = false;
  options.bundle_samples = 9;
  expect_error(ErrorCode::kUnsupported, "bundle_samples", "not measured",
               [&] { static_cast<void>(render(emulation.context, scene, options)); });
  options.bundle_samples = 0;
  options.key = RayKey::kPixelMorton;
  expect_error(ErrorCode::kUnsupported, "key", "by the key crsh",
               [&] { static_cast<void>(render(emulation.context, scene, options)); });
  options.key.reset();
  options.method = Method::kCrsh;
  options.bound = BundleBound::kShaft;
  expect_error(ErrorCode::kUnsupported, "bound", "sphere-cone",
               [&] { static_cast<void>(render(emulation.context, scene, options)); });
}

TEST(DeviceContext, SpansMayLieInTheDevicesMemory) {
  Emulation emulation;
  const Filled there(emulation.context), here(Context{});
  const std::vector<Ray> rays = rays_for(300);
  EmulatedDevice device(emulation.executor, emulation.memory);
  const DeviceBuffer<Ray> in = test::to_device(device, rays);
  DeviceBuffer<Hit> out(emulation.memory);
  out.resize_uninitialized("test", rays.size());
  const std::span<const Ray> asked(in.data(), rays.size());
  const std::span<Hit> answered(out.data(), rays.size());
  closest_hit(there.scene, asked, answered);
  const std::vector<Hit> found = test::to_host(device, out);
  const std::vector<Hit> expected = closest_hit(here.scene, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(found[i], expected[i]));
  QueryOptions fronts;
  fronts.sides = Sides::kFront;
  closest_hit(there.scene, asked, answered, fronts);
  const std::vector<Hit> of_fronts = test::to_host(device, out);
  const std::vector<Hit> right = closest_hit(here.scene, rays, fronts);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(of_fronts[i], right[i]));
  QueryOptions worlds;
  worlds.rays_per_world = rays.size();
  expect_error(ErrorCode::kUnsupported, "hits", "worlds and times are answered by the CPU",
               [&] { closest_hit(there.scene, asked, answered, worlds); });
  QueryOptions nothing;
  nothing.mask = 0;
  closest_hit(there.scene, asked, answered, nothing);
  EXPECT_TRUE(same(test::to_host(device, out)[7], Hit{}));
  device.copy("test", &in.data()[5].t_max, &kNaN, sizeof kNaN);
  expect_error(ErrorCode::kInvalidData, "rays[5].t_max", "not a number",
               [&] { closest_hit(there.scene, asked, answered); });
}

TEST(DeviceContext, PointsMayLieInTheDevicesMemory) {
  Emulation emulation;
  const Filled there(emulation.context), here(Context{});
  Random random(9);
  std::vector<Vec3> points(2000);
  for (Vec3& p : points) p = random.in_box(5);
  const std::vector<double> radii(points.size(), 1.5), one{1.5};
  EmulatedDevice device(emulation.executor, emulation.memory);
  const DeviceBuffer<Vec3> points_there = test::to_device(device, points);
  const DeviceBuffer<double> radii_there = test::to_device(device, radii);
  const NumberRows rows(&points_there.data()->x), own_rows(&points.data()->x);
  const PointParts asked(points.size(), own_rows, NumberRows(one.data(), 0));
  const std::vector<ClosestPoint> expected = closest_point(here.scene, asked);
  // One radius for all, of the host; one each, of the device; answers of the host and the device.
  for (const NumberRows& radius : {NumberRows(one.data(), 0), NumberRows(radii_there.data(), 1)}) {
    const PointParts parts(points.size(), rows, radius);
    EXPECT_TRUE(are_same_bytes(closest_point(there.scene, parts), expected));
    EXPECT_TRUE(
        are_same_bytes(signed_distance(there.scene, parts), signed_distance(here.scene, asked)));
  }
  const PointParts parts(points.size(), rows);
  constexpr std::size_t kMany = 1100;  // answered in parts
  DeviceBuffer<ClosestPoint> found(emulation.memory);
  found.resize_uninitialized("test", points.size() * kMany);
  nearest(there.scene, parts, kMany, std::span(found.data(), found.size()));
  EXPECT_TRUE(are_same_bytes(test::to_host(device, found), nearest(here.scene, points, kMany)));
  EXPECT_EQ(contains(there.scene, parts), contains(here.scene, points));
  DeviceBuffer<std::uint8_t> inside(emulation.memory);
  inside.resize_uninitialized("test", points.size());
  contains(there.scene, points, std::span(inside.data(), inside.size()));
  EXPECT_EQ(test::to_host(device, inside), contains(here.scene, points));

  std::vector<ClosestPoint> room(points.size());
  expect_error(ErrorCode::kUnsupported, "radii", "in the host's memory, but the points", [&] {
    closest_point(there.scene, PointParts(points.size(), rows, NumberRows(radii.data(), 1)), room);
  });
  expect_error(ErrorCode::kUnsupported, "radii", "in the device's memory, but the points", [&] {
    closest_point(there.scene,
                  PointParts(points.size(), own_rows, NumberRows(radii_there.data(), 1)), room);
  });
  device.copy("test", &points_there.data()[1900].y, &kNaN, sizeof kNaN);
  expect_error(ErrorCode::kInvalidData, "points[1900]", "not finite",
               [&] { nearest(there.scene, parts, kMany, std::span(found.data(), found.size())); });
  PointOptions unchecked;
  unchecked.check = false;
  closest_point(there.scene, parts, room, unchecked);
}

/// Where nothing is found, the answers are written after the work that is pending on the streams,
/// and points are read after it.
TEST(DeviceContext, PointsFollowTheCallersStreams) {
  Emulation emulation;
  const Filled there(emulation.context), here(Context{});
  Random random(10);
  std::vector<Vec3> points(50);
  for (Vec3& p : points) p = random.in_box(5);
  DeviceBuffer<Vec3> in(emulation.memory);
  DeviceBuffer<double> out(emulation.memory);
  in.resize_uninitialized("test", points.size());
  out.resize_uninitialized("test", points.size());
  for (const std::uint32_t mask : {0xffffffffu, 0u}) {
    EmulatedStream first, second;
    first.ask([&] { std::copy(points.begin(), points.end(), in.data()); });
    second.ask([&] { std::fill_n(out.data(), points.size(), 77.0); });
    PointOptions options;
    options.mask = mask;
    options.stream = &first;
    options.results_stream = &second;
    signed_distance(there.scene, PointParts(points.size(), NumberRows(&in.data()->x)),
                    std::span(out.data(), out.size()), options);
    const test::Reach reach(emulation.memory);
    second.finish();
    PointOptions same_mask;
    same_mask.mask = mask;
    EXPECT_EQ(std::vector<double>(out.data(), out.data() + points.size()),
              signed_distance(here.scene, points, same_mask));
    std::memset(static_cast<void*>(in.data()), 0xff, points.size() * sizeof(Vec3));
  }
}

/// Rays and results reside in the device's memory. On the caller's stream, work that fills the
/// results with garbage is still pending: the answers must come after it.
template <class T, class Ask>
void expect_answers_after_the_stream(const T& expected, const Ask& ask) {
  Emulation emulation;
  const std::vector<Ray> rays = rays_for(50);
  DeviceBuffer<Ray> in(emulation.memory);
  DeviceBuffer<T> out(emulation.memory);
  in.resize_uninitialized("test", rays.size());
  out.resize_uninitialized("test", rays.size());
  EmulatedStream stream;
  stream.ask([&] { std::copy(rays.begin(), rays.end(), in.data()); });
  stream.ask([&] { std::memset(static_cast<void*>(out.data()), 0x5a, rays.size() * sizeof(T)); });
  QueryOptions options;
  options.mask = 0;
  options.stream = &stream;
  const Filled there(emulation.context);
  ask(there.scene, std::span<const Ray>(in.data(), rays.size()),
      std::span<T>(out.data(), rays.size()), options);
  const test::Reach reach(emulation.memory);
  stream.finish();
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_EQ(std::memcmp(out.data() + i, &expected, sizeof(T)), 0) << i;
}

TEST(DeviceContext, WhatMeetsNothingIsWrittenAfterTheCallersStream) {
  expect_answers_after_the_stream(Hit{}, [](const auto&... all) { closest_hit(all...); });
  expect_answers_after_the_stream(std::uint8_t{0}, [](const auto&... all) { any_hit(all...); });
  expect_answers_after_the_stream(std::uint32_t{0}, [](const auto&... all) { hit_counts(all...); });
}

TEST(DeviceContext, RaysAndResultsMayBeOnTwoStreams) {
  Emulation emulation;
  const Filled there(emulation.context), here(Context{});
  const std::vector<Ray> rays = rays_for(50);
  DeviceBuffer<Ray> in(emulation.memory);
  DeviceBuffer<std::uint32_t> out(emulation.memory);
  in.resize_uninitialized("test", rays.size());
  out.resize_uninitialized("test", rays.size());
  EmulatedStream first, second;
  first.ask([&] { std::copy(rays.begin(), rays.end(), in.data()); });
  second.ask([&] { std::fill_n(out.data(), rays.size(), 77u); });
  QueryOptions options;
  options.stream = &first;
  options.results_stream = &second;
  hit_counts(there.scene, std::span<const Ray>(in.data(), rays.size()),
             std::span<std::uint32_t>(out.data(), rays.size()), options);
  const test::Reach reach(emulation.memory);
  second.finish();
  EXPECT_EQ(std::vector<std::uint32_t>(out.data(), out.data() + rays.size()),
            hit_counts(here.scene, rays));
}

}  // namespace
}  // namespace raysheaf::test
