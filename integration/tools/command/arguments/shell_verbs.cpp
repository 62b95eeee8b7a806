// Verbs that describe the command line to shells and readers.
#include "integration/tools/command/arguments/add_verb.hpp"
#include "integration/tools/command/arguments/declared.hpp"
#include "integration/tools/command/output.hpp"

#include <dermis/dermis.h>

namespace dermis::tools {
namespace {

struct ShellOptions {
  std::string shell, out = "-";
};

// `text` runs after parsing, when all verbs are declared.
void add_text_verb(CLI::App& app, Invocation& invocation, const char* name, const char* what,
                   const char* example, bool of_shell,
                   std::function<std::string(const std::string& shell)> text) {
  CLI::App& verb = *app.add_subcommand(name, what);
  verb.footer(fmt::format("Example:\n  {}", example));
  auto options = std::make_shared<ShellOptions>();
  add_common(verb, invocation.session, true);
  if (of_shell)
    verb.add_option("shell", options->shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}))
        ->type_name("SHELL");
  verb.add_option("--out,-o", options->out, "File to write, - for standard output [-]")
      ->type_name("FILE");
  verb.callback([&invocation, options, text = std::move(text)] {
    invocation.run = [options, made = text(options->shell)](const Session& session) {
      const std::string problem = deliver_text(options->out, made);
      return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
    };
  });
}

} // namespace

void add_shell_verbs(CLI::App& app, Invocation& invocation) {
  add_text_verb(app, invocation, "completion", "Write a completion script for a shell",
                "source <(dermis completion bash)", true,
                [&app, &invocation](const std::string& shell) {
                  return completion_script(declared_verbs(app, invocation.offered), shell);
                });
  add_text_verb(app, invocation, "man", "Write the manual page",
                "dermis man --out dermis.1 && man ./dermis.1", false,
                [&app, &invocation](const std::string&) {
                  return manual_page(declared_verbs(app, invocation.offered),
                                     fmt::format("{}.{}.{}", DERMIS_VERSION_MAJOR,
                                                 DERMIS_VERSION_MINOR, DERMIS_VERSION_PATCH));
                });
}

} // namespace dermis::tools
