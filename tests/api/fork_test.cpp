// After fork, children have their parent's memory but not its threads.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "api/api_support.h"

namespace raysheaf::test {
namespace {

/// The result of `body` in a child of fork, from 0 to 100; a larger number if the child crashes or
/// hangs.
template <class Body>
int in_child(const Body& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(20);
    int code = 101;
    try {
      code = body();
    } catch (...) {
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Whether `body` throws an error with this code.
template <class Body>
bool refused(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.code() == ErrorCode::kWrongState;
  }
  return false;
}

class Forks : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the thread sanitizer ends children that have threads";
#endif
  }
};

// Forks while other threads run queries, which may hold locks.
TEST_P(Forks, RefuseTheParentsScenesAndMayHaveTheirOwn) {
  const RandomSoup soup(2000, 20000);
  const Context context({.threads = GetParam()});
  Scene scene(context);
  scene.add_soup(soup.positions);
  scene.commit();
  const std::vector<Hit> expected = closest_hit(scene, soup.rays);
  std::atomic<bool> end = false;
  std::thread asking([&] {
    while (!end) static_cast<void>(closest_hit(scene, soup.rays));
  });
  for (int round = 0; round < 10; ++round) {
    const int wrong = in_child([&] {
      const bool queries = refused([&] { static_cast<void>(closest_hit(scene, soup.rays)); });
      const bool looks = refused([&] { static_cast<void>(scene.mesh_count()); });
      const bool changes = refused([&] { scene.commit(); });
      const bool loops = GetParam() == 1 || refused([&] {
                           context.for_each_block(1000, 1, [](std::size_t, std::size_t) {});
                         });
      Scene own(Context({.threads = GetParam()}));
      own.add_soup(soup.positions);
      own.commit();
      const bool same_hits = std::ranges::equal(closest_hit(own, soup.rays), expected, same);
      return (queries ? 0 : 1) + (looks ? 0 : 2) + (changes ? 0 : 4) + (loops ? 0 : 8) +
             (same_hits ? 0 : 16);
    });
    EXPECT_EQ(wrong, 0) << "round " << round;
  }
  end = true;
  asking.join();
  EXPECT_TRUE(std::ranges::equal(closest_hit(scene, soup.rays), expected, same));
}
INSTANTIATE_TEST_SUITE_P(Threads, Forks, ::testing::Values(1u, 2u, 4u));

}  // namespace
}  // namespace raysheaf::test
