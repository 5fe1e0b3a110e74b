#include "picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr double kLogarithmicFrom = 50;  // the same threshold as in heat maps

std::string named(const std::string& name, const char* what, std::size_t index) {
  return name.empty() ? std::string(what) + " " + std::to_string(index) : name;
}

std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f);
}
float encoded(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb kNothing = {24, 25, 29};

template <class Color>
Image painted(const RenderResult& result, const Color& color) {
  Image image;
  image.width = result.width;
  image.height = result.height;
  image.rgba.resize(std::size_t{4} * result.width * result.height);
  for (std::size_t i = 0; i < image.rgba.size() / 4; ++i) {
    const Rgb rgb = color(i);
    std::copy(rgb.begin(), rgb.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i));
    image.rgba[4 * i + 3] = 255;
  }
  return image;
}

/// A colour that differs between neighbouring numbers.
Rgb color_of(std::uint32_t instance, std::uint32_t triangle) {
  const auto spread = [](std::uint32_t n) {
    n = (n ^ (n >> 16)) * 0x7feb352du;
    n = (n ^ (n >> 15)) * 0x846ca68bu;
    return n ^ (n >> 16);
  };
  const std::uint32_t hue = spread(instance + 1);
  const float shade = 0.75f + 0.25f * static_cast<float>(spread(triangle) & 255) / 255;
  const auto part = [&](int shift) {
    return static_cast<std::uint8_t>(shade *
                                     (70.0f + 0.7f * static_cast<float>(hue >> shift & 255)));
  };
  return {part(0), part(8), part(16)};
}

}  // namespace

SceneFacts facts_of(const SceneDescription& scene) {
  SceneFacts facts;
  facts.name = scene.name;
  facts.triangles = scene.triangle_count();
  facts.meshes = scene.meshes.size();
  facts.instances = scene.instances.size();
  facts.lights = scene.lights.size();
  facts.bounds = world_bounds(scene);
  facts.cameras = scene.cameras;
  for (const Mesh& mesh : scene.meshes) {
    facts.mesh_names.push_back(mesh.name);
    facts.materials.push_back(mesh.materials);
  }
  for (const Instance& instance : scene.instances) facts.instance_names.push_back(instance.name);
  for (const Material& material : scene.materials) facts.material_names.push_back(material.name);
  facts.warnings = scene.warnings;
  facts.files = scene.files;
  return facts;
}

float TestScale::at(double value) const {
  if (!(value > low)) return 0;
  const double part =
      logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return static_cast<float>(std::min(part, 1.0));
}

TestScale scale_of(const std::vector<const std::vector<float>*>& tests) {
  double least = std::numeric_limits<double>::infinity(), largest = 0;
  for (const std::vector<float>* values : tests) {
    for (const float value : *values) {
      if (!(value > 0) || !std::isfinite(value)) continue;
      least = std::min<double>(least, value);
      largest = std::max<double>(largest, value);
    }
  }
  if (largest <= 0) return {};
  if (largest / least < kLogarithmicFrom) return {0, largest, false};
  return {std::pow(10.0, std::floor(std::log10(least))), largest, true};
}

FrameStatistics of_one_sample(FrameStatistics statistics, std::uint32_t samples) {
  const std::uint64_t n = std::max(samples, 1u);
  if (!(statistics.total_ms > 0))  // of an image that is still refined
    for (const SampleStatistics& sample : statistics.samples) statistics.total_ms += sample.ms;
  const auto part = [n](double& ms) { ms /= static_cast<double>(n); };
  for (BatchStatistics& batch : statistics.batches) {
    for (std::uint64_t* count :
         {&batch.rays, &batch.chunks, &batch.mesh_sphere_tests, &batch.bound_tests,
          &batch.ray_bound_tests, &batch.final_tests, &batch.hits})
      *count /= n;
    for (LevelStatistics& level : batch.levels) {
      level.tests /= n;
      level.hits /= n;
    }
    StageTimes& t = batch.times_ms;
    for (double* ms : {&t.raygen, &t.order, &t.hierarchy, &t.traverse, &t.intersect}) part(*ms);
  }
  for (double* ms : {&statistics.raster_ms, &statistics.shade_ms, &statistics.total_ms}) part(*ms);
  return statistics;
}

