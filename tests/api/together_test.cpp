// Concurrent queries, changes and renders, small enough for the thread sanitizer.
#include <atomic>
#include <thread>

#include "api/api_support.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/render.h"
#include "support/pictures.h"

namespace raysheaf::test {
namespace {

constexpr int kRounds = 12;

/// The triangles' later positions, and rays from one point.
struct FannedSoup : RandomSoup {
  std::vector<Vec3> moved;
  std::vector<Ray> fan;

  FannedSoup() : RandomSoup(200, 150) {
    for (const Vec3& p : positions) moved.push_back(p + Vec3{0.5f, 0, 0});
    Random random(17);
    for (std::size_t i = 0; i < rays.size(); ++i)
      fan.push_back({{6, 0, 0}, 0, random.direction(), kInfinity});
  }
};

struct Answers {
  std::vector<Hit> closest;
  std::vector<std::uint8_t> any, fan;
  std::vector<std::uint32_t> counts;
  LargeVector<Hit> all;

  bool operator==(const Answers& other) const {
    return std::ranges::equal(closest, other.closest, same) && any == other.any &&
           fan == other.fan && counts == other.counts && std::ranges::equal(all, other.all, same);
  }
};

Answers ask(const Scene& scene, const FannedSoup& soup) {
  return {closest_hit(scene, soup.rays), any_hit(scene, soup.rays), any_hit(scene, soup.fan),
          hit_counts(scene, soup.rays), all_hits(scene, soup.rays).hits};
}

Answers answers_of(const Context& context, const FannedSoup& soup,
                   const std::vector<Vec3>& positions) {
  Scene scene(context);
  scene.add_soup(positions);
  scene.commit();
  return ask(scene, soup);
}

/// Threads change and query one scene of the context.
class Together {
 public:
  Together() {
    mesh_ = scene_.add_soup(soup_.positions);
    scene_.commit();
  }

  /// Changes may happen between any two queries.
  void query() {
    for (int round = 0; round < kRounds; ++round) {
      try {
        const std::vector<Hit> hits = closest_hit(scene_, soup_.rays);
        if (!std::ranges::equal(hits, still_.closest, same) &&
            !std::ranges::equal(hits, moved_.closest, same))
          ++wrong_;
        const std::vector<std::uint8_t> any = any_hit(scene_, soup_.fan);
        if (any != still_.fan && any != moved_.fan) ++wrong_;
        const std::vector<std::uint32_t> counts = hit_counts(scene_, soup_.rays);
        if (counts != still_.counts && counts != moved_.counts) ++wrong_;
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kWrongState) ++wrong_;
      }
    }
  }
  void change() {
    for (int round = 0; round < 4 * kRounds; ++round) {
      try {
        scene_.update(mesh_, round % 2 == 0 ? soup_.moved : soup_.positions);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kWrongState) ++wrong_;
      }
      commit();
    }
  }
  /// Uses a separate scene in the same context.
  void own() {
    for (int round = 0; round < kRounds / 2; ++round)
      if (!(answers_of(context_, soup_, round % 2 == 0 ? soup_.positions : soup_.moved) ==
            (round % 2 == 0 ? still_ : moved_)))
        ++wrong_;
  }
  void draw(Method method) {
    RenderOptions options = small_options(16);
    options.method = method;
    options.threads = 2;
    for (int round = 0; round < kRounds / 4; ++round)
      if (!same_bits(render(box_, options).beauty, picture_)) ++wrong_;
  }

  [[nodiscard]] int wrong() const { return wrong_; }
  void expect_all_well() {
    scene_.update(mesh_, soup_.moved);
    scene_.commit();
    EXPECT_TRUE(ask(scene_, soup_) == moved_);
  }

 private:
  void commit() {
    try {
      scene_.commit();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kWrongState) ++wrong_;
    }
  }

  const FannedSoup soup_;
  const Context context_{{.threads = 2}};
  const Answers still_ = answers_of(context_, soup_, soup_.positions),
                moved_ = answers_of(context_, soup_, soup_.moved);
  const SceneDescription box_ = builtin_scene("cornell");
  const std::vector<Vec3> picture_ = render(box_, small_options(16)).beauty;
  Scene scene_{context_};
  MeshId mesh_ = 0;
  std::atomic<int> wrong_ = 0;
};

TEST(Together, QueriesChangesAndRendersOfOneContext) {
  Together all;
  std::vector<std::thread> threads;
  for (int i = 0; i < 2; ++i) threads.emplace_back([&] { all.query(); });
  threads.emplace_back([&] { all.change(); });
  threads.emplace_back([&] { all.own(); });
  for (const Method method : {Method::kDual, Method::kRah})
    threads.emplace_back([&, method] { all.draw(method); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(all.wrong(), 0);
  all.expect_all_well();
}

}  // namespace
}  // namespace raysheaf::test
