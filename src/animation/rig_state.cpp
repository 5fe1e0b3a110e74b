#include "animation/rig_state.h"

#include <algorithm>
#include <cstring>

#include "animation/curve.h"
#include "animation/shape.h"

namespace raysheaf {
namespace {

constexpr std::size_t kChannelGrain = 32, kRigNodeGrain = 256, kInstanceGrain = 1024;

bool same(const Affine& a, const Affine& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The indices in [0, count) whose node is chosen, or all that have a node.
std::vector<std::uint32_t> carried(const std::vector<std::uint32_t>& nodes,
                                   const std::vector<char>& chosen, bool all) {
  std::vector<std::uint32_t> list;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i] != kInvalidId && (all || chosen[nodes[i]] != 0))
      list.push_back(static_cast<std::uint32_t>(i));
  }
  return list;
}

}  // namespace

RigState::RigState(const Rig& rig) : rig_(rig), to_world_(rig.nodes.size()) {
  local_.resize(rig.nodes.size());
  made_.resize(rig.shapes.size());
  rest();
  const std::vector<char> moving = moving_nodes();
  all_ = levels_of(std::vector<char>(rig.nodes.size(), 1));
  moving_ = levels_of(moving);
  all_loads_ = loads_of(moving, true);
  moving_loads_ = loads_of(moving, false);
}

void RigState::rest() {
  for (std::size_t n = 0; n < local_.size(); ++n) {
    const RigNode& node = rig_.nodes[n];
    local_[n].translation = node.translation;
    local_[n].rotation = node.rotation;
    local_[n].scale = node.scale;
    local_[n].matrix = node.matrix;
  }
  weights_.resize(rig_.shapes.size());
  for (std::size_t s = 0; s < weights_.size(); ++s) weights_[s] = rig_.shapes[s].weights;
}

std::vector<char> RigState::moving_nodes() const {
  std::vector<char> moving(rig_.nodes.size(), 0);
  for (const RigClip& clip : rig_.clips) {
    for (const RigChannel& channel : clip.channels)
      if (channel.path != RigPath::kWeights) moving[channel.target] = 1;
  }
  for (std::size_t n = 0; n < moving.size(); ++n) {
    const std::uint32_t parent = rig_.nodes[n].parent;
    if (parent != kInvalidId && moving[parent] != 0) moving[n] = 1;
  }
  return moving;
}

RigState::Levels RigState::levels_of(const std::vector<char>& chosen) const {
  std::vector<std::uint32_t> depth(rig_.nodes.size(), 0);
  Levels levels;
  for (std::uint32_t n = 0; n < depth.size(); ++n) {
    const std::uint32_t parent = rig_.nodes[n].parent;
    if (parent != kInvalidId) depth[n] = depth[parent] + 1;
    if (chosen[n] != 0) levels.nodes.push_back(n);
  }
  std::stable_sort(levels.nodes.begin(), levels.nodes.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return depth[a] < depth[b]; });
  for (std::size_t i = 0; i < levels.nodes.size(); ++i) {
    if (i == 0 || depth[levels.nodes[i]] != depth[levels.nodes[i - 1]]) levels.starts.push_back(i);
  }
  levels.starts.push_back(levels.nodes.size());
  return levels;
}

RigState::Loads RigState::loads_of(const std::vector<char>& chosen, bool all) const {
  Loads loads{carried(rig_.instance_nodes, chosen, all),
              carried(rig_.camera_nodes, chosen, all),
              carried(rig_.light_nodes, chosen, all),
              {}};
  std::vector<char> shapes(rig_.shapes.size(), all ? 1 : 0);
  for (const RigClip& clip : rig_.clips) {
    for (const RigChannel& channel : clip.channels)
      if (channel.path == RigPath::kWeights) shapes[channel.target] = 1;
  }
  for (std::uint32_t s = 0; s < shapes.size(); ++s) {
    const std::uint32_t skin = rig_.shapes[s].skin;
    const bool pulled = skin != kInvalidId &&
                        std::any_of(rig_.skins[skin].joints.begin(), rig_.skins[skin].joints.end(),
                                    [&](auto j) { return chosen[j] != 0; });
    if (shapes[s] != 0 || pulled) loads.shapes.push_back(s);
  }
  return loads;
}

void RigState::apply(const Executor& executor, const RigClip& clip, double time) {
  executor.for_each(clip.channels.size(), kChannelGrain, [&](std::size_t i) {
    const RigChannel& channel = clip.channels[i];
    const Curve& curve = clip.curves[channel.curve];
    switch (channel.path) {
      case RigPath::kTranslation:
        return sample_curve(curve, time, local_[channel.target].translation);
      case RigPath::kScale:
        return sample_curve(curve, time, local_[channel.target].scale);
      case RigPath::kRotation:
        local_[channel.target].rotation = sample_rotation(curve, time);
        return;
      case RigPath::kWeights:
        break;
    }
    std::vector<float>& weights = weights_[channel.target];
    std::vector<double> values(weights.size());
    sample_curve(curve, time, values);
    std::transform(values.begin(), values.end(), weights.begin(),
                   [](double w) { return static_cast<float>(w); });
  });
}

