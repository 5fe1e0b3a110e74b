// Random scenes that change, asked in random ways after each change, and compared with brute force
// on a new scene and with exact arithmetic.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

#include "intersect/exact.h"
#include "lab/verify/compare.h"
#include "lab/verify/families.h"
#include "lab/verify/maps.h"
#include "lab/verify/point_judge.h"
#include "lab/verify/sample.h"
#include "lab/verify/simd_target.h"
#include "lab/verify/world.h"
#include "raysheaf/error.h"
#include "raysheaf/level_choice.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kSteps = 8;  ///< changes of a round
/// Pairs with a triangle that are tried for one batch: the rest of its rays, or points, are not
/// judged.
constexpr std::size_t kBrutePairs = 300'000, kPointPairs = 40'000, kExactPairs = 30'000,
                      kWidePairs = 3'000;
constexpr std::size_t kMostRays = 600, kMostPoints = 200;  ///< of most batches
/// Around the numbers from which rays are taken in other ways.
constexpr std::size_t kBatchSizes[] = {1,    2,    3,    15,   16,   17,   24,  25,
                                       31,   32,   255,  256,  257,  511,  512, 513,
                                       4095, 4096, 4097, 8192, 9000, 20000};

std::size_t some_count(std::size_t most, Random* random) {
  if (!random->one_in(3)) return 1 + random->below(static_cast<std::uint32_t>(most));
  const std::size_t count = kBatchSizes[random->below(std::size(kBatchSizes))];
  return count > 1000 && !random->one_in(4) ? count / 256 : count;
}

/// The options that choose hits, with arrays of their own.
struct Choice {
  QueryOptions options;
  std::vector<std::uint32_t> ray_masks;
  std::vector<TriangleId> skip;
  std::vector<WorldId> worlds;
  std::vector<float> times;
  std::string text;

  [[nodiscard]] Choice of(std::span<const std::uint32_t> rays) const {
    Choice part{options,           pick(ray_masks, rays),
                pick(skip, rays),  pick(worlds, rays),
                pick(times, rays), text};
    part.options.ray_masks = part.ray_masks;
    part.options.skip = part.skip;
    part.options.ray_worlds = part.worlds;
    part.options.ray_times = part.times;
    return part;
  }
};

/// Rays, each at a time, unless there are no times.
struct Batch {
  std::vector<Ray> rays;
  std::vector<float> times;
};

/// The answers of a scene to a batch.
struct RayAnswers {
  std::vector<Hit> closest;
  std::vector<std::uint8_t> any;
  HitRows all;                        ///< unless it was not asked for
  std::vector<std::uint32_t> counts;  ///< with `all`
  std::uint32_t most = 0;             ///< of `first`
  HitRows first;                      ///< with `all`
};

/// One committed state of a world, its brute force, and where it is.
class Moment {
 public:
  Moment(const Subject& subject, const World& world, std::string where, Random* random,
         Tally* tally)
      : subject_(subject),
        world_(world),
        scene_(world.scene()),
        view_(view_at(0)),
        where_(std::move(where)),
        random_(random),
        tally_(tally) {
    choose_levels(scene_, random->one_in(2)   ? std::nullopt
                          : random->one_in(2) ? std::optional(true)
                                              : std::optional(false));
    triangles_ = std::max(1u, view_.soup.triangle_count());
    for (std::size_t i = 0; i < view_.placed.size(); ++i) {
      const InstanceId id = view_.placed[i].instance;
      if (numbers_.size() <= id) numbers_.resize(id + 1, kInvalidId);
      numbers_[id] = static_cast<std::uint32_t>(i);
    }
  }

  [[nodiscard]] bool is_empty() const { return view_.placed.empty(); }

  void ask_rays() {
    const RayFamily& family = some_family();
    Batch batch = some_batch(family);
    ask(batch, family.name);
    if (random_->one_in(3)) return;
    std::vector<float> t;
    for (const Hit& hit : closest_) t.push_back(hit.t);
    batch.rays = cut_at(std::move(batch.rays), t, random_);
    ask(batch, family.name);
  }

