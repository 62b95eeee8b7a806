#include "integration/tools/command/session.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/utf8.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <unistd.h>

namespace dermis::tools {

namespace {

bool output_lost = false; // some text could not be written to stdout

// `diagnostics`: a JSON array.
void print_failure(ExitCode code, std::string_view message, std::string_view diagnostics) {
  JsonWriter answer;
  answer.open_object().member("ok", false).member("exit_code", static_cast<int32_t>(code));
  answer.member("error", message).key("diagnostics").json(diagnostics).close();
  print(std::move(answer).finish());
}

} // namespace

std::string for_terminal(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const size_t end = std::min(text.find_first_of("\n\t"), text.size());
    append_printable(out, text.substr(0, end), end);
    out += text.substr(end, 1);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

ExitCode fail(const Session& session, ExitCode code, std::string_view message,
              const Diagnostics* diagnostics) {
  if (diagnostics != nullptr) print_diagnostics(session, *diagnostics);
  if (session.json)
    print_failure(code, message, diagnostics != nullptr ? format_as_json(*diagnostics) : "[]");
  else
    spdlog::error("{}", for_terminal(message));
  return code;
}

ExitCode fail(const Session& session, const demo::Error& error, const Diagnostics* diagnostics) {
  const auto code = static_cast<ExitCode>(error.kind);
  const bool of_library = diagnostics == nullptr && !error.diagnostics.empty();
  if (!session.json || !of_library) return fail(session, code, error.text, diagnostics);
  print_failure(code, std::string_view(error.text).substr(0, error.text.find('\n')),
                error.diagnostics);
  return code;
}

void print_diagnostics(const Session& session, const Diagnostics& diagnostics) {
  if (!session.json) print_beside_document(session, diagnostics);
}

void print_beside_document(const Session& session, const Diagnostics& diagnostics) {
  const bool color = use_color(session.color, STDERR_FILENO);
  for (const Diagnostic& one : diagnostics.list) {
    if (session.quiet && diagnostic_info(one.id).severity != Severity::error) continue;
    const std::string text = format_for_people(diagnostics, one);
    print_message((color ? color_diagnostic(text) : text) + "\n");
  }
}

void say(const Session& session, std::string_view text) {
  if (!session.json && !session.quiet) print(for_terminal(text));
}

void print_message(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void print(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (std::fflush(stdout) != 0 || !written) output_lost = true;
}

bool is_output_lost() {
  return output_lost;
}

} // namespace dermis::tools
