#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

#include "apps/support/median.h"
#include "apps/support/timer.h"
#include "lab/commands/compare/case.h"
#include "lab/commands/compare/frames.h"
#include "lab/commands/instances/instances.h"
#include "raysheaf/context.h"
#include "raysheaf/level_choice.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"

namespace raysheaf::app {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A bumpy sphere of radius 1: 4 k^2 triangles.
Mesh bumpy_sphere(std::uint32_t triangles) {
  const auto k = static_cast<std::uint32_t>(std::sqrt(triangles / 4.0));
  const std::uint32_t columns = 2 * k;
  Mesh mesh;
  mesh.positions.push_back({0, 0, 1});
  for (std::uint32_t row = 1; row <= k; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const float polar = kPi * static_cast<float>(row) / static_cast<float>(k + 1);
      const float turn = 2 * kPi * static_cast<float>(column) / static_cast<float>(columns);
      const float radius = 0.9f + 0.1f * std::sin(5 * polar) * std::sin(4 * turn);
      mesh.positions.push_back({radius * std::sin(polar) * std::cos(turn),
                                radius * std::sin(polar) * std::sin(turn),
                                radius * std::cos(polar)});
    }
  }
  const auto last = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, -1});
  mesh.positions.reserve(mesh.positions.size() + 1);  // four bytes that the peer may read
  for (std::uint32_t column = 0; column < columns; ++column) {
    const std::uint32_t a = 1 + column, b = 1 + (column + 1) % columns;
    mesh.triangles.push_back({0, a, b});
    for (std::uint32_t row = 0; row + 1 < k; ++row) {
      const std::uint32_t up = row * columns, down = up + columns;
      mesh.triangles.push_back({up + a, down + a, down + b});
      mesh.triangles.push_back({up + a, down + b, up + b});
    }
    mesh.triangles.push_back({(k - 1) * columns + a, last, (k - 1) * columns + b});
  }
  return mesh;
}

/// The sides of the cells in which instances stand, whose radius is 1.
constexpr float kCell = 3;

std::uint32_t cells_a_side(std::uint32_t instances) {
  return static_cast<std::uint32_t>(std::ceil(std::cbrt(static_cast<double>(instances)) - 1e-9));
}

/// Turned in all directions, each near the middle of a cell of its own.
std::vector<Affine> transforms_of(std::uint32_t instances, std::uint32_t frame) {
  const std::uint32_t side = cells_a_side(instances);
  std::vector<Affine> all(instances);
  for (std::uint32_t i = 0; i < instances; ++i) {
    const auto number = [&](std::uint32_t place) {
      return fraction_at(16 * (std::uint64_t{instances} * frame + i) + place);
    };
    float q[4], length = 0;
    for (std::uint32_t k = 0; k < 4; ++k) q[k] = 2 * number(k) - 1;
    for (const float x : q) length += x * x;
    for (float& x : q) x /= std::sqrt(std::max(length, 1e-6f));
    const auto [w, x, y, z] = std::array{q[0], q[1], q[2], q[3]};
    const auto at = [&](std::uint32_t cell, std::uint32_t place) {
      return kCell * (static_cast<float>(cell) + 0.5f) + number(place) - 0.5f;
    };
    all[i].m = {
        {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), at(i % side, 4)},
         {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          at(i / side % side, 5)},
         {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
          at(i / side / side, 6)}}};
  }
  return all;
}

/// The middle of the cells in front of it fills a picture of so many pixels.
std::vector<Ray> camera_rays(const Box& box, std::uint32_t count) {
  const auto width = static_cast<std::uint32_t>(std::ceil(std::sqrt(count)));
  const float size = box.max.x - box.min.x;
  std::vector<Ray> rays(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto across = [&](std::uint32_t pixel) {
      return 0.8f * ((static_cast<float>(pixel) + 0.5f) / static_cast<float>(width) - 0.5f);
    };
    rays[i].origin = {box.min.x + 0.6f * size, box.min.y + 0.55f * size, box.min.z - size};
    rays[i].direction = {across(i % width), across(i / width), 1};
  }
  return rays;
}

