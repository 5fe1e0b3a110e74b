// `_core.Scene`: a scene with its lock, and the four queries.
#include "raysheaf/scene.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <variant>

#include "core.h"
#include "gil.h"
#include "interrupt.h"
#include "places.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "shared_scene.h"

namespace raysheaf::python {
namespace {

using WritableHits = nb::ndarray<float, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using WritableFlags = nb::ndarray<std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using WritableCounts = nb::ndarray<std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
static_assert(sizeof(Hit) == 6 * sizeof(float) && sizeof(TriangleId) == 2 * sizeof(std::uint32_t));

std::span<const Vec3> vertices_of(const Floats3& array) {
  return {reinterpret_cast<const Vec3*>(array.data()), array.shape(0)};
}

std::span<const Triangle> triangles_of(const Indices3& array) {
  return {reinterpret_cast<const Triangle*>(array.data()), array.shape(0)};
}

using AskedRays = std::variant<Rays, Parts, Place>;

RayParts parts_of(const AskedRays& rays) {
  if (const Parts* parts = std::get_if<Parts>(&rays)) return parts->rays();
  return items_of<const Ray>(rays);
}

Affine affine_of(const Matrix34& array) {
  Affine affine;
  std::memcpy(&affine.m, array.data(), sizeof(affine.m));
  return affine;
}

MeshId add(SharedScene& shared, const Floats3& vertices, const std::optional<Indices3>& triangles,
           bool place, const Matrix34& transform, std::uint32_t mask, WorldId world) {
  const MeshOptions options{
      .place = place, .transform = affine_of(transform), .mask = mask, .world = world};
  return shared.change([&](Scene& scene) {
    return triangles ? scene.add(vertices_of(vertices), triangles_of(*triangles), options)
                     : scene.add_soup(vertices_of(vertices), options);
  });
}

void replace(SharedScene& shared, MeshId mesh, const Floats3& vertices,
             const std::optional<Indices3>& triangles) {
  shared.change([&](Scene& scene) {
    if (triangles)
      scene.replace(mesh, vertices_of(vertices), triangles_of(*triangles));
    else
      scene.replace_soup(mesh, vertices_of(vertices));
  });
}

/// `vertices`: those of each time, one after the other.
void update(SharedScene& shared, MeshId mesh, const Floats3& vertices, std::size_t times) {
  shared.change([&](Scene& scene) { scene.update(mesh, vertices_of(vertices), times); });
}

InstanceId instance(SharedScene& shared, MeshId mesh, const Matrix34& transform, std::uint32_t mask,
                    WorldId world) {
  const Affine affine = affine_of(transform);
  return shared.change([&](Scene& scene) { return scene.instance(mesh, affine, mask, world); });
}

std::span<const Affine> affines_of(const Matrices34& transforms) {
  static_assert(sizeof(Affine) == 12 * sizeof(float));
  return {reinterpret_cast<const Affine*>(transforms.data()), transforms.shape(0)};
}

/// Returns the first id.
InstanceId make_instances(SharedScene& shared, MeshId mesh, const Matrices34& transforms,
                          const std::optional<Ids>& worlds, std::uint32_t mask) {
  std::span<const WorldId> of_each;
  if (worlds) of_each = {worlds->data(), worlds->shape(0)};
  return shared.change(
      [&](Scene& scene) { return scene.instances(mesh, affines_of(transforms), of_each, mask); });
}

void set_transforms(SharedScene& shared, const Ids& instances, const Matrices34& transforms,
                    std::size_t each) {
  const std::span<const InstanceId> ids(instances.data(), instances.shape(0));
  shared.change([&](Scene& scene) { scene.set_transforms(ids, affines_of(transforms), each); });
}

nb::ndarray<nb::numpy, float, nb::shape<-1, 3, 4>> transforms(SharedScene& shared,
                                                              InstanceId instance) {
  using Maps = std::vector<Affine>;
  auto* maps = new Maps(shared.look([&](const Scene& s) { return s.transforms(instance); }));
  const nb::capsule owner(maps, [](void* at) noexcept { delete static_cast<Maps*>(at); });
  return {maps->data(), {maps->size(), 3, 4}, owner};
}

nb::tuple bounds(SharedScene& shared) {
  const Box box = [&] {
    const WithoutGil released;
    return shared.look_committed([](const Scene& scene) { return scene.bounds(); },
                                 [&] { released.check_signals(); });
  }();
  return nb::make_tuple(nb::make_tuple(box.min.x, box.min.y, box.min.z),
                        nb::make_tuple(box.max.x, box.max.y, box.max.z));
}

/// A query of no more rays, and of no more tests or kept hits at the worst, is over before anyone
/// could be tired of it.
constexpr std::uint64_t kFewRays = 100'000, kFewTests = 100'000'000, kFewHits = 10'000'000;

/// If arrays are on a device, the query stays on the calling thread: on another thread, a stream's
/// handle may mean another stream (cudaStreamPerThread).
/// Returns the version of the scene that was asked.
template <class Body>
std::uint64_t ask(SharedScene& shared, const AskedRays& rays, const Streams& streams,
                  const QueryRequest& request, std::uint64_t few, const Body& body) {
  QueryStatistics statistics;
  std::uint64_t version = 0;
  const bool counted = !request.statistics.is_none();
  QueryOptions options{.method = request.brute ? QueryMethod::kBrute : QueryMethod::kDual,
                       .mask = request.mask,
                       .check = request.check,
                       .count_tests = counted,
                       .stream = streams.asked,
                       .results_stream = streams.results,
                       .statistics = counted ? &statistics : nullptr};
  options.sides = request.sides;
  if (request.masks) options.ray_masks = {request.masks->data(), request.masks->shape(0)};
  options.ray_worlds = request.worlds_of_items();
  options.rays_per_world = request.per_world;
  if (request.times) options.ray_times = {request.times->data(), request.times->shape(0)};
  if (request.skip)
    options.skip = {reinterpret_cast<const TriangleId*>(request.skip->data()),
                    request.skip->shape(0)};
  const auto answer = [&](const auto& poll) {
    shared.look_committed(
        [&](const Scene& scene) {
          version = shared.version();
          body(scene, options);
        },
        poll);
  };
  const std::uint64_t count = parts_of(rays).count;
  const std::uint64_t triangles = shared.look([](const Scene& s) { return s.triangle_count(); });
  const bool is_long = count > kFewRays || count * triangles > few;
  if (is_long && !streams.any_place) {
    interruptible([&](const std::atomic<bool>& stop) {
      options.stop = &stop;
      answer([&stop] { give_up_if(stop); });
    });
  } else {
    const WithoutGil released;
    answer([&] { released.check_signals(); });
  }
  if (counted) write_statistics(statistics, nb::borrow<nb::dict>(request.statistics));
  return version;
}

template <class Item, class Array, class Query>
std::uint64_t query_into(SharedScene& shared, const AskedRays& rays, const Anywhere<Array>& out,
                         const QueryRequest& request, std::uint64_t few, const Query& query) {
  const auto answers = items_of<Item>(out);
  return ask(shared, rays, streams_of(std::get_if<Place>(&rays), std::get_if<Place>(&out)), request,
             few, [&](const Scene& scene, const QueryOptions& options) {
               query(scene, parts_of(rays), answers, options);
             });
}

/// Uninitialised memory for hits, from the library's allocator: the first access to a page is
/// expensive, and the library reuses freed pages.
nb::ndarray<nb::numpy, float, nb::shape<-1, 6>> empty_hits(std::size_t count) {
  auto memory = std::make_unique<LargeVector<Hit>>(count);
  LargeVector<Hit>* const hits = memory.get();
  const nb::capsule owner(memory.release(),
                          [](void* at) noexcept { delete static_cast<LargeVector<Hit>*>(at); });
  return {hits->data(), {count, 6}, owner};
}

std::uint64_t query_closest_hit(SharedScene& shared, const AskedRays& rays,
                                const Anywhere<WritableHits>& out, const QueryRequest& request) {
  return query_into<Hit>(shared, rays, out, request, kFewTests,
                         [](const auto&... all) { closest_hit(all...); });
}

void query_any_hit(SharedScene& shared, const AskedRays& rays, const Anywhere<WritableFlags>& out,
                   const QueryRequest& request) {
  query_into<std::uint8_t>(shared, rays, out, request, kFewTests,
                           [](const auto&... all) { any_hit(all...); });
}

void query_hit_counts(SharedScene& shared, const AskedRays& rays,
                      const Anywhere<WritableCounts>& out, const QueryRequest& request) {
  query_into<std::uint32_t>(shared, rays, out, request, kFewHits,
                            [](const auto&... all) { hit_counts(all...); });
}

/// Offsets and hits as arrays over the library's own memory; `most` hits of each ray, or all.
nb::tuple query_all_hits(SharedScene& shared, const AskedRays& rays, const QueryRequest& request,
                         const std::optional<std::uint32_t>& most) {
  auto found = std::make_unique<HitRows>();
  const Place* const place = std::get_if<Place>(&rays);
  const std::uint64_t version = ask(shared, rays, streams_of(place, place), request, kFewHits,
                                    [&](const Scene& scene, const QueryOptions& options) {
                                      *found =
                                          most ? first_hits(scene, parts_of(rays), *most, options)
                                               : all_hits(scene, parts_of(rays), options);
                                    });
  HitRows* const all = found.get();
  const nb::capsule owner(found.release(),
                          [](void* at) noexcept { delete static_cast<HitRows*>(at); });
  return nb::make_tuple(array_over<std::int64_t>(all->offsets.data(), {all->offsets.size()}, owner),
                        array_over<float>(all->hits.data(), {all->hits.size(), 6}, owner), version);
}

void bind_queries(nb::module_& module, nb::class_<SharedScene>& scene) {
  const auto rays = nb::arg("rays").noconvert();
  const auto out = nb::arg("out").noconvert();
  scene.def("closest_hit", query_closest_hit, rays, out, nb::arg("request"))
      .def("any_hit", query_any_hit, rays, out, nb::arg("request"))
      .def("hit_counts", query_hit_counts, rays, out, nb::arg("request"))
      .def("all_hits", query_all_hits, rays, nb::arg("request"),
           nb::arg("most").none() = nb::none());
  module.def("empty_hits", empty_hits, nb::arg("count"));
}

/// A getter that takes only an id.
template <auto kMember>
auto looking() {
  return [](SharedScene& shared, std::uint32_t id) {
    return shared.look([&](const Scene& scene) { return (scene.*kMember)(id); });
  };
}

template <auto kMember>
auto changing() {
  return [](SharedScene& shared, std::uint32_t id) {
    shared.change([&](Scene& scene) { (scene.*kMember)(id); });
  };
}

void bind_contents(nb::class_<SharedScene>& scene) {
  using CountOfMesh = std::size_t (Scene::*)(MeshId) const;
  using InstancesOfMesh = std::vector<InstanceId> (Scene::*)(MeshId) const;
  constexpr InstancesOfMesh kInstances = &Scene::instances;
  constexpr CountOfMesh kTriangleCount = &Scene::triangle_count;
  scene.def("has_mesh", looking<&Scene::has_mesh>(), nb::arg("mesh"))
      .def("has_instance", looking<&Scene::has_instance>(), nb::arg("instance"))
      .def("instances", looking<kInstances>(), nb::arg("mesh"))
      .def("mesh_of", looking<&Scene::mesh_of>(), nb::arg("instance"))
      .def("mask", looking<&Scene::mask>(), nb::arg("instance"))
      .def("world", looking<&Scene::world>(), nb::arg("instance"))
      .def("transforms", transforms, nb::arg("instance"))
      .def("vertex_count", looking<&Scene::vertex_count>(), nb::arg("mesh"))
      .def("triangle_count", looking<kTriangleCount>(), nb::arg("mesh"))
      .def("meshes",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.meshes(); }); })
      .def("total_triangle_count",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.triangle_count(); }); })
      .def("instance_count",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.instance_count(); }); })
      .def("is_committed",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.is_committed(); }); })
      .def("memory_bytes",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.memory_bytes(); }); })
      .def("context",
           [](SharedScene& s) { return s.look([](const Scene& c) { return c.context(); }); })
      .def("threads",
           [](SharedScene& s) {
             return s.look([](const Scene& c) { return c.context().threads(); });
           })
      .def("is_on_cuda",
           [](SharedScene& s) {
             return s.look([](const Scene& c) { return c.context().device() == Device::kCuda; });
           })
      .def("bounds", bounds);
}

}  // namespace

