#include "app/terminal/standard_files.hpp"

#include <array>
#include <cerrno>
#include <csignal>

#include <fcntl.h>
#include <unistd.h>

namespace talus::app {

void secure_standard_files() {
  // The wrong way round: reading from what was closed, or writing to it, fails as it would have.
  constexpr std::array kWays{O_WRONLY, O_RDONLY, O_RDONLY};
  for (int file = 0; file < 3; ++file) {
    // The lowest number that is free is the one that is closed.
    if (::fcntl(file, F_GETFD) == -1 && errno == EBADF)
      static_cast<void>(::open("/dev/null", kWays[static_cast<std::size_t>(file)]));
  }
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));
}

}  // namespace talus::app
