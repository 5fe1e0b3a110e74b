#include "api/query_filter.h"

#include <string>

namespace raysheaf {
namespace {

void check_choice_length(std::size_t count, const char* items, std::size_t size,
                         const std::string& name) {
  if (size == 0 || size == count) return;
  throw Error(ErrorCode::kInvalidArgument,
              std::to_string(size) + " are given for " + std::to_string(count) + " " + items, name);
}

void check_worlds(const QueryOptions& options, std::size_t count, const char* items) {
  const std::string all = items, each = all.substr(0, all.size() - 1) + "_worlds";
  const std::string per_world = all + "_per_world";
  check_choice_length(count, items, options.ray_worlds.size(), each);
  const std::size_t number = options.rays_per_world;
  if (number == 0) return;
  if (!options.ray_worlds.empty())
    throw Error(ErrorCode::kInvalidArgument,
                "is given besides " + each + "; one of the two is expected", per_world);
  if (count % number != 0)
    throw Error(
        ErrorCode::kInvalidArgument,
        std::to_string(count) + " " + items + " are not a multiple of " + std::to_string(number),
        per_world);
}

}  // namespace

void check_choice_of_hits(const QueryOptions& options, std::size_t count, const char* items) {
  if (static_cast<int>(options.sides) > static_cast<int>(Sides::kBack))
    throw Error(ErrorCode::kInvalidArgument,
                "there is no value " + std::to_string(static_cast<int>(options.sides)), "sides");
  check_choice_length(count, items, options.ray_masks.size(), "ray_masks");
  check_choice_length(count, items, options.skip.size(), "skip");
  check_choice_length(count, items, options.ray_times.size(), "ray_times");
  check_times(options.ray_times, "ray_times");
  if (has_worlds(options)) check_worlds(options, count, items);
}

void check_times(std::span<const float> times, const char* name) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!(times[i] >= 0 && times[i] <= 1))
      throw Error(ErrorCode::kInvalidData, "the time is not from 0 to 1",
                  std::string(name) + "[" + std::to_string(i) + "]");
}

HitChoice choice_of_hits(const QueryOptions& options) {
  HitChoice choice;
  choice.mask = options.mask;
  choice.sides = options.sides;
  if (!options.ray_masks.empty()) choice.masks = options.ray_masks.data();
  if (!options.skip.empty()) choice.skips = options.skip.data();
  choice.worlds = worlds_of(options);
  return choice;
}

}  // namespace raysheaf
