// Where the rays or points of a batch come from. They need not be stored as `Item`.
#pragma once

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

/// Thread-safe.
template <class Item>
class Source {
 public:
  explicit Source(std::size_t size) : size_(size) {}
  virtual ~Source() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Items [begin, end): in place, or in `room`, which has room for as many. They may be invalid.
  [[nodiscard]] virtual View<const Item> peek(std::size_t begin, std::size_t end,
                                              Item* room) const = 0;
  /// The same, validated: a source throws here for invalid items. Each item is taken once.
  [[nodiscard]] virtual View<const Item> take(std::size_t begin, std::size_t end,
                                              Item* room) const {
    return peek(begin, end, room);
  }

 protected:
  Source(const Source&) = default;
  Source& operator=(const Source&) = default;

 private:
  std::size_t size_;
};

/// Items in memory, which are not validated.
template <class Item>
class InPlace final : public Source<Item> {
 public:
  explicit InPlace(View<const Item> items) : Source<Item>(items.size), items_(items) {}
  [[nodiscard]] View<const Item> peek(std::size_t begin, std::size_t end,
                                      Item* /*room*/) const override {
    return items_.slice(begin, end - begin);
  }

 private:
  View<const Item> items_;
};

/// All items in one array, taken by several threads; in `room` unless they are stored so.
template <class Item>
[[nodiscard]] View<const Item> take_all(const Executor& executor, const Source<Item>& items,
                                        Buffer<Item>* room) {
  constexpr std::size_t kGrain = 8192;  // 256 KiB
  if (items.size() == 0) return {};
  Item one;
  const View<const Item> first = items.peek(0, 1, &one);
  const bool lie_in_a_row = first.data != &one;
  if (!lie_in_a_row) room->resize_uninitialized(items.size());
  executor.for_each_block(items.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    static_cast<void>(items.take(begin, end, lie_in_a_row ? nullptr : room->data() + begin));
  });
  return {lie_in_a_row ? first.data : room->data(), items.size()};
}

}  // namespace raysheaf
