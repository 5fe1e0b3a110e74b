#include "lab/verify/promise.h"

#include "raysheaf/error.h"

namespace raysheaf {
namespace checks {

const PromiseWords& words_of(Promise promise) {
  static constexpr PromiseWords kWords[] = {
      {"brute-force", "every method answers as brute force does, bit for bit", "answers", 200},
      {"determinism", "repeated, reordered, in pieces, on a changed scene: the same bits",
       "answers", 100},
      {"watertight", "no ray leaves a closed mesh through an edge or a vertex", "rays", 120},
      {"bounds", "no bound of rays or triangles loses a hit", "hits", 1000},
      {"exact", "hits and misses are those of exact arithmetic on the floats; t within 2 ulp",
       "rays", 200},
      {"instances", "rays meet instances where the transforms of their time place them, exactly",
       "answers", 100},
      {"history", "scenes of any past, asked in any way, answer as brute force and arithmetic do",
       "answers", 150}};
  return kWords[static_cast<std::size_t>(promise)];
}

}  // namespace checks

const char* to_string(Promise promise) {
  return checks::words_of(promise).name;
}

const char* sentence_of(Promise promise) {
  return checks::words_of(promise).sentence;
}

Promise promise_from_string(std::string_view name) {
  std::string names;
  for (const Promise promise : kPromises) {
    if (name == to_string(promise)) return promise;
    names += (names.empty() ? "" : ", ") + std::string(to_string(promise));
  }
  throw Error(ErrorCode::kInvalidArgument,
              "'" + std::string(name) + "' is not a promise; the promises are " + names);
}

}  // namespace raysheaf
