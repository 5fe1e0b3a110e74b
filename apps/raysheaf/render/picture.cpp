#include "render/picture.h"

#include <vector>

#include "apps/support/console.h"
#include "apps/support/values.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

template <class Vector>
std::vector<float> plane(const std::vector<Vector>& values, float Vector::*axis) {
  std::vector<float> numbers;
  numbers.reserve(values.size());
  for (const Vector& value : values) numbers.push_back(value.*axis);
  return numbers;
}

template <class Vector>
void add_layer(std::vector<ExrChannel>& channels, const std::vector<Vector>& values,
               const std::string& prefix, const char* letters) {
  float Vector::*const axes[3] = {&Vector::x, &Vector::y, &Vector::z};
  for (int i = 0; i < 3; ++i) {
    channels.push_back({prefix + letters[i], plane(values, axes[i])});
  }
}

void write_layers(const RenderResult& result, const std::string& path) {
  std::vector<ExrChannel> channels;
  add_layer(channels, result.beauty, "", "RGB");
  add_layer(channels, result.position, "position.", "XYZ");
  add_layer(channels, result.normal, "normal.", "XYZ");
  add_layer(channels, result.albedo, "albedo.", "RGB");
  add_layer(channels, result.specular, "specular.", "RGB");
  channels.push_back({"shadow.V", result.shadow});
  if (!result.ground.empty()) channels.push_back({"ground.V", result.ground});
  if (!result.tests.empty()) channels.push_back({"tests.V", result.tests});
  const Gbuffer& targets = result.gbuffer;
  if (!targets.position.empty()) {
    add_layer(channels, targets.position, "gbuffer_position.", "XYZ");
    add_layer(channels, targets.normal, "gbuffer_normal.", "XYZ");
    add_layer(channels, targets.diffuse, "gbuffer_diffuse.", "RGB");
    add_layer(channels, targets.specular, "gbuffer_specular.", "RGB");
  }
  write_exr(result.width, result.height, std::move(channels), path);
}

}  // namespace

Image shown_picture(const RenderResult& result, const std::optional<Backdrop>& backdrop) {
  return backdrop ? backdrop->picture(result) : tone_mapped(result);
}

void write_picture(const RenderResult& result, const std::string& name, const std::string& path,
                   const std::optional<Backdrop>& backdrop) {
  if (has_ending(name, ".exr")) return write_layers(result, path);
  const Image picture = shown_picture(result, backdrop);
  if (name == kStandardOutput) {
    const std::vector<std::uint8_t> png = encode_png(picture);
    print({reinterpret_cast<const char*>(png.data()), png.size()});
  } else if (has_ending(name, ".jpg") || has_ending(name, ".jpeg")) {
    write_jpeg(picture, path);
  } else {
    write_png(picture, path);
  }
}

}  // namespace raysheaf::app