/// One scene of the library, and how it is asked.
class OurInstances {
 public:
  OurInstances(const Context& context, const Mesh& mesh, std::span<const Affine> transforms,
               std::optional<bool> enter)
      : scene_(context) {
    MeshOptions options;
    options.storage = Storage::kShare;
    options.place = false;
    const MeshId id = scene_.add(mesh.positions, mesh.triangles, options);
    for (const Affine& transform : transforms) ids_.push_back(scene_.instance(id, transform));
    scene_.commit();
    choose_levels(scene_, enter);
  }
  void move(std::span<const Affine> transforms) {
    scene_.set_transforms(ids_, transforms);
    scene_.commit();
  }
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits,
                   QueryStatistics* statistics = nullptr) const {
    QueryOptions options;
    options.check = false;
    options.statistics = statistics;
    raysheaf::closest_hit(scene_, rays, hits, options);
  }
  [[nodiscard]] std::string plan(std::span<const Ray> rays) const {
    std::vector<Hit> hits(rays.size());
    QueryStatistics statistics;
    closest_hit(rays, hits, &statistics);
    return !statistics.plan.empty() && statistics.plan.front().starts_with("instances: entered")
               ? "levels"
               : "flat";
  }
  [[nodiscard]] std::uint64_t bytes() const { return scene_.memory_bytes(); }

 private:
  Scene scene_;
  std::vector<InstanceId> ids_;
};

/// The steps of a frame, by either side: all transforms, and the rays.
struct Side {
  std::function<void(std::span<const Affine>)> move;
  std::function<void(std::span<const Ray>, std::span<Hit>)> trace;
};

/// Milliseconds of processor time that all threads of this process have used.
double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Milliseconds of one frame.
struct Lap {
  double update = 0, trace = 0;
  double cpu = 0;  ///< of all threads
  [[nodiscard]] double total() const { return update + trace; }
};

class Shape {
 public:
  Shape(const Context& context, const std::vector<std::unique_ptr<PeerDevice>>& peers,
        InstancesShape shape, const BenchInstancesCommand& command)
      : context_(context), peers_(peers), command_(command), mesh_(bumpy_sphere(shape.triangles)) {
    shape_ = {shape.instances, static_cast<std::uint32_t>(mesh_.triangles.size())};
    const float size = kCell * static_cast<float>(cells_a_side(shape.instances));
    box_ = {{0, 0, 0}, {size, size, size}};
    for (std::uint32_t frame = 0; frame < 2; ++frame)
      frames_.push_back(transforms_of(shape.instances, frame));
    Timer clock;
    levels_ = std::make_unique<OurInstances>(context_, mesh_, frames_[0], true);
    std::vector<Hit> hits(1);
    clock.lap_ms();
    levels_->closest_hit(random_rays(box_, 1), hits);
    first_ms_ = clock.ms();
    ours_ = std::make_unique<OurInstances>(context_, mesh_, frames_[0], std::nullopt);
    if (command.flat) flat_ = std::make_unique<OurInstances>(context_, mesh_, frames_[0], false);
  }

