#pragma once
// Errors of the demo engine are values: a text that says what is wrong, why and what to do, and a
// kind.

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace demo {

// The numbers are the exit codes of the command.
enum class ErrorKind : int {
  input = 1,       // a file or its data is wrong
  usage = 2,       // an option or a value is wrong
  environment = 3, // no driver, not enough memory, failed writes
  internal = 4,    // a defect of this program
};

struct Error {
  ErrorKind kind = ErrorKind::internal;
  std::string text;
  std::string diagnostics = {}; // of Dermis, which `text` contains: a JSON array; "": none
};

struct Nothing {};

// Either a value or an Error. Reading the wrong alternative is a defect of the caller: std::get
// throws, nothing catches the exception, and the program terminates.
template <class T = Nothing> class [[nodiscard]] Result {
public:
  Result(T value) : content(std::move(value)) {}
  Result(Error error) : content(std::move(error)) {}
  explicit operator bool() const { return content.index() == 0; }
  T& operator*() { return std::get<0>(content); }
  const T& operator*() const { return std::get<0>(content); }
  T* operator->() { return &std::get<0>(content); }
  const T* operator->() const { return &std::get<0>(content); }
  const Error& error() const { return std::get<1>(content); }
  T take() { return std::move(std::get<0>(content)); }

private:
  std::variant<T, Error> content;
};

inline Result<> success() {
  return Nothing{};
}

} // namespace demo
