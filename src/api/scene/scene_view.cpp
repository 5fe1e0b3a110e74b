#include "api/scene/scene_view.h"

#include <algorithm>
#include <utility>

namespace raysheaf {
namespace {

/// So many that most blocks of numbers lie within one run, which then needs no search.
constexpr std::uint64_t kBlocksARun = 64;

}  // namespace

std::string counted_triangles(const SceneRuns& scene) {
  return "its instances have " + std::to_string(scene.placed.triangle_count()) +
         " triangles in all, more than 2^31 - 1";
}

std::uint64_t visible_triangles(const SceneRuns& scene, std::uint32_t mask) {
  const auto is_seen = [mask](std::uint32_t of_run) { return (of_run & mask) != 0; };
  if (std::all_of(scene.masks.begin(), scene.masks.end(), is_seen))
    return scene.placed.triangle_count();
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < scene.notes.size(); ++i)
    if (is_seen(scene.notes[i].mask)) count += scene.placed.runs()[i].count;
  return count;
}

bool SceneView::shows(std::uint32_t mask) const {
  return everything_ || std::binary_search(masks_.begin(), masks_.end(), mask);
}

void SceneView::refresh(const SceneRuns& scene, View<const std::uint8_t> entered) {
  if (entered.empty() && is_current(scene)) return;
  bool same_runs = !is_new(scene);
  for (std::size_t i = 0; i < scene.notes.size() && same_runs; ++i)
    same_runs = holds(i) || !shows(scene.notes[i].mask) || (!entered.empty() && entered[i] != 0);
  structure_version_ = 0;  // until all is done: memory may run out
  std::vector<TriangleRange> moved;
  if (same_runs)
    moved = move_runs(scene, entered);
  else
    list_runs(scene, entered);
  if (!same_runs || !moved.empty()) {
    ++version_;
    device_is_behind_ = true;
    device_refits_ = device_refits_ && same_runs;
  }
  if (!same_runs)
    engine.set_triangles(source(), false);
  else if (!moved.empty())
    engine.move_triangles(source(), moved);
  structure_version_ = scene.structure_version;
  position_version_ = scene.position_version;
  mask_version_ = scene.mask_version;
}

/// Lists the instances that are shown.
void SceneView::list_runs(const SceneRuns& scene, View<const std::uint8_t> entered) {
  states_.assign(scene.notes.size(), State::kAbsent);
  runs_.clear();
  corners_.clear();
  emptied_.clear();
  ids_.clear();
  count_ = left_out_ = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (!shows(scene.notes[i].mask)) continue;
    if (!entered.empty() && entered[i] != 0) {
      ++left_out_;
      continue;
    }
    const PlacedInstance& instance = scene.placed.instances()[i];
    runs_.push_back({nullptr, nullptr, count_, instance.triangle_count});
    corners_.emplace_back();
    ids_.push_back({instance.geom_id, instance.inst_id});
    set_run(scene, i, State::kShown, runs_.size() - 1);
    count_ += instance.triangle_count;
  }
  note_first_runs();
}

/// Brings the runs to where their instances stand, or empties them. Returns those that differ.
std::vector<TriangleRange> SceneView::move_runs(const SceneRuns& scene,
                                                View<const std::uint8_t> entered) {
  std::vector<TriangleRange> moved;
  left_out_ = 0;
  std::size_t run = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const State state = entered.empty() || entered[i] == 0 ? State::kShown : State::kEmptied;
    if (state == State::kEmptied && shows(scene.notes[i].mask)) ++left_out_;
    if (!holds(i)) continue;
    const bool has_moved = scene.notes[i].moved_at > position_version_;
    if (states_[i] != state || (state == State::kShown && has_moved)) {
      moved.push_back({runs_[run].first, runs_[run].count});
      set_run(scene, i, state, run);
    }
    ++run;
  }
  return moved;
}

void SceneView::set_run(const SceneRuns& scene, std::size_t instance, State state,
                        std::size_t number) {
  TriangleRun& run = runs_[number];
  states_[instance] = state;
  if (state == State::kShown) {
    run.positions = scene.placed.runs()[instance].positions;
    run.triangles = scene.placed.runs()[instance].triangles;
    corners_[number] = run.corners(0)[0];
    return;
  }
  if (emptied_.empty()) {
    const auto largest = std::ranges::max_element(runs_, {}, &TriangleRun::count);
    emptied_.resize(largest->count);
  }
  run.positions = &corners_[number];
  run.triangles = emptied_.data();
}

void SceneView::note_first_runs() {
  const std::uint64_t blocks = kBlocksARun * runs_.size();
  block_bits_ = 0;
  while (count_ >> block_bits_ > blocks) ++block_bits_;
  first_runs_.clear();
  std::uint32_t run = 0;
  for (std::uint64_t first = 0; first < count_; first += std::uint64_t{1} << block_bits_) {
    while (first >= runs_[run].first + runs_[run].count) ++run;
    first_runs_.push_back(run);
  }
}

class SceneView::Namer {
 public:
  explicit Namer(const SceneView& view) : view_(view) {}