void bind_scene(nb::module_& module) {
  nb::class_<Place>(module, "Place")
      .def(
          "__init__",
          [](Place* place, std::uintptr_t pointer, std::size_t count, std::uintptr_t stream) {
            new (place) Place{std::bit_cast<void*>(pointer), count, std::bit_cast<void*>(stream)};
          },
          nb::arg("pointer"), nb::arg("count"), nb::arg("stream"));
  nb::class_<QueryRequest>(module, "QueryRequest")
      .def(
          "__init__",
          [](QueryRequest* request, std::uint32_t mask, bool brute, bool check,
             nb::object statistics, std::uint32_t sides, std::optional<MaskArray> masks,
             std::optional<SkipArray> skip, std::optional<MaskArray> worlds, std::size_t per_world,
             std::optional<TimeArray> times) {
            new (request) QueryRequest{mask,
                                       brute,
                                       check,
                                       std::move(statistics),
                                       static_cast<Sides>(sides),
                                       std::move(masks),
                                       std::move(skip),
                                       std::move(worlds),
                                       per_world,
                                       std::move(times)};
          },
          nb::arg("mask"), nb::arg("brute"), nb::arg("check"), nb::arg("statistics").none(),
          nb::arg("sides") = 0, nb::arg("masks").noconvert().none() = nb::none(),
          nb::arg("skip").noconvert().none() = nb::none(),
          nb::arg("worlds").noconvert().none() = nb::none(), nb::arg("per_world") = 0,
          nb::arg("times").noconvert().none() = nb::none());

  [[maybe_unused]] const nb::class_<Context> context(module, "Context");
  nb::class_<SharedScene> scene(module, "Scene");
  const auto vertices = nb::arg("vertices").noconvert();
  const auto triangles = nb::arg("triangles").noconvert().none();
  const auto transform = nb::arg("transform").noconvert();
  scene.def(nb::init<std::uint32_t, bool>(), nb::arg("threads"), nb::arg("cuda"))
      .def("add", add, vertices, triangles, nb::arg("place"), transform, nb::arg("mask"),
           nb::arg("world"))
      .def("replace", replace, nb::arg("mesh"), vertices, triangles)
      .def("update", update, nb::arg("mesh"), vertices, nb::arg("times"))
      .def("remove", changing<&Scene::remove>(), nb::arg("mesh"))
      .def("instance", instance, nb::arg("mesh"), transform, nb::arg("mask"), nb::arg("world"))
      .def("make_instances", make_instances, nb::arg("mesh"), nb::arg("transforms"),
           nb::arg("worlds").none(), nb::arg("mask"))
      .def("remove_instance", changing<&Scene::remove_instance>(), nb::arg("instance"))
      .def("set_transforms", set_transforms, nb::arg("instances"), nb::arg("transforms"),
           nb::arg("each"))
      .def(
          "set_mask",
          [](SharedScene& shared, InstanceId instance, std::uint32_t mask) {
            shared.change([&](Scene& s) { s.set_mask(instance, mask); });
          },
          nb::arg("instance"), nb::arg("mask"))
      .def(
          "set_world",
          [](SharedScene& shared, InstanceId instance, WorldId world) {
            shared.change([&](Scene& s) { s.set_world(instance, world); });
          },
          nb::arg("instance"), nb::arg("world"))
      .def("commit", &SharedScene::commit);
  bind_contents(scene);
  bind_queries(module, scene);
  bind_point_queries(module, scene);
}

}  // namespace raysheaf::python
