#include "integration/tools/command/child.hpp"

#include "integration/tools/command/interrupt.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;

namespace dermis::tools {
namespace {

constexpr auto nap = std::chrono::milliseconds(20);

std::string everything_in(std::FILE* file) {
  std::string text;
  char block[4096];
  std::rewind(file);
  for (size_t got = 1; got > 0;) {
    got = std::fread(block, 1, sizeof block, file);
    text.append(block, got);
  }
  return text;
}

} // namespace

std::optional<ChildAnswer> run_child(const std::vector<std::string>& words, std::string& problem) {
  std::FILE* out = std::tmpfile(); // a pipe would need to be drained while the child runs
  if (out == nullptr) {
    problem = fmt::format("cannot make a temporary file: {}", std::strerror(errno));
    return std::nullopt;
  }
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& one : copies)
    arguments.push_back(one.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, copies.front().c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    problem = fmt::format("cannot run '{}': {}", words.front(), std::strerror(failed));
    std::fclose(out);
    return std::nullopt;
  }
  int status = 0;
  bool requested = false;
  pid_t ended = 0;
  while ((ended = waitpid(child, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
    if (interrupted() && !requested) requested = kill(child, SIGINT) == 0;
    std::this_thread::sleep_for(nap);
  }
  if (ended < 0) { // the parent process ignores SIGCHLD
    problem =
        fmt::format("the exit code of '{}' is unknown: {}", words.front(), std::strerror(errno));
    std::fclose(out);
    return std::nullopt;
  }
  ChildAnswer answer;
  answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  answer.out = everything_in(out);
  std::fclose(out);
  return answer;
}

} // namespace dermis::tools
