// Reads skins and animations (glTF 2.0, sections 3.7.3 and 3.11).
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "io/gltf.h"
#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// The matrix is stored by columns, as in glTF.
Affine affine_from(const float* m, const std::string& place) {
  if (std::fabs(m[3]) + std::fabs(m[7]) + std::fabs(m[11]) + std::fabs(m[15] - 1) > 1e-4f)
    refuse("is not affine: its last row is not 0 0 0 1", place);
  Affine result;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) result.m[r][c] = m[4 * c + r];
  }
  return result;
}

Interpolation interpolation_of(const std::string& name, const std::string& place) {
  if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  refuse("is \"" + printable(name) + "\", not LINEAR, STEP or CUBICSPLINE", place);
}

void check_times(const std::vector<float>& times, const std::string& place) {
  check_finite(times, 1, place);
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (times[k] < 0) refuse("is negative", element(place, k));
    if (k == 0 || times[k] > times[k - 1]) continue;
    refuse("is " + std::to_string(times[k]) + ", not later than the key before, " +
               std::to_string(times[k - 1]),
           element(place, k));
  }
}

/// An error in an animation does not affect the rest pose: it becomes a warning, which ends with
/// `rest`. Running out of memory stays an error.
template <class Read>
void within_animation(Warnings& warnings, const char* rest, const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kOutOfMemory) throw;
    const std::string place = error.place().empty() ? "" : error.place() + ": ";
    warnings.once(place + error.sentence() + ". " + rest);
  }
}

/// Reads one animation of the file.
class ClipReader {
 public:
  ClipReader(const JsonValue& source, std::string place, const GltfNodes& nodes,
             const std::vector<std::uint32_t>& shape_of_node, AccessorReader& accessors,
             const Rig& rig, Warnings& warnings)
      : source_(source),
        samplers_(source.items("samplers")),
        place_(std::move(place)),
        nodes_(nodes),
        shape_of_node_(shape_of_node),
        accessors_(accessors),
        rig_(rig),
        warnings_(warnings) {}

  RigClip read() {
    clip_.name = source_.get("name", std::string());
    const auto channels = source_.items("channels");
    for (std::size_t c = 0; c < channels.size(); ++c)
      within_animation(warnings_, "That channel is left out.",
                       [&] { read_channel(channels[c], c); });
    return std::move(clip_);
  }

 private:
  void read_channel(const JsonValue& channel, std::size_t index) {
    const std::string place = element(place_ + ".channels", index);
    const JsonValue& target = channel.at("target");
    const std::string pointer = "KHR_animation_pointer";
    if (extension(target, pointer.c_str()) != nullptr)
      return warnings_.once("Animations by \"" + pointer + "\" are left out.");
    if (!target.contains("node")) return;  // the target belongs to another extension
    const auto node = target.at("node").get<std::size_t>();
    const auto path = target.at("path").get<std::string>();
    RigChannel result;
    int components = 3;
    std::size_t width = 1;
    result.target = nodes_.place_of[node];
    if (path == "translation") {
      result.path = RigPath::kTranslation;
    } else if (path == "scale") {
      result.path = RigPath::kScale;
    } else if (path == "rotation") {
      result.path = RigPath::kRotation;
      components = 4;
    } else if (path == "weights") {
      if (shape_of_node_[node] == kInvalidId)
        return warnings_.once("Animated weights of nodes that show no morph targets are left out.");
      result.path = RigPath::kWeights;
      result.target = shape_of_node_[node];
      components = 1;
      width = rig_.shapes[result.target].targets.size();
    } else {
      return warnings_.once("Animations of \"" + printable(path) + "\" are left out.");
    }
    if (result.path != RigPath::kWeights && rig_.nodes[result.target].matrix)
      refuse("the node has a matrix, so it cannot be animated", place + ".target.node");
    if (width == 0) return;
    if (driven_.contains({result.path, result.target})) {
      refuse("drives the " + path + " of nodes[" + std::to_string(node) +
                 "], which an earlier channel drives already",
             place + ".target");
    }
    result.curve = curve_of(channel.at("sampler").get<std::size_t>(), components, width, place);
    driven_.insert({result.path, result.target});
    clip_.channels.push_back(result);
  }