void RigState::place(const Executor& executor, const Levels& levels) {
  for (std::size_t level = 0; level + 1 < levels.starts.size(); ++level) {
    const std::size_t begin = levels.starts[level], count = levels.starts[level + 1] - begin;
    executor.for_each(count, kRigNodeGrain, [&](std::size_t i) {
      const std::uint32_t n = levels.nodes[begin + i], parent = rig_.nodes[n].parent;
      const Placement local = local_placement(local_[n]);
      to_world_[n] = parent == kInvalidId ? local : compose(to_world_[parent], local);
    });
  }
}

SceneChanges RigState::write(const Executor& executor, const Loads& loads, Vertices vertices,
                             SceneDescription& scene) {
  SceneChanges changes;
  std::vector<char> moved(loads.instances.size(), 0);
  executor.for_each(loads.instances.size(), kInstanceGrain, [&](std::size_t i) {
    Instance& instance = scene.instances[loads.instances[i]];
    const Affine to_world = rounded(to_world_[rig_.instance_nodes[loads.instances[i]]]);
    moved[i] = same(to_world, instance.to_world) ? 0 : 1;
    instance.to_world = to_world;
  });
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (moved[i] != 0) changes.moved.push_back(loads.instances[i]);
  for (const std::uint32_t c : loads.cameras)
    scene.cameras[c].to_world = camera_frame(to_world_[rig_.camera_nodes[c]]);
  for (const std::uint32_t l : loads.lights) {
    const Placement& place = to_world_[rig_.light_nodes[l]];
    scene.lights[l].position = rounded(place.columns[3]);
    scene.lights[l].direction = light_direction(place);
    scene.lights[l].right = light_right(place);
  }
  for (const std::uint32_t s : loads.shapes) {
    if (!pose_shape(s, vertices)) continue;
    changes.deformed.push_back(rig_.shapes[s].mesh);
    if (vertices == Vertices::kMove) {
      move_shape(executor, s, scene);
    } else {
      changes.posed.push_back({&rig_.shapes[s], made_[s].weights, made_[s].joints});
    }
  }
  std::sort(changes.deformed.begin(), changes.deformed.end());
  return changes;
}

bool RigState::pose_shape(std::uint32_t index, Vertices vertices) {
  const RigShape& shape = rig_.shapes[index];
  std::vector<Affine> joints;
  if (shape.skin != kInvalidId) {
    const RigSkin& skin = rig_.skins[shape.skin];
    joints.resize(skin.joints.size());
    for (std::size_t j = 0; j < joints.size(); ++j)
      joints[j] = rounded(compose(to_world_[skin.joints[j]], widened(skin.inverse_bind[j])));
  }
  Made& made = made_[index];
  const std::vector<float>& weights = weights_[index];
  const bool stays = made.posed && made.weights == weights &&
                     std::equal(joints.begin(), joints.end(), made.joints.begin(), same);
  if (stays && (made.moved || vertices == Vertices::kLeave)) return false;
  made = {};  // until it is whole: memory may run out
  made.weights = weights;
  made.joints = std::move(joints);
  made.posed = true;
  return true;
}

void RigState::move_shape(const Executor& executor, std::uint32_t index, SceneDescription& scene) {
  const RigShape& shape = rig_.shapes[index];
  Made& made = made_[index];
  deform(executor, shape, made.weights, made.joints, &scene.meshes[shape.mesh]);
  made.moved = true;
}

bool RigState::has_unmoved_vertices() const {
  return std::any_of(made_.begin(), made_.end(),
                     [](const Made& made) { return made.posed && !made.moved; });
}

void RigState::move_vertices(const Executor& executor, SceneDescription& scene) {
  for (std::uint32_t s = 0; s < made_.size(); ++s)
    if (made_[s].posed && !made_[s].moved) move_shape(executor, s, scene);
}

SceneChanges RigState::write_all(const Executor& executor, SceneDescription& scene) {
  place(executor, all_);
  return write(executor, all_loads_, Vertices::kMove, scene);
}

SceneChanges RigState::write_moving(const Executor& executor, SceneDescription& scene) {
  place(executor, moving_);
  return write(executor, moving_loads_, Vertices::kMove, scene);
}

SceneChanges RigState::write_poses(const Executor& executor, SceneDescription& scene) {
  place(executor, moving_);
  return write(executor, moving_loads_, Vertices::kLeave, scene);
}

}  // namespace raysheaf
