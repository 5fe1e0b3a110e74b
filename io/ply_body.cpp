#include "io/ply_body.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>

#include "io/text_lines.h"
#include "io/utf8.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{1} << 20;

template <class T>
double load(const std::uint8_t* bytes, bool swapped) {
  std::uint8_t raw[sizeof(T)];
  std::memcpy(raw, bytes, sizeof raw);
  if (swapped) std::reverse(raw, raw + sizeof raw);
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

double load(PlyType type, const std::uint8_t* bytes, bool swapped) {
  switch (type) {
    case PlyType::kInt8:
      return load<std::int8_t>(bytes, swapped);
    case PlyType::kUint8:
      return load<std::uint8_t>(bytes, swapped);
    case PlyType::kInt16:
      return load<std::int16_t>(bytes, swapped);
    case PlyType::kUint16:
      return load<std::uint16_t>(bytes, swapped);
    case PlyType::kInt32:
      return load<std::int32_t>(bytes, swapped);
    case PlyType::kUint32:
      return load<std::uint32_t>(bytes, swapped);
    case PlyType::kFloat32:
      return load<float>(bytes, swapped);
    default:
      return load<double>(bytes, swapped);
  }
}

}  // namespace

void PlyNumbers::refuse(const std::string& sentence, const std::string& element,
                        std::uint64_t index) const {
  throw Error(ErrorCode::kInvalidData, sentence,
              printable(element) + "[" + std::to_string(index) + "]");
}

bool PlyNumbers::has(std::size_t count) {
  if (bytes_.size() - at_ >= count) return true;
  if (file_ == nullptr) return false;
  const std::size_t kept = bytes_.size() - at_;
  const std::size_t more = std::min<std::uint64_t>(kWindowBytes - kept, file_->size() - end_);
  if (window_.empty()) window_.resize(kWindowBytes);
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), bytes_.end(), window_.begin());
  file_->read(end_, std::span(window_).subspan(kept, more), "");
  bytes_ = std::span(window_).first(kept + more);
  at_ = 0;
  end_ += more;
  return bytes_.size() >= count;
}

std::uint64_t PlyNumbers::bytes_left() const {
  return bytes_.size() - at_ + (file_ == nullptr ? 0 : file_->size() - end_);
}

double PlyNumbers::next(PlyType type, const std::string& element, std::uint64_t index) {
  if (format_ == PlyFormat::kAscii) return next_word(element, index);
  const std::size_t size = size_of(type);
  if (!has(size)) refuse("the file is truncated: it ends here", element, index);
  const bool native =
      (format_ == PlyFormat::kLittleEndian) == (std::endian::native == std::endian::little);
  const double value = load(type, bytes_.data() + at_, !native);
  at_ += size;
  return value;
}

double PlyNumbers::next_word(const std::string& element, std::uint64_t index) {
  while (at_ < bytes_.size() && std::isspace(bytes_[at_]) != 0) ++at_;
  std::size_t end = at_;
  while (end < bytes_.size() && std::isspace(bytes_[end]) == 0) ++end;
  if (end == at_) refuse("the file is truncated: it ends here", element, index);
  const std::string_view word(reinterpret_cast<const char*>(bytes_.data()) + at_, end - at_);
  const std::optional<double> value = read_number(word, &has_commas_);
  if (!value) refuse(in_quotes(word) + " is not a number", element, index);
  at_ = end;
  return *value;
}

std::uint64_t PlyNumbers::next_count(const PlyProperty& list, const std::string& element,
                                     std::uint64_t index) {
  const double count = next(list.count_type, element, index);
  const std::size_t least = format_ == PlyFormat::kAscii ? 1 : size_of(list.type);
  // The order of the tests matters: a count that the file can hold is safe to convert.
  if (!(count >= 0) || count * static_cast<double>(least) > static_cast<double>(bytes_left()) ||
      count != static_cast<double>(static_cast<std::uint64_t>(count))) {
    refuse("the list \"" + printable(list.name) + "\" has a count that the file cannot hold",
           element, index);
  }
  return static_cast<std::uint64_t>(count);
}

void PlyNumbers::skip(const PlyProperty& property, const std::string& element,
                      std::uint64_t index) {
  const std::uint64_t count = property.is_list ? next_count(property, element, index) : 1;
  for (std::uint64_t i = 0; i < count; ++i) static_cast<void>(next(property.type, element, index));
}

}  // namespace raysheaf::io