  void ask_points() {
    const std::size_t count = some_count(kMostPoints, random_);
    const std::vector<std::array<double, 3>> points = make_points(view_.soup, count, random_);
    std::vector<double> radii;
    const float reach = view_.soup.scale * random_->magnitude(-3, 9);
    if (random_->one_in(3))
      for (std::size_t i = 0; i < count; ++i)
        radii.push_back(random_->one_in(9) ? 0.0 : double{reach} * double{random_->unit()});
    PointOptions options;
    options.mask = some_mask();
    if (random_->one_in(3)) options.inside = InsideRule::kEvenOdd;
    const std::vector<WorldId> worlds = some_worlds(count);
    options.point_worlds = worlds;
    compare_points(points, radii, worlds, options);
  }

 private:
  /// For whole numbers, where they are.
  [[nodiscard]] const RayFamily& some_family() {
    const std::span<const RayFamily> all = ray_families();
    const bool is_whole = view_.is_whole ? random_->one_in(2) : random_->one_in(8);
    for (;;) {
      const RayFamily& family = all[random_->below(static_cast<std::uint32_t>(all.size()))];
      if (family.is_whole == is_whole) return family;
    }
  }
  /// The triangles where they are at a time, which is kept.
  [[nodiscard]] const WorldView& view_at(float time) {
    const auto found = views_.find(time);
    return found != views_.end() ? found->second
                                 : views_.emplace(time, world_.view(time)).first->second;
  }
  /// Rays of a time are for the triangles of that time.
  [[nodiscard]] Batch some_batch(const RayFamily& family) {
    const std::size_t count = some_count(kMostRays, random_);
    if (!random_->one_in(world_.moves() ? 2 : 8))
      return {family.make(view_.soup, count, random_), {}};
    constexpr std::size_t kTimes[] = {1, 2, 3, 5, 9};
    const std::size_t times = kTimes[random_->below(std::size(kTimes))];
    Batch batch;
    while (batch.rays.size() < count) {
      const float time = some_time(random_);
      const std::vector<Ray> rays = family.make(view_at(time).soup, count / times + 1, random_);
      batch.rays.insert(batch.rays.end(), rays.begin(), rays.end());
      batch.times.resize(batch.rays.size(), time);
    }
    if (random_->one_in(2))
      for (std::size_t i = batch.rays.size() - 1; i > 0; --i) {
        const std::size_t other = random_->below(static_cast<std::uint32_t>(i + 1));
        std::swap(batch.rays[i], batch.rays[other]);
        std::swap(batch.times[i], batch.times[other]);
      }
    return batch;
  }
  [[nodiscard]] std::uint32_t some_mask() {
    return random_->one_in(2) ? 0xffffffff : random_->below(8);
  }
  /// Worlds for rays or points, often ordered; mostly none in a round without worlds.
  [[nodiscard]] std::vector<WorldId> some_worlds(std::size_t count) {
    const bool has_worlds = std::any_of(view_.placed.begin(), view_.placed.end(),
                                        [](const Placed& p) { return p.world != kAllWorlds; });
    std::vector<WorldId> worlds;
    if (!random_->one_in(has_worlds ? 2 : 8)) return worlds;
    for (std::size_t i = 0; i < count; ++i) worlds.push_back(some_world(random_));
    if (random_->one_in(2)) std::sort(worlds.begin(), worlds.end());
    return worlds;
  }
  /// Whether item i, a ray or a point, is in one world with an instance.
  [[nodiscard]] static bool meet(const std::vector<WorldId>& worlds, std::size_t i,
                                 const Placed& placed) {
    return worlds.empty() || worlds[i] == kAllWorlds || placed.world == kAllWorlds ||
           placed.world == worlds[i];
  }
  /// The number of an instance's mesh in the soup.
  [[nodiscard]] std::uint32_t number_of(InstanceId instance, MeshId mesh) const {
    const std::uint32_t number = instance < numbers_.size() ? numbers_[instance] : kInvalidId;
    return number != kInvalidId && view_.placed[number].mesh == mesh ? number : kInvalidId - 1;
  }
  template <class Found>
  void renumber(std::span<Found> found) const {
    for (Found& one : found) {
      if (one.prim_id == kInvalidId) continue;
      one.geom_id = one.inst_id = number_of(one.inst_id, one.geom_id);
    }
  }
  [[nodiscard]] std::vector<Hit> renumbered(std::vector<Hit> hits) const {
    renumber(std::span(hits));
    return hits;
  }
  [[nodiscard]] HitRows renumbered(HitRows rows) const {
    renumber(std::span<Hit>(rows.hits));
    return rows;
  }

