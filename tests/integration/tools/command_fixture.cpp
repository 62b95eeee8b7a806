#include "tests/integration/tools/command_fixture.hpp"

#include "framegraph/text/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace dermis::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

void redirect(int target, const fs::path& path, int flags) {
  const int file = open(path.c_str(), flags, 0600);
  if (file < 0 || dup2(file, target) < 0) _exit(127);
}

[[noreturn]] void become_command(const std::vector<std::string>& arguments,
                                 const RunOptions& options, const TestFolder& streams) {
  redirect(STDIN_FILENO, streams / "in", O_RDONLY);
  redirect(STDOUT_FILENO, options.output.empty() ? streams / "out" : fs::path(options.output),
           O_WRONLY | O_CREAT);
  redirect(STDERR_FILENO, streams / "err", O_WRONLY | O_CREAT);
  for (const std::string& one : options.environment)
    setenv(one.substr(0, one.find('=')).c_str(), one.substr(one.find('=') + 1).c_str(), 1);
  std::vector<std::string> words{DERMIS_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  if (chdir(DERMIS_SOURCE_DIR) == 0) execv(DERMIS_COMMAND, pointers.data());
  _exit(127);
}

} // namespace

void PrintTo(const Outcome& outcome, std::ostream* stream) {
  *stream << fmt::format("exit code {}\n{}\n{}", outcome.exit_code, outcome.out, outcome.err);
}

Outcome CommandTest::run(const std::vector<std::string>& arguments, const RunOptions& options) {
  const TestFolder streams;
  std::ofstream(streams / "in", std::ios::binary) << options.input;
  const pid_t child = fork();
  if (child == 0) become_command(arguments, options, streams);
  Outcome outcome;
  int status = 0;
  if (!options.interrupt_after.empty()) {
    while (!fs::exists(options.interrupt_after) && waitpid(child, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(5ms);
    kill(child, SIGINT);
  }
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(streams / "out");
  outcome.err = read_text(streams / "err");
  return outcome;
}

std::string CommandTest::read(const std::string& name) const {
  return read_text(path(name));
}

std::string CommandTest::write(const std::string& name, const std::string& text) const {
  fs::create_directories((folder_ / name).parent_path());
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return path(name);
}

std::vector<std::string> CommandTest::files(const std::string& below) const {
  std::vector<std::string> names;
  const fs::path root = below.empty() ? folder_.path() : folder_ / below;
  if (!fs::exists(root)) return names;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    names.push_back(fs::relative(entry.path(), root).string());
  std::sort(names.begin(), names.end());
  return names;
}

void CommandTest::expect_equal_pictures(const std::string& a, const std::string& b) const {
  size_t pictures = 0;
  for (const std::string& file : files(a)) {
    if (!file.ends_with(".exr")) continue;
    EXPECT_TRUE(read(a + "/" + file) == read(b + "/" + file))
        << file << " differs in " << a << " and " << b;
    ++pictures;
  }
  EXPECT_GT(pictures, 0u);
}

std::string CommandTest::copy_shaders() const {
  fs::copy("shaders", folder_ / "shaders", fs::copy_options::recursive);
  return path("shaders");
}

bool CommandTest::has_shader_compiler() {
  return run({"doctor", "--json"}).out.find("\"shader_compiler\": \"\"") == std::string::npos;
}

std::vector<std::string> validation_environment() {
  return {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation",
          "VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
          "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT"};
}

std::vector<std::string> verbs_of_help(const std::string& help) {
  std::vector<std::string> verbs;
  std::istringstream lines(help);
  bool listed = false;
  for (std::string line; std::getline(lines, line);) {
    if (listed && line.empty()) break;
    if (listed && line.starts_with("  ") && line[2] != ' ')
      verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
    listed = listed || line.starts_with("Subcommands");
  }
  return verbs;
}

bool is_json(const std::string& text) {
  Diagnostics diagnostics;
  return parse_document("answer", text, diagnostics).has_value();
}

} // namespace dermis::test
