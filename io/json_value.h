// JSON as a read-only tree. It lies in one arena: destroying the tree neither visits its values nor
// allocates, so it cannot fail.
#pragma once

#include <concepts>
#include <cstdint>
#include <exception>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace raysheaf::io {

inline constexpr int kMaxJsonDepth = 64;

struct JsonMember;

/// A value has another type than the caller asks for. Validated JSON never throws it.
struct JsonMismatch : std::exception {
  [[nodiscard]] const char* what() const noexcept override {
    return "a field of its JSON is missing or has the wrong type";
  }
};

/// A handle that is cheap to copy and valid as long as its document.
class JsonValue {
 public:
  struct Items {
    const JsonValue* first;
    std::size_t count;
  };
  struct Members {
    const JsonMember* first;
    std::size_t count;
  };
  /// Null or one of these types. Negative integers are signed, all others unsigned.
  using Content = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double,
                               std::string_view, Items, Members>;

  JsonValue() = default;
  explicit JsonValue(Content content) : content_(content) {}

  [[nodiscard]] bool is_null() const { return is<std::monostate>(); }
  [[nodiscard]] bool is_boolean() const { return is<bool>(); }
  [[nodiscard]] bool is_integer() const { return is<std::int64_t>() || is<std::uint64_t>(); }
  [[nodiscard]] bool is_number() const { return is_integer() || is<double>(); }
  [[nodiscard]] bool is_string() const { return is<std::string_view>(); }
  [[nodiscard]] bool is_array() const { return is<Items>(); }
  [[nodiscard]] bool is_object() const { return is<Members>(); }

  /// The elements of an array; empty for other types.
  [[nodiscard]] std::span<const JsonValue> items() const;
  /// The members of an object, sorted by name, each name once (the last of equal names counts);
  /// empty for other types.
  [[nodiscard]] std::span<const JsonMember> members() const;
  /// The value of a member, found in logarithmic time; nullptr if there is none or this is not an
  /// object.
  [[nodiscard]] const JsonValue* find(std::string_view name) const;
  [[nodiscard]] bool contains(std::string_view name) const { return find(name) != nullptr; }

  /// The value as a bool, std::string, std::string_view, or a number that T can hold (rounded if T
  /// is a floating-point type). Throws `JsonMismatch`, as `at` does.
  template <class T>
  [[nodiscard]] T get() const;
  [[nodiscard]] const JsonValue& at(std::string_view name) const;
  [[nodiscard]] const JsonValue& at(std::size_t index) const;

  /// The digits of an integer.
  [[nodiscard]] std::string digits() const;

  /// The value of an optional member.
  template <class T>
  [[nodiscard]] T get(std::string_view name, T otherwise) const {
    const JsonValue* member = find(name);
    return member == nullptr ? otherwise : member->get<T>();
  }
  [[nodiscard]] std::span<const JsonValue> items(std::string_view name) const {
    const JsonValue* member = find(name);
    return member == nullptr ? std::span<const JsonValue>{} : member->items();
  }

 private:
  template <class T>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<T>(content_);
  }
  template <class T>
  [[nodiscard]] const T& as() const {
    if (const T* content = std::get_if<T>(&content_)) return *content;
    throw JsonMismatch();
  }
  [[nodiscard]] double number() const;

  Content content_;
};

struct JsonMember {
  std::string_view name;
  JsonValue value;
};

class JsonDocument {
 public:
  /// Throws `Error` (kInvalidData, place `JSON`) if the text is not JSON or is nested too deeply.
  explicit JsonDocument(std::span<const std::uint8_t> text);
  [[nodiscard]] const JsonValue& root() const { return root_; }

 private:
  std::unique_ptr<std::pmr::monotonic_buffer_resource> memory_;
  JsonValue root_;
};

inline std::span<const JsonValue> JsonValue::items() const {
  const Items* items = std::get_if<Items>(&content_);
  return items == nullptr ? std::span<const JsonValue>{} : std::span(items->first, items->count);
}

inline std::span<const JsonMember> JsonValue::members() const {
  const Members* all = std::get_if<Members>(&content_);
  return all == nullptr ? std::span<const JsonMember>{} : std::span(all->first, all->count);
}

template <class T>
T JsonValue::get() const {
  if constexpr (std::same_as<T, bool>) {
    return as<bool>();
  } else if constexpr (std::same_as<T, std::string>) {
    return std::string(as<std::string_view>());
  } else if constexpr (std::same_as<T, std::string_view>) {
    return as<std::string_view>();
  } else if constexpr (std::floating_point<T>) {
    return static_cast<T>(number());
  } else {
    if (const auto* below_zero = std::get_if<std::int64_t>(&content_)) {
      if (!std::in_range<T>(*below_zero)) throw JsonMismatch();
      return static_cast<T>(*below_zero);
    }
    const std::uint64_t whole = as<std::uint64_t>();
    if (!std::in_range<T>(whole)) throw JsonMismatch();
    return static_cast<T>(whole);
  }
}

}  // namespace raysheaf::io