  // --- rays ------------------------------------------------------------------------------------

  Choice some_choice(const Batch& batch) {
    const std::size_t rays = batch.rays.size();
    Choice choice;
    QueryOptions& options = choice.options;
    options.count_tests = random_->one_in(8);
    if (random_->one_in(3)) {
      options.mask = some_mask();
      choice.text += ", mask " + std::to_string(options.mask);
    }
    if (random_->one_in(4)) {
      options.sides = random_->one_in(2) ? Sides::kFront : Sides::kBack;
      choice.text += options.sides == Sides::kFront ? ", fronts" : ", backs";
    }
    if (random_->one_in(6)) {
      for (std::size_t i = 0; i < rays; ++i) choice.ray_masks.push_back(some_mask());
      choice.text += ", ray_masks";
    }
    if (random_->one_in(6)) {
      for (std::size_t i = 0; i < rays; ++i) {
        const Placed& placed =
            view_.placed[random_->below(static_cast<std::uint32_t>(view_.placed.size()))];
        choice.skip.push_back({placed.instance, random_->below(20)});
      }
      choice.text += ", skip";
    }
    choice.worlds = some_worlds(rays);
    if (!choice.worlds.empty()) choice.text += ", worlds";
    choice.times = batch.times;
    if (!choice.times.empty()) choice.text += ", times";
    options.ray_masks = choice.ray_masks;
    options.skip = choice.skip;
    options.ray_worlds = choice.worlds;
    options.ray_times = choice.times;
    return choice;
  }

  /// `hit` in numbers of the soup.
  [[nodiscard]] static bool comes_from_front(const WorldView& view, const Ray& ray,
                                             const Hit& hit) {
    const Vec3* const p = &view.soup.meshes[hit.geom_id][std::size_t{3} * hit.prim_id];
    return exact_answer(ray, p[0], p[1], p[2]).front != view.placed[hit.geom_id].mirrored;
  }

  /// The hits of the problem that the options take.
  [[nodiscard]] static HitRows taken(const Problem& problem, const WorldView& view,
                                     const Choice& choice) {
    const QueryOptions& options = choice.options;
    HitRows rows;
    rows.offsets.push_back(0);
    for (std::size_t i = 0; i < problem.rays.size(); ++i) {
      std::uint32_t mask = options.mask;
      if (!choice.ray_masks.empty()) mask &= choice.ray_masks[i];
      for (const Hit& hit : problem.rows[i]) {
        const Placed& placed = view.placed[hit.inst_id];
        if ((placed.mask & mask) == 0 || !meet(choice.worlds, i, placed)) continue;
        if (!choice.skip.empty() && choice.skip[i].inst_id == placed.instance &&
            choice.skip[i].prim_id == hit.prim_id)
          continue;
        if (options.sides != Sides::kBoth &&
            comes_from_front(view, problem.rays[i], hit) != (options.sides == Sides::kFront))
          continue;
        rows.hits.push_back(hit);
      }
      rows.offsets.push_back(rows.hits.size());
    }
    return rows;
  }

