#include "app/terminal/standard_files.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "talus/failure.hpp"

namespace talus::app {

void secure_standard_files() {
  // Opened the wrong way round: to use a closed file still fails.
  constexpr std::array kWays{O_WRONLY, O_RDONLY, O_RDONLY};
  for (int file = 0; file < 3; ++file) {
    // The lowest number that is free is the one that is closed.
    if (::fcntl(file, F_GETFD) == -1 && errno == EBADF)
      static_cast<void>(::open("/dev/null", kWays[static_cast<std::size_t>(file)]));
  }
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));
}

std::size_t read_standard_input(std::span<std::byte> room) {
  for (;;) {
    const ssize_t count = ::read(STDIN_FILENO, room.data(), room.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) throw Failure(Cause::io, fmt::format("cannot read standard input: {}", std::strerror(errno)));
  }
}

}  // namespace talus::app
