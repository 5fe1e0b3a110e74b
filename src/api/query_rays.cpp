#include "api/query_rays.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "api/pack_rays.h"
#include "api/query_check.h"
#include "raysheaf/error.h"

namespace raysheaf {

QueryRays::QueryRays(const RayParts& parts, bool check)
    : RaySource(parts.count), parts_(parts), is_packed_(false), check_(check) {
  const auto require = [&](const NumberRows& rows, const char* place) {
    if (rows.data == nullptr && parts.count != 0)
      throw Error(ErrorCode::kInvalidArgument,
                  "there is no array for " + std::to_string(parts.count) + " rays", place);
  };
  require(parts.origins, "rays.origins");
  require(parts.directions, "rays.directions");
}

View<const Ray> QueryRays::peek(std::size_t begin, std::size_t end, Ray* room) const {
  if (is_packed_) return rays_.slice(begin, end - begin);
  pack_rays(parts_, begin, end, room);
  return {room, end - begin};
}

View<const Ray> QueryRays::take(std::size_t begin, std::size_t end, Ray* room) const {
  const View<const Ray> some = peek(begin, end, room);
  if (check_ && !are_right(some)) throw WrongRay();
  return some;
}

void QueryRays::throw_first_fault() const {
  Ray room[64];
  for (std::size_t begin = 0; begin < size(); begin += std::size(room))
    throw_fault(peek(begin, std::min(size(), begin + std::size(room)), room), begin);
  throw Error(ErrorCode::kInvalidData, "the rays changed while they were read", "rays");
}

}  // namespace raysheaf