  void ask(const Batch& batch, const char* family) {
    const std::vector<Ray>& rays = batch.rays;
    const Choice choice = some_choice(batch);
    const QueryOptions& options = choice.options;
    const std::string what =
        where_ + ", " + std::to_string(rays.size()) + " rays (" + family + choice.text + ")";
    RayAnswers answers;
    answers.closest = subject_.closest_hit(scene_, rays, options);
    answers.any = subject_.any_hit(scene_, rays, options);
    if (random_->one_in(2)) {
      answers.all = subject_.all_hits(scene_, rays, options);
      answers.counts = subject_.hit_counts(scene_, rays, options);
      answers.most = 1 + random_->below(4);
      answers.first = subject_.first_hits(scene_, rays, answers.most, options);
    }
    std::map<float, std::vector<std::uint32_t>> at_times;
    for (std::uint32_t i = 0; i < rays.size(); ++i)
      at_times[batch.times.empty() ? 0 : batch.times[i]].push_back(i);
    for (const auto& [time, numbers] : at_times)
      judge(rays, numbers, at_times.size(), view_at(time), choice, answers,
            batch.times.empty() ? what : what + " at time " + text_of(double{time}));
    closest_ = std::move(answers.closest);
  }

  /// The answers of these rays, which meet the triangles of a view. They are one of `parts` of the
  /// batch.
  void judge(const std::vector<Ray>& rays, const std::vector<std::uint32_t>& numbers,
             std::size_t parts, const WorldView& view, const Choice& choice,
             const RayAnswers& answers, const std::string& what) {
    const std::size_t most = kBrutePairs / triangles_ / parts + 1;
    const std::vector<std::uint32_t> chosen = pick(numbers, some_of(numbers.size(), most, random_));
    Problem problem{view.soup, pick(rays, chosen), {}};
    solve_by_brute_force(subject_.most().context, &problem);
    compare_exactly(problem, kExactPairs / triangles_ / parts + 1, what);
    const Choice judged = choice.of(chosen);
    problem.rows = taken(problem, view, judged);

    Comparison comparison(problem, what, tally_, [&](std::size_t ray) {
      return closer_look(problem, view, judged, static_cast<std::uint32_t>(ray));
    });
    const std::vector<Hit> closest = pick(answers.closest, chosen);
    comparison.closest(renumbered(closest));
    compare_sides(problem, view, judged, closest, what);
    comparison.any(pick(answers.any, chosen));
    std::uint64_t queries = 3;
    if (!answers.counts.empty()) {
      comparison.all(renumbered(pick(answers.all, chosen)));
      comparison.counts(pick(answers.counts, chosen));
      comparison.all(renumbered(pick(answers.first, chosen)), "first_hits", answers.most);
      queries += 3;
    }
    if (random_->one_in(4)) {  // brute force, too, must know what has changed
      QueryOptions by_brute = judged.options;
      by_brute.method = QueryMethod::kBrute;
      Comparison(problem, "brute force, " + what, tally_)
          .closest(renumbered(subject_.closest_hit(scene_, problem.rays, by_brute)));
      ++queries;
    }
    tally_->tried(queries * chosen.size());
  }

  /// Which sides the hits of the scene are said to be on.
  void compare_sides(const Problem& problem, const WorldView& view, const Choice& judged,
                     const std::vector<Hit>& closest, const std::string& what) {
    const std::vector<HitPoint> points =
        subject_.hit_points(scene_, problem.rays, closest, judged.times);
    for (std::size_t i = 0; i < closest.size(); ++i) {
      const Hit right = problem.closest(i);
      if (right.prim_id == kInvalidId || closest[i].prim_id == kInvalidId) continue;
      const bool front = comes_from_front(view, problem.rays[i], right);
      if (points[i].front == front) continue;
      return tally_->fail(what + ", hit_points: a " + text_of(problem.rays[i]) + ": expected the " +
                          (front ? "front" : "back") + " of " + text_of(right) +
                          ", got the other side");
    }
  }

  /// Brute force, against exact arithmetic.
  void compare_exactly(const Problem& by_brute, std::size_t most, const std::string& what) {
    const std::vector<std::uint32_t> chosen = some_of(by_brute.rays.size(), most, random_);
    Problem problem{by_brute.soup, pick(by_brute.rays, chosen), {}};
    solve_exactly(subject_, &problem, tally_);
    Comparison(problem, "brute force, " + what, tally_).all(pick(by_brute.rows, chosen));
    tally_->tried(chosen.size());
  }

