// Ranks that are threads, so that distributed work can be tested without MPI.
#pragma once

#include <atomic>
#include <barrier>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "raysheaf/distributed.h"

namespace raysheaf::test {

class ThreadRank : public Communicator {
 public:
  /// The state that the threads share.
  struct Shared {
    explicit Shared(std::uint32_t size) : meeting(size), posted(size), failed(size) {}
    std::barrier<> meeting;
    std::vector<std::span<std::byte>> posted;
    std::vector<const Error*> failed;
    std::vector<std::byte> result;
    std::atomic<std::uint64_t> counter{0};
  };

  ThreadRank(Shared* shared, std::uint32_t rank) : shared_(*shared), rank_(rank) {}

  [[nodiscard]] std::uint32_t rank() const override { return rank_; }
  [[nodiscard]] std::uint32_t size() const override {
    return static_cast<std::uint32_t>(shared_.posted.size());
  }
  void broadcast(std::span<std::byte> bytes) override {
    meet(bytes, [&] { shared_.result.assign(bytes.begin(), bytes.end()); });
  }
  void combine(std::span<std::byte> elements, std::size_t element_bytes, Combine how) override {
    meet(elements, [&] {
      shared_.result.assign(elements.begin(), elements.end());
      for (std::uint32_t i = 1; i < size() && !elements.empty(); ++i)
        how(shared_.posted[i].data(), shared_.result.data(), elements.size() / element_bytes);
    });
  }
  [[nodiscard]] std::optional<std::uint64_t> take(std::uint64_t items) override {
    const std::uint64_t item = shared_.counter++ - base_;
    if (item < items) return item;
    base_ += items + size();
    return std::nullopt;
  }
  [[nodiscard]] Error fail(const Error& error) noexcept override {
    if (!failure_) {
      shared_.counter += std::uint64_t{1} << 62;
      shared_.failed[rank_] = &error;
      hear_of_failures();
    }
    return *failure_;
  }

 private:
  template <class OfRank0>
  void meet(std::span<std::byte> bytes, const OfRank0& work) {
    shared_.posted[rank_] = bytes;
    hear_of_failures();
    if (failure_) throw Error(*failure_);
    if (rank_ == 0) work();
    shared_.meeting.arrive_and_wait();
    std::copy(shared_.result.begin(), shared_.result.end(), bytes.begin());
    shared_.meeting.arrive_and_wait();
  }
  void hear_of_failures() {
    shared_.meeting.arrive_and_wait();
    for (std::uint32_t i = 0; i < size() && !failure_; ++i) {
      const Error* error = shared_.failed[i];
      if (error != nullptr)
        failure_.emplace(error->code(), error->sentence(),
                         "rank " + std::to_string(i) + ": " + error->place());
    }
    shared_.meeting.arrive_and_wait();
  }

  Shared& shared_;
  std::uint32_t rank_;
  std::uint64_t base_ = 0;
  std::optional<Error> failure_;
};

/// Runs `work` on `size` threads as ranks. Returns each one's error message, or an empty string.
inline std::vector<std::string> run_ranks(
    std::uint32_t size, const std::function<void(const std::shared_ptr<Communicator>&)>& work) {
  ThreadRank::Shared shared(size);
  std::vector<std::string> errors(size);
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < size; ++i) {
    threads.emplace_back([&, i] {
      const auto ranks = std::make_shared<ThreadRank>(&shared, i);
      try {
        work(ranks);
        ranks->combine({}, 1, nullptr);
      } catch (const Error& error) {
        errors[i] = ranks->fail(error).what();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return errors;
}

}  // namespace raysheaf::test
