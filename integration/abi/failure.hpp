#pragma once
// Reports failures: returns a result, stores the text as the thread's last error and sends it to
// the log. Nothing here allocates, so that out-of-memory can be reported; no exception leaves
// `guarded`.

#include "framegraph/text/diagnostic.hpp"
#include "integration/abi/memory/host_memory.hpp"
#include "integration/abi/sized_struct.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace dermis::abi {

struct Log {
  dermis_log_fn function = nullptr;
  void* user = nullptr;
  HostAllocator memory{}; // allocator of the calls that use this log
};

inline constexpr size_t failure_text_size = 2048; // longer texts are cut

// Calls the host and ignores exceptions of its callback. Thread: any.
void send(const Log& log, const dermis_message& message) noexcept;

// Stores `text` as the thread's last error, cut at failure_text_size.
void remember_failure(std::string_view text) noexcept;

// Stores `text` as the thread's last error and logs it. Returns `result`.
dermis_result fail_with(const Log& log, dermis_result result, DiagnosticId id,
                        std::string_view text) noexcept;

template <class... Arguments>
dermis_result fail(const Log& log, dermis_result result, DiagnosticId id,
                   fmt::format_string<Arguments...> format, Arguments&&... arguments) noexcept {
  std::array<char, failure_text_size> buffer;
  try {
    const auto written = fmt::format_to_n(buffer.data(), buffer.size(), format,
                                          std::forward<Arguments>(arguments)...);
    return fail_with(log, result, id, {buffer.data(), std::min(written.size, buffer.size())});
  } catch (...) {
    return fail_with(log, result, id, "the message could not be formatted");
  }
}

template <class... Arguments>
dermis_result bad_argument(const Log& log, fmt::format_string<Arguments...> format,
                           Arguments&&... arguments) noexcept {
  return fail(log, DERMIS_ERROR_ARGUMENT, DiagnosticId::host_argument, format,
              std::forward<Arguments>(arguments)...);
}

// Converts a rejected struct_size into its result. `what` names the function and the struct.
inline dermis_result rejected_size(const Log& log, SizedRead why, std::string_view what,
                                   size_t stated, size_t minimum) noexcept {
  if (why == SizedRead::unknown_fields)
    return fail(log, DERMIS_ERROR_VERSION, DiagnosticId::host_struct_version,
                "{}: struct_size is {} and fields beyond those this library knows are not zero",
                what, stated);
  return bad_argument(log, "{}.struct_size is {}, expected {}..{}: use the struct's INIT macro",
                      what, stated, minimum, largest_struct_size);
}

inline dermis_result rejected_size(const Log& log, SizedRead why, const char* function,
                                   const char* argument, size_t stated, size_t minimum) {
  return rejected_size(log, why, fmt::format("{}: {}", function, argument), stated, minimum);
}

// Rejects what read_element did not accept. `array`: its name. Allocates nothing.
template <class T>
dermis_result rejected_element(const Log& log, SizedRead why, const char* function,
                               const char* array, const T* items, uint32_t i) noexcept {
  const size_t stated = stated_size(element(items, i)), first = stated_size(items);
  if (stated != first)
    return bad_argument(log, "{}: {}[{}].struct_size is {}, expected {} as in {}[0]", function,
                        array, i, stated, first, array);
  if (why == SizedRead::unknown_fields)
    return fail(log, DERMIS_ERROR_VERSION, DiagnosticId::host_struct_version,
                "{}: {}[{}] has fields beyond those this library knows that are not zero", function,
                array, i);
  return bad_argument(log, "{}: {}[{}].struct_size is {}, expected {}..{}: use its INIT macro",
                      function, array, i, stated, sizeof(T), largest_struct_size);
}

// Runs the body of an exported function with the host's allocator. Converts every exception, e.g.
// of the standard library or fmt, into a result.
template <class Body>
dermis_result guarded(const Log& log, const char* function, Body&& body) noexcept {
  const MemoryScope memory(log.memory);
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return fail(log, DERMIS_ERROR_MEMORY, DiagnosticId::host_memory, "{}: out of host memory",
                function);
  } catch (const std::length_error&) {
    return fail(log, DERMIS_ERROR_MEMORY, DiagnosticId::host_memory,
                "{}: a size is beyond the host's memory", function);
  } catch (const std::exception& exception) {
    return fail(log, DERMIS_ERROR_INTERNAL, DiagnosticId::internal_defect, "{}: {}", function,
                exception.what());
  } catch (...) {
    return fail(log, DERMIS_ERROR_INTERNAL, DiagnosticId::internal_defect, "{}: unknown exception",
                function);
  }
}

} // namespace dermis::abi
