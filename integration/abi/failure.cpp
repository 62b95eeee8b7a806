#include "integration/abi/failure.hpp"

#include <algorithm>
#include <cstring>

namespace dermis::abi {
namespace {

struct LastError {
  bool set = false;
  char text[failure_text_size + 1] = {};
};

// Per thread, because dermis_last_error only reports failures of the calling thread.
constinit thread_local LastError last_error;

} // namespace

void send(const Log& log, const dermis_message& message) noexcept {
  if (log.function == nullptr) return;
  try {
    log.function(log.user, &message);
  } catch (...) {
    // A C++ host may throw from its callback; the failure being reported matters more.
  }
}

void remember_failure(std::string_view text) noexcept {
  const size_t length = std::min(text.size(), failure_text_size);
  std::memcpy(last_error.text, text.data(), length);
  last_error.text[length] = 0;
  last_error.set = true;
}

dermis_result fail_with(const Log& log, dermis_result result, DiagnosticId id,
                        std::string_view text) noexcept {
  remember_failure(text);
  const DiagnosticInfo& info = diagnostic_info(id);
  dermis_message message = DERMIS_MESSAGE_INIT;
  message.severity = DERMIS_SEVERITY_ERROR;
  message.code = static_cast<uint32_t>(id);
  message.code_name = info.name.data();
  message.file = "";
  message.pointer = "";
  message.text = last_error.text;
  message.hint = info.hint.data();
  send(log, message);
  return result;
}

} // namespace dermis::abi

extern "C" const char* DERMIS_CALL dermis_last_error(void) {
  return dermis::abi::last_error.set ? dermis::abi::last_error.text : nullptr;
}
