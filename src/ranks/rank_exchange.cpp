// Combines the hits of processes that each stream a part of the blocks: the least of all.
#include <cstring>
#include <type_traits>

#include "ranks/share.h"
#include "raysheaf/stream.h"

namespace raysheaf {
namespace {

static_assert(std::is_trivially_copyable_v<StreamHit>);

void take_the_least(const std::byte* from, std::byte* into, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    StreamHit theirs, ours;
    std::memcpy(&theirs, from + i * sizeof(StreamHit), sizeof(StreamHit));
    std::memcpy(&ours, into + i * sizeof(StreamHit), sizeof(StreamHit));
    if (theirs.block == kInvalidId) continue;
    if (ours.block != kInvalidId && !precedes(theirs.hit, ours.hit)) continue;
    std::memcpy(into + i * sizeof(StreamHit), &theirs, sizeof(StreamHit));
  }
}

class RankExchange : public HitExchange {
 public:
  explicit RankExchange(Communicator& ranks) : ranks_(ranks) {}

  void closest(std::span<StreamHit> hits) override {
    ranks_.combine(std::as_writable_bytes(hits), sizeof(StreamHit), take_the_least);
  }
  void unite(std::span<std::uint8_t> bytes) override { raysheaf::unite(ranks_, bytes); }
  void add(std::span<std::uint64_t> counts) override { raysheaf::add(ranks_, counts); }
  void add(std::span<double> sums) override { raysheaf::add(ranks_, sums); }
  void add(std::span<float> sums) override { raysheaf::add(ranks_, sums); }

 private:
  Communicator& ranks_;
};

}  // namespace

std::unique_ptr<HitExchange> make_hit_exchange(Communicator& ranks) {
  return std::make_unique<RankExchange>(ranks);
}

}  // namespace raysheaf