  /// Makes a number one within its mesh.
  Ids name(std::uint32_t* triangle) {
    // Neighbours often hit what the one before hit.
    if (*triangle - first_ >= count_) {
      std::uint32_t run = view_.first_runs_[*triangle >> view_.block_bits_];
      while (*triangle - view_.runs_[run].first >= view_.runs_[run].count) ++run;
      first_ = view_.runs_[run].first;
      count_ = view_.runs_[run].count;
      ids_ = view_.ids_[run];
    }
    *triangle -= first_;
    return ids_;
  }

 private:
  const SceneView& view_;
  std::uint32_t first_ = 0, count_ = 0;
  Ids ids_{};
};

HitFilter SceneView::filter(const SceneRuns& scene, const HitChoice& choice,
                            std::vector<FilteredRun>* runs) const {
  runs->reserve(runs_.size());
  for (std::size_t i = 0; i < scene.notes.size(); ++i) {
    if (!holds(i)) continue;
    const TriangleRun& run = runs_[runs->size()];
    const PlacedInstance& instance = scene.placed.instances()[i];
    runs->push_back({run.first, instance.inst_id, scene.notes[i].mask, scene.notes[i].world,
                     instance.mirrored});
  }
  return {choice, *runs, first_runs_.data(), block_bits_};
}

void SceneView::name_hits(View<const IndexedHit> hits, Hit* out) const {
  Namer namer(*this);
  for (const IndexedHit& hit : hits) {
    if (hit.triangle == kInvalidId) {
      *out++ = Hit{};
      continue;
    }
    std::uint32_t number = hit.triangle;
    const Ids ids = namer.name(&number);
    *out++ = {hit.t, hit.u, hit.v, number, ids.mesh, ids.instance};
  }
}

void SceneView::name_points(View<ClosestPoint> found) const {
  Namer namer(*this);
  for (ClosestPoint& one : found) {
    if (one.prim_id == kInvalidId) continue;
    const Ids ids = namer.name(&one.prim_id);
    one.geom_id = ids.mesh;
    one.inst_id = ids.instance;
  }
}

void SceneView::name_hits(const Executor& executor, View<const IndexedHit> hits, Hit* out) const {
  executor.for_each_block(hits.size, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    name_hits({hits.data + begin, end - begin}, out + begin);
  });
}

DeviceQueries& SceneView::device_engine(const DeviceBackend& backend) {
  if (device_engine_ == nullptr) device_engine_ = backend.make_queries();
  return *device_engine_;
}

DeviceQueries& SceneView::device_queries(const Executor& executor, const DeviceBackend& backend) {
  DeviceQueries& there = device_engine(backend);
  if (device_is_behind_) {
    std::vector<RunName> names;
    for (std::size_t r = 0; r < runs_.size(); ++r)
      names.push_back({runs_[r].first, ids_[r].mesh, ids_[r].instance});
    const bool same_triangles = std::exchange(device_refits_, false);  // until it is complete
    there.set_triangles(executor, source(), same_triangles);
    there.set_names(names);
    device_is_behind_ = false;
    device_refits_ = true;
  }
  return there;
}

std::size_t SceneView::memory_bytes() const {
  return (device_engine_ != nullptr ? device_engine_->memory_bytes() : 0) + engine.memory_bytes() +
         points.memory_bytes() + states_.capacity() * sizeof(State) +
         runs_.capacity() * sizeof(TriangleRun) + corners_.capacity() * sizeof(Vec3) +
         emptied_.capacity() * sizeof(emptied_[0]) + ids_.capacity() * sizeof(Ids) +
         first_runs_.capacity() * sizeof(std::uint32_t);
}

std::shared_ptr<SceneView> SceneViews::view_for(const SceneRuns& scene, std::uint32_t mask) {
  const auto is_seen = [mask](std::uint32_t m) { return (m & mask) != 0; };
  const auto unseen = std::find_if_not(scene.masks.begin(), scene.masks.end(), is_seen);
  if (unseen == scene.masks.end())  // a share would cost two atomic operations
    return {std::shared_ptr<SceneView>(), scene.masks.empty() ? nullptr : everything_.get()};
  std::vector<std::uint32_t> seen;
  std::copy_if(scene.masks.begin(), scene.masks.end(), std::back_inserter(seen), is_seen);
  if (seen.empty()) return nullptr;

  const std::lock_guard lock(mutex_);
  auto found = std::find_if(masked_.begin(), masked_.end(),
                            [&](const auto& view) { return view->masks() == seen; });
  if (found == masked_.end()) {
    auto view = std::make_shared<SceneView>(std::move(seen));
    if (masked_.size() == kMostViews) masked_.pop_back();
    found = masked_.insert(masked_.end(), std::move(view));
  }
  std::rotate(masked_.begin(), found, found + 1);
  return masked_.front();
}

void SceneViews::forget_old_masks(const SceneRuns& scene) {
  const std::lock_guard lock(mutex_);
  std::erase_if(masked_, [&](const auto& view) {
    return !std::includes(scene.masks.begin(), scene.masks.end(), view->masks().begin(),
                          view->masks().end());
  });
}

std::size_t SceneViews::memory_bytes() {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = 0;
  const auto add = [&bytes](SceneView& view) {
    const std::lock_guard view_lock(view.mutex);
    bytes += view.memory_bytes();
  };
  add(*everything_);
  for (const auto& view : masked_) add(*view);
  return bytes;
}

}  // namespace raysheaf