  /// The triangles of a view, with their masks and worlds, without a past and without times.
  [[nodiscard]] Scene new_scene(const WorldView& view) const {
    Scene scene(subject_.most().context);
    for (std::size_t i = 0; i < view.placed.size(); ++i) {
      MeshOptions options;
      options.mask = view.placed[i].mask;
      options.world = view.placed[i].world;
      scene.add_soup(view.soup.meshes[i], options);
    }
    scene.commit();
    return scene;
  }

  /// Whether a ray's closest hit is correct by itself, and in a scene without a past.
  std::string closer_look(const Problem& problem, const WorldView& view, const Choice& choice,
                          std::uint32_t ray) const {
    const std::uint32_t rays[] = {ray};
    const std::span one(&problem.rays[ray], 1);
    const Choice part = choice.of(rays);
    const bool alone = same(renumbered(subject_.closest_hit(scene_, one, part.options)).front(),
                            problem.closest(ray));
    const Scene scene = new_scene(view);
    const bool anew =
        same(subject_.closest_hit(scene, one, {}).front(),
             raysheaf::closest_hit(scene, one, {.method = QueryMethod::kBrute}).front());
    return std::string("; by itself, the ray gets a ") + (alone ? "correct" : "wrong") +
           " closest hit, and in a new scene a " + (anew ? "correct" : "wrong") + " one";
  }

  // --- points ----------------------------------------------------------------------------------

  void compare_points(const std::vector<std::array<double, 3>>& points,
                      const std::vector<double>& radii, const std::vector<WorldId>& worlds,
                      const PointOptions& options) {
    constexpr std::size_t kNearest[] = {1, 1, 2, 5, 17};
    const std::size_t k = kNearest[random_->below(std::size(kNearest))];
    const std::vector<std::uint32_t> chosen =
        some_of(points.size(), kPointPairs / triangles_ + 1, random_);
    const std::vector<std::array<double, 3>> judged = pick(points, chosen);
    const std::vector<double> judged_radii = pick(radii, chosen);
    const auto parts = [](const auto& all, const auto& within) {
      PointParts batch(all);
      if (!within.empty()) batch.radii = NumberRows(within.data(), 1);
      return batch;
    };
    const PointParts asked = parts(points, radii), right = parts(judged, judged_radii);
    const Scene anew = new_scene(view_);
    PointOptions by_brute = options;
    by_brute.method = QueryMethod::kBrute;
    const std::vector<WorldId> judged_worlds = pick(worlds, chosen);
    by_brute.point_worlds = judged_worlds;
    const std::vector<ClosestPoint> nearest = raysheaf::nearest(anew, right, k, by_brute);
    const std::vector<double> distances = raysheaf::signed_distance(anew, right, by_brute);
    const std::vector<std::uint8_t> inside = raysheaf::contains(anew, right, by_brute);

    std::vector<ClosestPoint> found = subject_.nearest(scene_, asked, k, options);
    renumber(std::span(found));
    const std::vector<double> signed_distances =
        pick(subject_.signed_distance(scene_, asked, options), chosen);
    const std::vector<std::uint8_t> contained =
        pick(subject_.contains(scene_, asked, options), chosen);
    const std::string what = where_ + ", " + std::to_string(points.size()) + " points, mask " +
                             std::to_string(options.mask) + (worlds.empty() ? "" : ", worlds") +
                             ", " + view_.soup.text();
    const auto fail = [&](std::size_t i, const std::string& query, const std::string& got) {
      const auto& [x, y, z] = judged[i];
      const double radius =
          judged_radii.empty() ? std::numeric_limits<double>::infinity() : judged_radii[i];
      tally_->fail(what + ", " + query + " of the point (" + text_of(x) + ", " + text_of(y) + ", " +
                   text_of(z) + ") within " + text_of(radius) + ": " + got);
    };
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      for (std::size_t j = 0; j < k; ++j) {
        const ClosestPoint &one = found[chosen[i] * k + j], &expected = nearest[i * k + j];
        if (std::memcmp(&one, &expected, sizeof one) == 0) continue;
        return fail(i, "nearest, number " + std::to_string(j + 1) + " of " + std::to_string(k),
                    "expected " + text_of(expected) + ", got " + text_of(one));
      }
      if (std::bit_cast<std::uint64_t>(signed_distances[i]) !=
          std::bit_cast<std::uint64_t>(distances[i]))
        return fail(i, "signed_distance",
                    "expected " + text_of(distances[i]) + ", got " + text_of(signed_distances[i]));
      if (contained[i] != inside[i])
        return fail(
            i, "contains",
            "expected " + std::to_string(inside[i]) + ", got " + std::to_string(contained[i]));
    }
    compare_exactly(judged, nearest, k, inside, judged_worlds, options, fail);
    tally_->tried(3 * chosen.size());
  }

  /// Brute force, against other arithmetic.
  template <class Fail>
  void compare_exactly(const std::vector<std::array<double, 3>>& points,
                       const std::vector<ClosestPoint>& nearest, std::size_t k,
                       const std::vector<std::uint8_t>& inside, const std::vector<WorldId>& worlds,
                       const PointOptions& options, const Fail& fail) {
    for (const std::uint32_t i : some_of(points.size(), kWidePairs / triangles_ + 1, random_)) {
      const Point point{points[i][0], points[i][1], points[i][2]};
      std::vector<std::uint8_t> seen;
      for (const Placed& placed : view_.placed)
        seen.push_back((placed.mask & options.mask) != 0 && meet(worlds, i, placed) ? 1 : 0);
      const ClosestPoint& first = nearest[i * k];
      if (first.prim_id != kInvalidId)
        if (const std::string fault = fault_of(point, first, view_.soup, seen); !fault.empty())
          return fail(i, "nearest by brute force", text_of(first) + ", but " + fault);
      const Vec3 at{static_cast<float>(point.x), static_cast<float>(point.y),
                    static_cast<float>(point.z)};
      if (at.x != point.x || at.y != point.y || at.z != point.z) continue;
      const std::optional<bool> exact = inside_exactly(at, view_.soup, seen, options.inside);
      if (exact.has_value() && *exact != (inside[i] != 0))
        return fail(
            i, "contains by brute force",
            "expected " + std::to_string(*exact ? 1 : 0) + ", got " + std::to_string(inside[i]));
      tally_->tried(1);
    }
  }

  const Subject& subject_;
  const World& world_;
  const Scene& scene_;
  std::map<float, WorldView> views_;  ///< by time
  const WorldView& view_;             ///< at time 0
  std::string where_;
  Random* random_;
  Tally* tally_;
  std::uint32_t triangles_ = 1;         ///< at least
  std::vector<std::uint32_t> numbers_;  ///< of the soup's meshes, by instance
  std::vector<Hit> closest_;            ///< of the last batch, all its rays
};