  InstancesCase measure(InstanceRays kind, bool moved, std::uint32_t rays) {
    InstancesCase result;
    result.shape = shape_;
    result.kind = kind;
    result.moved = moved;
    result.rays = rays;
    result.first_ms = first_ms_;
    rays_ = kind == InstanceRays::kCamera ? camera_rays(box_, rays) : random_rays(box_, rays);
    moved_ = moved;
    std::vector<Best> best = best_ways();
    std::vector<Side> sides = {side_of(*ours_), side_of(*levels_)};
    if (flat_) sides.push_back(side_of(*flat_));
    const std::size_t ours = sides.size();
    for (Best& peer : best) sides.push_back(side_of(*peer.scene, peer.call));
    for (const Side& side : sides) side.move(frames_[0]);

    std::vector<std::vector<Hit>> hits(sides.size(), std::vector<Hit>(rays));
    std::vector<std::vector<Lap>> laps(sides.size());
    for (std::uint32_t round = 0; round < command_.runs + kWarmUp; ++round) {
      for (std::size_t i = 0; i < sides.size(); ++i) {
        const std::size_t side = (i + round) % sides.size();
        const Lap lap = measure(sides[side], hits[side]);
        if (round >= kWarmUp) laps[side].push_back(lap);
      }
    }
    const auto ms = [&](std::size_t side, double (*value)(const Lap&)) {
      std::vector<double> all;
      for (const Lap& lap : laps[side]) all.push_back(value(lap));
      return median(std::move(all));
    };
    const auto update = [](const Lap& lap) { return lap.update; };
    const auto trace = [](const Lap& lap) { return lap.trace; };
    const auto total = [](const Lap& lap) { return lap.total(); };
    const auto cpu = [](const Lap& lap) { return lap.cpu; };
    const auto ratio = [&](std::size_t a, std::size_t b, double (*value)(const Lap&)) {
      std::vector<double> all;
      for (std::size_t i = 0; i < laps[a].size(); ++i)
        all.push_back(value(laps[a][i]) / value(laps[b][i]));
      return median(std::move(all));
    };
    result.update_ms = ms(0, update);
    result.ours_ms = ms(0, total);
    result.levels_ms = ms(1, total);
    if (flat_) {
      result.flat_ms = ms(2, total);
      result.flat_ratio = ratio(1, 2, cpu);
      result.flat_bytes = flat_->bytes();
    }
    result.levels_bytes = levels_->bytes();
    if (moved) ours_->move(frames_[1]);
    result.plan = ours_->plan(rays_);
    for (std::size_t p = 0; p < best.size(); ++p) {
      PeerResult peer;
      peer.version = peers_[p]->version();
      peer.way = best[p].name;
      peer.ms = {ms(ours + p, update), ms(ours + p, trace), ms(ours + p, total)};
      peer.ratio = ratio(0, ours + p, total);
      peer.cpu_ratio = ratio(0, ours + p, cpu);
      peer.bytes = peers_[p]->memory_bytes();
      peer.hits = compare_hits(rays_, hits[0], hits[ours + p], 0x1p-20f * (box_.max.x));
      // Each of our scenes gives the same bits.
      for (std::size_t side = 1; side < ours; ++side) {
        peer.hits.sampled += rays;
        peer.hits.sample_mismatches += differences(hits[0], hits[side]);
      }
      if (p == 0 || peer.ratio > result.peer.ratio) result.peer = std::move(peer);
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kWarmUp = 2;
  /// Short frames are repeated in a lap.
  static constexpr double kLapMs = 3;

  struct Best {
    std::string name;
    std::unique_ptr<PeerScene> scene;
    PeerCall call;
    double ms = std::numeric_limits<double>::infinity();
  };

  static std::uint64_t differences(std::span<const Hit> a, std::span<const Hit> b) {
    return static_cast<std::uint64_t>(std::inner_product(
        a.begin(), a.end(), b.begin(), std::ptrdiff_t{0}, std::plus<>(),
        [](const Hit& one, const Hit& other) {
          const auto bits = [](const Hit& hit) {
            return std::tie(hit.t, hit.u, hit.v, hit.prim_id, hit.geom_id, hit.inst_id);
          };
          return bits(one) == bits(other) ? 0 : 1;
        }));
  }

  static Side side_of(OurInstances& scene) {
    return {[&scene](auto transforms) { scene.move(transforms); },
            [&scene](auto rays, auto hits) { scene.closest_hit(rays, hits); }};
  }
  static Side side_of(PeerScene& scene, const PeerCall& call) {
    return {[&scene](auto transforms) { scene.move_instances(transforms); },
            [&scene, call](auto rays, auto hits) { scene.closest_hit(rays, hits, call); }};
  }

  /// The mean of as many frames as fill a lap. Frames alternate.
  Lap measure(const Side& side, std::span<Hit> hits) const {
    Lap sum;
    std::uint32_t frames = 0;
    const double start = cpu_ms();
    for (; sum.total() < kLapMs || (moved_ && frames % 2 != 0); ++frames) {
      Timer clock;
      if (moved_) side.move(frames_[frames % 2]);
      sum.update += clock.lap_ms();
      side.trace(rays_, hits);
      sum.trace += clock.ms();
    }
    return {sum.update / frames, sum.trace / frames, (cpu_ms() - start) / frames};
  }

  /// The fastest build and call of each peer.
  std::vector<Best> best_ways() const {
    std::vector<Best> all(peers_.size());
    std::vector<PeerBuild> builds = peer_builds(CompareMode::kStatic);
    if (moved_) {
      builds = peer_builds(CompareMode::kRebuild);
      for (const PeerBuild& build : peer_builds(CompareMode::kRefit)) builds.push_back(build);
    }
    std::vector<Hit> hits(rays_.size());
    for (std::size_t p = 0; p < peers_.size(); ++p) {
      for (const PeerBuild& build : builds) {
        auto scene = std::make_unique<PeerScene>(*peers_[p], build);
        scene->set_instances({mesh_.positions, mesh_.triangles}, frames_[0]);
        bool is_best = false;
        for (const PeerCall& call : peers_[p]->calls(false)) {
          const Side side = side_of(*scene, call);
          double ms = std::numeric_limits<double>::infinity();
          for (int i = 0; i == 0 || (i < 3 && ms < 2 * all[p].ms); ++i)
            ms = std::min(ms, measure(side, hits).total());
          if (ms >= all[p].ms) continue;
          all[p].ms = ms;
          all[p].call = call;
          all[p].name = build.name + ", " + call.name;
          is_best = true;
        }
        if (is_best) all[p].scene = std::move(scene);
      }
    }
    return all;
  }

  const Context& context_;
  const std::vector<std::unique_ptr<PeerDevice>>& peers_;
  const BenchInstancesCommand& command_;
  const Mesh mesh_;
  InstancesShape shape_;
  Box box_;
  std::vector<std::vector<Affine>> frames_;
  std::unique_ptr<OurInstances> ours_, levels_, flat_;
  double first_ms_ = 0;
  std::vector<Ray> rays_;
  bool moved_ = false;
};

}  // namespace

InstancesReport measure_instances(const BenchInstancesCommand& command, const Tell& tell) {
  const Context context({Device::kCpu, command.threads});
  const std::vector<std::unique_ptr<PeerDevice>> peers = open_peers(context.threads());
  InstancesReport report;
  report.command = command;
  report.threads = context.threads();
  for (const std::unique_ptr<PeerDevice>& peer : peers)
    report.peer += (report.peer.empty() ? "Embree " : " and Embree ") + peer->version();
  const auto or_all = [](auto chosen, decltype(chosen) all) {
    return chosen.empty() ? all : chosen;
  };
  const auto shapes = or_all(command.shapes, {{50, 1024}, {400, 20164}, {10000, 1024}});
  const auto rays = or_all(command.rays, {10, 1000, 10000, 262144});
  const auto kinds = or_all(command.kinds, {InstanceRays::kCamera, InstanceRays::kRandom});
  const auto moved = or_all(command.moved, {true, false});
  const std::uint64_t total = shapes.size() * rays.size() * kinds.size() * moved.size();
  for (const InstancesShape shape : shapes) {
    tell("preparing " + to_string(shape), report.cases.size(), total);
    Shape scene(context, peers, shape, command);
    for (const bool moves : moved) {
      for (const InstanceRays kind : kinds) {
        for (const std::uint32_t count : rays) {
          tell(to_string(shape) + ", " + std::to_string(count) + " " + to_string(kind) + " rays",
               report.cases.size(), total);
          report.cases.push_back(scene.measure(kind, moves, count));
        }
      }
    }
  }
  return report;
}

}  // namespace raysheaf::app
