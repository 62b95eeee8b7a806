// The dermis command: reads the command line, runs one verb and returns its exit code.

#include "integration/tools/command/arguments/arguments.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <unistd.h>

namespace {

using namespace dermis::tools;

// Sends log lines to stderr, so that stdout holds only results.
void set_up_log(const Session& session) {
  auto log = spdlog::stderr_color_st("dermis", use_color(session.color, STDERR_FILENO)
                                                   ? spdlog::color_mode::always
                                                   : spdlog::color_mode::never);
  log->set_pattern("%n: %^%l%$: %v");
  log->set_level(session.quiet  ? spdlog::level::err
                 : session.json ? spdlog::level::warn
                                : spdlog::level::info);
  spdlog::set_default_logger(log);
}

ExitCode run(int argc, char** argv) {
  const Invocation invocation = read_arguments(argc, argv);
  set_up_log(invocation.session);
  if (!invocation.message.empty())
    return fail(invocation.session, ExitCode::usage, invocation.message);
  if (!invocation.help.empty()) {
    print(invocation.help);
    return ExitCode::ok;
  }
  listen_for_interrupts();
  return invocation.run(invocation.session);
}

} // namespace

int main(int argc, char** argv) {
  try {
    const ExitCode code = run(argc, argv);
    if (code == ExitCode::ok && is_output_lost()) {
      spdlog::error("the result cannot be written to standard output");
      return static_cast<int>(ExitCode::environment);
    }
    return static_cast<int>(code);
  } catch (const std::bad_alloc&) {
    return static_cast<int>(fail({}, ExitCode::environment, "out of memory"));
  } catch (const std::exception& error) {
    return static_cast<int>(
        fail({}, ExitCode::internal,
             std::string("a defect of the program, please report it: ") + error.what()));
  } catch (...) {
    return static_cast<int>(
        fail({}, ExitCode::internal, "a defect of the program, please report it"));
  }
}
