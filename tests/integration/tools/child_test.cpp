#include "integration/tools/command/child.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace dermis::tools {
namespace {

TEST(Child, ExitCodeAndOutputAreReturned) {
  std::string problem;
  const auto answer = run_child({"sh", "-c", "echo text; exit 3"}, problem);
  ASSERT_TRUE(answer) << problem;
  EXPECT_EQ(answer->exit_code, 3);
  EXPECT_EQ(answer->out, "text\n");
}

// As if started by a program that ignores the signal.
TEST(Child, UnknownExitCode_IsAProblem) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  std::string problem;
  EXPECT_FALSE(run_child({"false"}, problem));
  EXPECT_NE(problem.find("'false' is unknown"), std::string::npos) << problem;
  std::signal(SIGCHLD, before);
}

} // namespace
} // namespace dermis::tools
