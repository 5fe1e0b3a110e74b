#include "io/json_value.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "io/gltf_rules.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// A whole number is stored as an integer, whether it is written 1, 1.0 or 1e0. -0.0 stays a double
/// to keep its sign.
JsonValue whole_or_not(double value) {
  constexpr double kMost = 0x1p53;
  if (!(std::fabs(value) <= kMost) || std::trunc(value) != value ||
      (value == 0 && std::signbit(value)))
    return JsonValue(value);
  if (value < 0) return JsonValue(static_cast<std::int64_t>(value));
  return JsonValue(static_cast<std::uint64_t>(value));
}

/// Builds the tree from the events of nlohmann-json's parser. The elements of all open arrays and
/// objects lie on one stack; when one closes, its elements move into the arena.
class TreeBuilder {
 public:
  explicit TreeBuilder(std::pmr::monotonic_buffer_resource& memory) : memory_(memory) {}
  [[nodiscard]] const JsonValue& root() const { return stack_.front().value; }

  bool null() { return add({}); }
  bool boolean(bool value) { return add(JsonValue(value)); }
  bool number_integer(std::int64_t value) { return add(JsonValue(value)); }
  bool number_unsigned(std::uint64_t value) { return add(JsonValue(value)); }
  bool number_float(double value, const std::string&) { return add(whole_or_not(value)); }
  bool string(const std::string& value) { return add(JsonValue(kept(value))); }
  bool binary(const nlohmann::json::binary_t&) { return false; }  // JSON text has no binary values
  bool key(const std::string& name) {
    name_ = kept(name);
    return true;
  }
  bool start_array(std::size_t) { return open(); }
  bool start_object(std::size_t) { return open(); }

  bool end_array() {
    const std::span<const JsonMember> parts = open_parts();
    JsonValue* first = allocate<JsonValue>(parts.size());
    std::transform(parts.begin(), parts.end(), first, [](const auto& part) { return part.value; });
    return close(JsonValue(JsonValue::Items{first, parts.size()}));
  }

  bool end_object() {
    const std::span<JsonMember> parts = open_parts();
    std::stable_sort(parts.begin(), parts.end(), by_name);
    JsonMember* first = allocate<JsonMember>(parts.size());
    std::size_t count = 0;
    for (const JsonMember& part : parts) {
      const bool again = count > 0 && first[count - 1].name == part.name;
      first[again ? count - 1 : count++] = part;
    }
    return close(JsonValue(JsonValue::Members{first, count}));
  }

  [[noreturn]] static bool parse_error(std::size_t, const std::string&,
                                       const nlohmann::json::exception& error) {
    // The library's message follows its identifier in brackets and quotes the last token.
    constexpr std::size_t kMostWords = 300;
    const std::string_view what = error.what();
    const std::size_t start = what.find("] ");
    refuse(printable(std::string(what.substr(start == what.npos ? 0 : start + 2)), kMostWords),
           "JSON");
  }

 private:
  static bool by_name(const JsonMember& a, const JsonMember& b) { return a.name < b.name; }

  template <class T>
  [[nodiscard]] T* allocate(std::size_t count) {
    T* first = static_cast<T*>(memory_.allocate(count * sizeof(T), alignof(T)));
    std::uninitialized_default_construct_n(first, count);
    return first;
  }
  [[nodiscard]] std::string_view kept(const std::string& text) {
    char* copy = static_cast<char*>(memory_.allocate(text.size(), 1));
    std::copy(text.begin(), text.end(), copy);
    return {copy, text.size()};
  }

  bool add(const JsonValue& value) {
    stack_.push_back({name_, value});
    return true;
  }
  bool open() {
    if (opened_.size() == std::size_t{kMaxJsonDepth}) refuse("is nested more than 64 deep", "JSON");
    add({});
    opened_.push_back(stack_.size());
    return true;
  }
  [[nodiscard]] std::span<JsonMember> open_parts() {
    return std::span(stack_).subspan(opened_.back());
  }
  bool close(const JsonValue& value) {
    stack_.resize(opened_.back());
    opened_.pop_back();
    stack_.back().value = value;
    return true;
  }

  std::pmr::monotonic_buffer_resource& memory_;
  std::vector<JsonMember> stack_;
  std::vector<std::size_t> opened_;  ///< where the elements of each open value begin
  std::string_view name_;
};

}  // namespace

JsonDocument::JsonDocument(std::span<const std::uint8_t> text)
    : memory_(std::make_unique<std::pmr::monotonic_buffer_resource>()) {
  TreeBuilder builder(*memory_);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  root_ = builder.root();
}

const JsonValue* JsonValue::find(std::string_view name) const {
  const auto all = members();
  const auto place = std::lower_bound(all.begin(), all.end(), name,
                                      [](const JsonMember& m, auto n) { return m.name < n; });
  return place == all.end() || place->name != name ? nullptr : &place->value;
}

const JsonValue& JsonValue::at(std::string_view name) const {
  if (const JsonValue* member = find(name)) return *member;
  throw JsonMismatch();
}

const JsonValue& JsonValue::at(std::size_t index) const {
  if (index >= items().size()) throw JsonMismatch();
  return items()[index];
}

std::string JsonValue::digits() const {
  if (const auto* whole = std::get_if<std::int64_t>(&content_)) return std::to_string(*whole);
  return std::to_string(as<std::uint64_t>());
}

double JsonValue::number() const {
  if (const auto* whole = std::get_if<std::uint64_t>(&content_)) return static_cast<double>(*whole);
  if (const auto* whole = std::get_if<std::int64_t>(&content_)) return static_cast<double>(*whole);
  return as<double>();
}

}  // namespace raysheaf::io
