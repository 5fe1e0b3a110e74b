#include "rays/ray_source.h"

namespace raysheaf {

View<const Ray> take_all(const Executor& executor, const RaySource& rays, Buffer<Ray>* room) {
  constexpr std::size_t kGrain = 8192;  // 256 KiB
  if (rays.size() == 0) return {};
  Ray one;
  const View<const Ray> first = rays.peek(0, 1, &one);
  const bool lie_in_a_row = first.data != &one;
  if (!lie_in_a_row) room->resize_uninitialized(rays.size());
  executor.for_each_block(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    static_cast<void>(rays.take(begin, end, lie_in_a_row ? nullptr : room->data() + begin));
  });
  return {lie_in_a_row ? first.data : room->data(), rays.size()};
}

}  // namespace raysheaf
