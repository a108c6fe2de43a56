#include "tests/support/program.hpp"

#include <array>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace talus::support {
namespace {

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
};

[[noreturn]] void become(const std::vector<std::string>& arguments, const RunOptions& options, int out, int err) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  dup2(open(options.input.empty() ? "/dev/null" : options.input.c_str(), O_RDONLY), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (options.folder.empty() || chdir(options.folder.c_str()) == 0) execvp(words[0], words.data());
  _exit(127);
}

/// Appends what is there; false at the end.
bool drain(int end, std::string& text) {
  std::array<char, 65536> buffer;
  const auto got = read(end, buffer.data(), buffer.size());
  if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
  return got > 0;
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments, const RunOptions& options) {
  Pipe out, err;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) become(arguments, options, out.ends[1], err.ends[1]);
  out.close_end(1);
  err.close_end(1);

  using Clock = std::chrono::steady_clock;
  const auto limit = Clock::now() + options.kill_after.value_or(kPatience * options.at_most);
  Outcome outcome;
  bool killed = false;
  std::array<pollfd, 2> waiting{pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(limit - Clock::now()).count();
    if (left <= 0 && !killed) killed = kill(child, SIGKILL) == 0;
    poll(waiting.data(), 2, killed ? -1 : static_cast<int>(left + 1));
    if (waiting[0].fd >= 0 && waiting[0].revents != 0 && !drain(waiting[0].fd, outcome.out)) waiting[0].fd = -1;
    if (waiting[1].fd >= 0 && waiting[1].revents != 0 && !drain(waiting[1].fd, outcome.err)) waiting[1].fd = -1;
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  return outcome;
}

}  // namespace talus::support