std::vector<float> depths_of(const RenderResult& result, const Camera& camera) {
  const Vec3 eye = column(camera.to_world, 3);
  const Vec3 ahead = normalized(column(camera.to_world, 2)) * -1.0f;
  std::vector<float> depths(result.position.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const bool seen = result.ids[i].prim_id != kInvalidId;
    depths[i] = seen ? dot(result.position[i] - eye, ahead) : -1;
  }
  return depths;
}

Image layer_image(const RenderResult& result, Layer layer, const TestScale& scale, float exposure,
                  const Backdrop* backdrop) {
  const auto seen = [&result](std::size_t i) { return result.ids[i].prim_id != kInvalidId; };
  switch (layer) {
    case Layer::kTests:
      return painted(result, [&](std::size_t i) {
        return result.tests[i] > 0 ? false_color(scale.at(result.tests[i])) : kNothing;
      });
    case Layer::kNormal:
      return painted(result, [&](std::size_t i) {
        const Vec3 n = result.normal[i] * 0.5f + Vec3{0.5f, 0.5f, 0.5f};
        return seen(i) ? Rgb{byte_of(n.x), byte_of(n.y), byte_of(n.z)} : kNothing;
      });
    case Layer::kAlbedo:
      return painted(result, [&](std::size_t i) {
        const Vec3 a = result.albedo[i];
        return seen(i) ? Rgb{byte_of(encoded(a.x)), byte_of(encoded(a.y)), byte_of(encoded(a.z))}
                       : kNothing;
      });
    case Layer::kShadow:
      return painted(result, [&](std::size_t i) {
        const std::uint8_t grey = byte_of(0.1f + 0.85f * result.shadow[i]);
        return seen(i) ? Rgb{grey, grey, grey} : kNothing;
      });
    case Layer::kIds:
      return painted(result, [&](std::size_t i) {
        return seen(i) ? color_of(result.ids[i].inst_id, result.ids[i].prim_id) : kNothing;
      });
    case Layer::kBeauty:
      break;
  }
  RenderResult beauty;
  beauty.width = result.width;
  beauty.height = result.height;
  beauty.beauty = result.beauty;
  beauty.exposure = exposure;
  if (backdrop == nullptr) return tone_mapped(beauty);
  beauty.samples = result.samples;
  beauty.normal = result.normal;
  beauty.ambient = result.ambient;
  return backdrop->picture(beauty);
}

std::optional<Pick> pick(const Picture& picture, const SceneFacts& facts, float x, float y) {
  if (!(x >= 0 && x < 1 && y >= 0 && y < 1) || picture.ids.empty()) return std::nullopt;
  const auto column_of = static_cast<std::size_t>(x * static_cast<float>(picture.size.width));
  const auto row = static_cast<std::size_t>(y * static_cast<float>(picture.size.height));
  const std::size_t pixel = row * picture.size.width + column_of;
  if (pixel >= picture.ids.size()) return std::nullopt;
  Pick picked{x, y, picture.ids[pixel], {}, {}, {}, 0, picture.position[pixel]};
  const auto [inst, geom, prim] = picked.ids;
  if (prim == kInvalidId || geom >= facts.mesh_names.size()) return std::nullopt;
  picked.mesh = named(facts.mesh_names[geom], "mesh", geom);
  if (inst < facts.instance_names.size())
    picked.instance = named(facts.instance_names[inst], "instance", inst);
  const std::vector<std::uint32_t>& materials = facts.materials[geom];
  const std::size_t which = materials.size() == 1 ? 0 : prim;
  if (which < materials.size() && materials[which] < facts.material_names.size()) {
    picked.material = named(facts.material_names[materials[which]], "material", materials[which]);
  } else {
    picked.material = "none";
  }
  picked.t = length(picked.position - column(picture.request.camera.to_world, 3));
  return picked;
}

}  // namespace raysheaf::viewer