/// One of the numbers of threads, or the emulated device.
struct Place {
  const Context& context;
  std::string text;

  static Place of(const Subject& subject, Random* random) {
    if (random->one_in(5)) return {*subject.device, "the emulated device"};
    const Subject::Threads& threads =
        subject.threads[random->below(static_cast<std::uint32_t>(subject.threads.size()))];
    return {threads.context, std::to_string(threads.count) + " threads"};
  }
};

}  // namespace

void check_history(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  const Place place = Place::of(subject, &random);
  World world(place.context, random.bits());
  for (std::uint32_t step = 1; step <= kSteps; ++step) {
    const std::int64_t target =
        subject.targets[random.below(static_cast<std::uint32_t>(subject.targets.size()))];
    const OnSimdTarget on(target);
    std::string where;
    try {
      const std::string fault = world.change();
      where = "step " + std::to_string(step) + " after " + world.last_changes() + ", " +
              name_of(target) + ", " + place.text;
      if (!fault.empty()) tally->fail(std::string(where).append(": ").append(fault));
      Moment moment(subject, world, where, &random, tally);
      if (moment.is_empty()) continue;
      for (std::uint32_t batches = 1 + random.below(3); batches > 0; --batches)
        if (random.one_in(3))
          moment.ask_points();
        else
          moment.ask_rays();
    } catch (const Error& error) {
      tally->fail("step " + std::to_string(step) + where + ": an error: " + error.what());
      return;
    }
  }
}

}  // namespace raysheaf::checks
