// Repeats queries with the same rays, in another order, in pieces, and on a scene with another
// history.
#include <algorithm>
#include <numeric>

#include "lab/verify/round.h"
#include "lab/verify/simd_target.h"
#include "lab/verify/soup.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kSplitTriangles = 4000;
constexpr std::size_t kSplitRays = 6000;

struct Answers {
  std::vector<Hit> closest;
  std::vector<std::uint8_t> any;
  HitRows all;
};

Answers ask(const Subject& subject, const Scene& scene, std::span<const Ray> rays) {
  return {subject.closest_hit(scene, rays, {}), subject.any_hit(scene, rays, {}),
          subject.all_hits(scene, rays, {})};
}

/// The reference for all comparisons: one thread, the first SIMD target, a new scene.
class Reference {
 public:
  Reference(const Soup& soup, const std::vector<Ray>& rays, Answers answers, Tally* tally)
      : soup_(soup), rays_(rays), answers_(std::move(answers)), tally_(tally) {}

  /// `other` answers the rays order[first], order[first + 1], ...
  void compare(const std::string& how, const Answers& other, std::span<const std::uint32_t> order) {
    tally_->tried(3 * order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t ray = order[i];
      const auto row = other.all[i], right_row = answers_.all[ray];
      const char* question = nullptr;
      if (!same(other.closest[i], answers_.closest[ray])) question = "closest_hit";
      if (other.any[i] != answers_.any[ray]) question = "any_hit";
      if (!std::equal(row.begin(), row.end(), right_row.begin(), right_row.end(), same))
        question = "all_hits";
      if (question == nullptr) continue;
      tally_->fail(std::string(question) + " " + how + ": " + soup_.text() + ", ray " +
                   std::to_string(ray) + ", a " + text_of(rays_[ray]) + ": another answer, " +
                   text_of(other.closest[i]) + " instead of " + text_of(answers_.closest[ray]));
      return;
    }
  }

 private:
  const Soup& soup_;
  const std::vector<Ray>& rays_;
  Answers answers_;
  Tally* tally_;
};

std::vector<std::uint32_t> shuffled(std::size_t count, Random* random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[random->below(static_cast<std::uint32_t>(i))]);
  return order;
}

std::vector<Ray> in_order(const std::vector<Ray>& rays, std::span<const std::uint32_t> order) {
  std::vector<Ray> out;
  for (const std::uint32_t ray : order) out.push_back(rays[ray]);
  return out;
}

void compare_pieces(const Subject& subject, const Scene& scene, const std::vector<Ray>& rays,
                    std::span<const std::uint32_t> order, Reference* reference, Random* random) {
  for (std::size_t first = 0; first < order.size();) {
    const std::size_t most = random->one_in(3) ? 3 : 1 + order.size() / 4;
    const std::size_t count = std::min<std::size_t>(
        1 + random->below(static_cast<std::uint32_t>(most)), order.size() - first);
    const auto piece = order.subspan(first, count);
    reference->compare("in pieces", ask(subject, scene, in_order(rays, piece)), piece);
    first += count;
  }
}

/// The soup as a scene that had other vertices, other triangles and another position before, with
/// queries in between.
Scene scene_with_a_past(const Soup& soup, const Context& context, std::span<const Ray> rays,
                        const Subject& subject, Random* random) {
  Scene scene(context);
  std::vector<MeshId> ids;
  for (const std::vector<Vec3>& mesh : soup.meshes) {
    std::vector<Vec3> before = mesh;
    for (Vec3& p : before) p = p * 0.5f;
    if (random->one_in(2)) before.resize(3);
    ids.push_back(scene.add_soup(before));
  }
  const MeshId extra = scene.add_soup(soup.meshes.front());
  const InstanceId copy =
      scene.instance(ids.front(), {{{{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}}});
  scene.commit();
  (void)subject.closest_hit(scene, rays, {});
  scene.remove(extra);
  scene.remove_instance(copy);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (scene.vertex_count(ids[i]) == soup.meshes[i].size())
      scene.update(ids[i], soup.meshes[i]);
    else
      scene.replace_soup(ids[i], soup.meshes[i]);
  }
  scene.commit();
  return scene;
}

}  // namespace

void check_determinism(const Subject& subject, std::uint64_t seed, Tally* tally) {
  Random random(seed);
  const Soup soup = make_soup(kSplitTriangles, {}, &random);
  const std::size_t count = 1 + random.below(kSplitRays);
  const std::vector<Ray> rays =
      random.one_in(4) ? make_fan(soup, count, &random) : make_rays(soup, count, &random);
  std::vector<std::uint32_t> as_given(count);
  std::iota(as_given.begin(), as_given.end(), 0u);

  Scene first(subject.threads.front().context);
  soup.add_to(&first);
  Answers answers = [&] {
    const OnSimdTarget on(subject.targets.front());
    return ask(subject, first, rays);
  }();
  Reference reference(soup, rays, std::move(answers), tally);

  const std::int64_t target =
      subject.targets[random.below(static_cast<std::uint32_t>(subject.targets.size()))];
  const OnSimdTarget on(target);
  for (const Subject::Threads& threads : subject.threads) {
    const std::string where =
        " with " + std::to_string(threads.count) + " threads on " + name_of(target);
    Scene scene(threads.context);
    soup.add_to(&scene);
    reference.compare("asked first" + where, ask(subject, scene, rays), as_given);
    reference.compare("asked again" + where, ask(subject, scene, rays), as_given);
    const std::vector<std::uint32_t> order = shuffled(count, &random);
    reference.compare("in another order" + where, ask(subject, scene, in_order(rays, order)),
                      order);
    compare_pieces(subject, scene, rays, order, &reference, &random);
    const Scene changed = scene_with_a_past(soup, threads.context, rays, subject, &random);
    reference.compare("of a scene that was changed" + where, ask(subject, changed, rays), as_given);
  }
}

}  // namespace raysheaf::checks