  /// Index of a sampler's curve, which is read when a channel first uses it.
  std::uint32_t curve_of(std::size_t sampler, int components, std::size_t width,
                         const std::string& channel) {
    if (sampler >= samplers_.size()) {
      refuse("is " + std::to_string(sampler) + ", but the animation has " +
                 std::to_string(samplers_.size()) + " samplers",
             channel + ".sampler");
    }
    const auto known = curves_.find({sampler, components, width});
    if (known != curves_.end()) return known->second;
    const JsonValue& source = samplers_[sampler];
    const std::string place = element(place_ + ".samplers", sampler);
    const int output = source.at("output").get<int>();
    Curve curve;
    curve.interpolation = interpolation_of(source.get("interpolation", std::string("LINEAR")),
                                           place + ".interpolation");
    curve.times = accessors_.floats(source.at("input").get<int>(), 1, place + ".input");
    check_times(curve.times, place + ".input");
    curve.values = accessors_.floats(output, components, place + ".output");
    check_finite(curve.values, static_cast<std::size_t>(components), place + ".output");
    const bool cubic = curve.interpolation == Interpolation::kCubicSpline;
    const std::size_t wanted = curve.times.size() * width * (cubic ? 3 : 1);
    const std::size_t there = accessors_.count(output);
    if (there != wanted) {
      refuse("has " + std::to_string(there) + " elements, but " +
                 std::to_string(curve.times.size()) + (cubic ? " keys with tangents" : " keys") +
                 (components == 1 ? " of " + std::to_string(width) + " weights" : "") + " need " +
                 std::to_string(wanted),
             place + ".output");
    }
    const auto number = static_cast<std::uint32_t>(clip_.curves.size());
    clip_.curves.push_back(std::move(curve));
    curves_[{sampler, components, width}] = number;
    return number;
  }

  const JsonValue& source_;
  const std::span<const JsonValue> samplers_;
  const std::string place_;
  const GltfNodes& nodes_;
  const std::vector<std::uint32_t>& shape_of_node_;
  AccessorReader& accessors_;
  const Rig& rig_;
  Warnings& warnings_;
  RigClip clip_;
  std::set<std::pair<RigPath, std::uint32_t>> driven_;
  std::map<std::tuple<std::size_t, int, std::size_t>, std::uint32_t> curves_;
};

/// `check_animation`, whose errors also name the animation.
void check_animation_at(const JsonValue& root, const JsonValue& animation,
                        const std::string& place) {
  try {
    check_animation(root, animation);
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(),
                error.place().empty() ? place : place + "." + error.place());
  }
}

}  // namespace

void read_skins(const GltfModel& model, const GltfNodes& nodes, AccessorReader& accessors,
                Rig& rig) {
  const auto skins = model.list("skins");
  for (std::size_t s = 0; s < skins.size(); ++s) {
    const JsonValue& source = skins[s];
    const std::string place = element("skins", s);
    RigSkin skin;
    skin.name = source.get("name", std::string());
    const auto joints = source.items("joints");
    if (joints.empty()) refuse("there are no joints", place + ".joints");
    for (const JsonValue& joint : joints)
      skin.joints.push_back(nodes.place_of[joint.get<std::size_t>()]);
    skin.inverse_bind.resize(skin.joints.size());
    if (const JsonValue* accessor = source.find("inverseBindMatrices")) {
      const std::string matrices = place + ".inverseBindMatrices";
      const std::size_t there = accessors.count(accessor->get<int>());
      if (there < skin.joints.size()) {
        refuse("has " + std::to_string(there) + " matrices for " +
                   std::to_string(skin.joints.size()) + " joints",
               matrices);
      }
      const std::vector<float> values = accessors.floats(accessor->get<int>(), 16, matrices);
      check_finite(values, 16, matrices);
      for (std::size_t j = 0; j < skin.joints.size(); ++j)
        skin.inverse_bind[j] = affine_from(values.data() + 16 * j, element(matrices, j));
    }
    rig.skins.push_back(std::move(skin));
  }
}

void read_clips(const GltfModel& model, const GltfNodes& nodes,
                const std::vector<std::uint32_t>& shape_of_node, AccessorReader& accessors,
                Rig& rig, Warnings& warnings) {
  const auto animations = model.list("animations");
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const std::string place = element("animations", a);
    RigClip clip;
    within_animation(warnings, "That animation is left out.", [&] {
      check_animation_at(model.root(), animations[a], place);
      clip =
          ClipReader(animations[a], place, nodes, shape_of_node, accessors, rig, warnings).read();
    });
    if (clip.name.empty()) clip.name = "animation " + std::to_string(a);
    if (!clip.channels.empty()) rig.clips.push_back(std::move(clip));
  }
}

}  // namespace raysheaf::io
