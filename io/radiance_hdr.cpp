#include "io/radiance_hdr.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "io/image.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

class Reader {
 public:
  Reader(std::span<const std::uint8_t> file, const std::string& path) : rest_(file), path_(path) {}

  Environment read() {
    read_header();
    read_size();
    check_length();
    map_.radiance.resize(std::size_t{map_.width} * map_.height);
    std::vector<Rgbe> line(length_);
    const std::size_t lines = map_.radiance.size() / length_;
    for (line_ = 0; line_ < lines; ++line_) {
      read_line(line);
      for (std::size_t i = 0; i < length_; ++i)
        map_.radiance[place_of(line_, i)] = radiance_of(line[i]);
    }
    return std::move(map_);
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence,
                           ErrorCode code = ErrorCode::kInvalidData) const {
    throw Error(code, sentence, path_);
  }

  std::string_view line() {
    const auto* const text = reinterpret_cast<const char*>(rest_.data());
    const std::string_view all(text, rest_.size());
    const std::size_t end = all.find('\n');
    if (end == std::string_view::npos) refuse("the file ends within its header");
    rest_ = rest_.subspan(end + 1);
    return all.substr(0, end > 0 && all[end - 1] == '\r' ? end - 1 : end);
  }

  void read_header() {
    const std::string_view magic = line();
    if (magic != "#?RADIANCE" && magic != "#?RGBE")
      refuse("is not a Radiance image: it does not begin with #?RADIANCE");
    for (std::string_view field = line(); !field.empty(); field = line()) {
      if (field.starts_with("FORMAT=") && field != "FORMAT=32-bit_rle_rgbe")
        refuse("the format " + std::string(field.substr(7)) + " is not 32-bit_rle_rgbe",
               ErrorCode::kUnsupported);
      if (field.starts_with("EXPOSURE=")) read_exposure(field.substr(9));
    }
  }

  /// The factor that all pixels were multiplied with; several factors multiply.
  void read_exposure(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    double factor = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), factor);
    if (error != std::errc{} || !(factor > 0 && std::isfinite(factor)))
      refuse("EXPOSURE is not a number above 0");
    exposure_ *= factor;
  }

  /// An axis, the direction in which it is stored, and its length: "-Y 512".
  struct Side {
    bool is_y = false, is_ascending = false;
    std::uint32_t count = 0;
  };
  static std::optional<Side> side(std::string_view& text) {
    if (text.size() < 4 || (text[0] != '+' && text[0] != '-') || text[2] != ' ' ||
        (text[1] != 'X' && text[1] != 'Y'))
      return {};
    Side side{text[1] == 'Y', text[0] == '+', 0};
    text.remove_prefix(3);
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), side.count);
    if (error != std::errc{} || side.count == 0) return {};
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    return side;
  }

  /// The first axis is that of the lines, the second that along a line.
  void read_size() {
    std::string_view text = line();
    const std::string words(text.substr(0, 40));
    const auto across = side(text);
    if (across && text.starts_with(' ')) text.remove_prefix(1);
    const auto along = across ? side(text) : std::nullopt;
    if (!along || !text.empty() || along->is_y == across->is_y)
      refuse("the size is \"" + words + "\", not as in -Y HEIGHT +X WIDTH",
             ErrorCode::kUnsupported);
    const Side& x = across->is_y ? *along : *across;
    const Side& y = across->is_y ? *across : *along;
    map_.width = x.count;
    map_.height = y.count;
    length_ = along->count;
    is_transposed_ = along->is_y;
    from_right_ = !x.is_ascending;
    from_below_ = y.is_ascending;
  }

  /// Where the map has the pixel `i` of a line.
  [[nodiscard]] std::size_t place_of(std::size_t line, std::size_t i) const {
    std::size_t x = is_transposed_ ? line : i, y = is_transposed_ ? i : line;
    if (from_right_) x = map_.width - 1 - x;
    if (from_below_) y = map_.height - 1 - y;
    return y * map_.width + x;
  }

  /// Two bytes encode a run of up to 127 in one channel, so eight bytes encode 127 pixels; in the
  /// old encoding, four bytes repeat 255 or more. A file with fewer than one byte per 16384 pixels
  /// is truncated or malicious.
  void check_length() const {
    const std::uint64_t pixels = std::uint64_t{map_.width} * map_.height;
    if (pixels > kMaxImagePixels)
      refuse("the image has more than 2^26 pixels", ErrorCode::kOutOfMemory);
    if (pixels / 16384 > rest_.size()) refuse("the file is too short for its size");
  }

  [[nodiscard]] std::string here() const {
    return (is_transposed_ ? "column " : "row ") + std::to_string(line_);
  }

  std::uint8_t byte() {
    if (rest_.empty()) refuse("the file ends within " + here());
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  Rgbe pixel() { return {byte(), byte(), byte(), byte()}; }

  void read_line(std::vector<Rgbe>& row) {
    if (row.size() >= 8 && row.size() < 32768 && rest_.size() >= 4 && rest_[0] == 2 &&
        rest_[1] == 2 && rest_[2] < 128) {
      const Rgbe head = pixel();
      if (static_cast<std::size_t>(head[2] << 8 | head[3]) != row.size())
        refuse(here() + " says that it has " + std::to_string(head[2] << 8 | head[3]) + " pixels");
      for (std::size_t channel = 0; channel < 4; ++channel) read_runs(row, channel);
    } else {
      read_old_line(row);
    }
  }

  /// A code above 128 repeats the next byte code - 128 times; otherwise so many literal bytes
  /// follow.
  void read_runs(std::vector<Rgbe>& row, std::size_t channel) {
    for (std::size_t x = 0; x < row.size();) {
      const std::uint8_t code = byte();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - x) refuse("a run leaves " + here());
      std::uint8_t value = run ? byte() : 0;
      for (std::size_t i = 0; i < count; ++i) row[x++][channel] = run ? value : (value = byte());
    }
  }

  /// Pixels one by one. (1, 1, 1, n) repeats the last pixel n times; directly after another such
  /// code, 256 n times.
  void read_old_line(std::vector<Rgbe>& row) {
    std::uint32_t shift = 0;
    for (std::size_t x = 0; x < row.size();) {
      const Rgbe next = pixel();
      if (next[0] != 1 || next[1] != 1 || next[2] != 1) {
        row[x++] = next;
        shift = 0;
        continue;
      }
      const std::size_t count = shift < 24 ? std::size_t{next[3]} << shift : row.size() + 1;
      if (x == 0 || count > row.size() - x) refuse("a run leaves " + here());
      for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
      shift += 8;
    }
  }

  [[nodiscard]] Vec3 radiance_of(const Rgbe& pixel) const {
    if (pixel[3] == 0) return {0, 0, 0};
    const double scale = std::ldexp(1 / exposure_, pixel[3] - 136);
    const auto value = [&](std::size_t i) {
      const double x = pixel[i] * scale;
      return x > std::numeric_limits<float>::max() ? std::numeric_limits<float>::infinity()
                                                   : static_cast<float>(x);
    };
    return {value(0), value(1), value(2)};
  }

  std::span<const std::uint8_t> rest_;
  const std::string& path_;
  Environment map_;
  double exposure_ = 1;
  std::size_t length_ = 0;  ///< of a line: a row, or a column if the image is transposed
  std::size_t line_ = 0;
  bool is_transposed_ = false, from_right_ = false, from_below_ = false;
};

}  // namespace

Environment decode_radiance_hdr(std::span<const std::uint8_t> file, const std::string& path) {
  return Reader(file, path).read();
}

}  // namespace raysheaf::io
