#include "integration/abi/report.hpp"

#include "integration/abi/sized_struct.hpp"

#include <memory>

namespace dermis::abi {
namespace {

dermis_severity severity_of(Severity severity) {
  switch (severity) {
  case Severity::note:
    return DERMIS_SEVERITY_NOTE;
  case Severity::warning:
    return DERMIS_SEVERITY_WARNING;
  case Severity::error:
    break;
  }
  return DERMIS_SEVERITY_ERROR;
}

} // namespace

dermis_message message_at(const dermis_report_t& report, size_t index) {
  const Diagnostics& all = report.diagnostics;
  const Diagnostic& one = all.list[index];
  const DiagnosticInfo& info = diagnostic_info(one.id);
  dermis_message message = DERMIS_MESSAGE_INIT;
  message.severity = severity_of(info.severity);
  message.code = static_cast<uint32_t>(one.id);
  message.code_name = info.name.data();
  const bool has_file = one.where.file.valid() && one.where.file.value < all.files.size();
  message.file = has_file ? all.files[one.where.file.value].name.c_str() : "";
  message.line = one.where.line;
  message.column = one.where.column;
  message.pointer = one.where.pointer.c_str();
  message.text = report.texts[index].c_str();
  message.hint = info.hint.data();
  return message;
}

dermis_result conclude(const Log& log, dermis_result result, Diagnostics&& diagnostics,
                       dermis_report* out) {
  auto report = std::make_unique<dermis_report_t>();
  report->diagnostics = std::move(diagnostics);
  const Diagnostics& all = report->diagnostics;
  std::string first_error;
  for (const Diagnostic& one : all.list) {
    report->texts.push_back(one.suggestion.empty() ? one.text : one.text + "; " + one.suggestion);
    report->text += format_for_people(all, one) + "\n";
    if (first_error.empty() && diagnostic_info(one.id).severity == Severity::error)
      first_error = format_for_people(all, one, false);
  }
  report->json = format_as_json(all);
  for (size_t i = 0; i < all.list.size(); ++i)
    send(log, message_at(*report, i));
  if (result < 0) remember_failure(first_error);
  if (out != nullptr) *out = report.release();
  return result;
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" uint32_t DERMIS_CALL dermis_report_count(dermis_report report) {
  return report == nullptr ? 0 : static_cast<uint32_t>(report->diagnostics.list.size());
}

extern "C" dermis_result DERMIS_CALL dermis_report_message(dermis_report report, uint32_t index,
                                                           dermis_message* message) {
  return guarded({}, "dermis_report_message", [&] {
    if (report == nullptr) return bad_argument({}, "dermis_report_message: report is NULL");
    if (message == nullptr) return bad_argument({}, "dermis_report_message: message is NULL");
    const size_t count = report->diagnostics.list.size();
    if (index >= count)
      return bad_argument({}, "dermis_report_message: index is {}, the report has {} messages",
                          index, count);
    const size_t size = stated_size(message);
    if (const SizedRead read = check_size<dermis_message>(size); read != SizedRead::ok)
      return rejected_size({}, read, "dermis_report_message: message", size,
                           sizeof(dermis_message));
    write_sized(message, size, message_at(*report, index));
    return DERMIS_OK;
  });
}

extern "C" const char* DERMIS_CALL dermis_report_text(dermis_report report) {
  return report == nullptr ? "" : report->text.c_str();
}

extern "C" const char* DERMIS_CALL dermis_report_json(dermis_report report) {
  return report == nullptr ? "[]" : report->json.c_str();
}

extern "C" void DERMIS_CALL dermis_report_destroy(dermis_report report) {
  delete report;
}
