// A file that becomes shorter while it is read. Each test asks in a process of its own, which a signal may end.

#include "storage/map_guard.hpp"

#include <atomic>
#include <chrono>
#include <csetjmp>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "talus/talus.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

/// What a process ends with: its exit code, or minus the signal that ended it.
int end_of(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    _exit(work());
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

constexpr int kAnswered = 10, kSaidSo = 11, kSaidOther = 12;

/// Asks and says what came of it.
int asked(const std::function<void()>& question) {
  try {
    question();
    return kAnswered;
  } catch (const Failure& f) {
    const bool names_it = std::string(f.what()).find("a.talus") != std::string::npos;
    return (f.cause() == Cause::io || f.cause() == Cause::corrupt) && names_it ? kSaidSo : kSaidOther;
  }
}

class ShrinkingFile : public ::testing::Test {
 protected:
  ShrinkingFile() {
    write_raster(fit(fractal(700, 500, 4, 600), SampleType::int16), folder / "a.tif");
    ingest(folder / "a.tif", file);
  }
  /// Opens, shortens the file to a part of itself, and asks.
  int after_cut(double part, const std::function<void(const Snapshot&)>& question) const {
    return end_of([&] {
      const Database database = Database::open(file, {.cache_bytes = 0});
      const Snapshot now = database.snapshot();
      std::filesystem::resize_file(file, static_cast<std::uintmax_t>(part * static_cast<double>(std::filesystem::file_size(file))));
      return asked([&] { question(now); });
    });
  }

  TempFolder folder;
  std::filesystem::path file = folder / "a.talus";
};

TEST_F(ShrinkingFile, IsAFailureOfEveryQuestion) {
  const std::vector<std::function<void(const Snapshot&)>> questions{
      [](const Snapshot& now) { static_cast<void>(now.mesh(Metres{0})); },
      [](const Snapshot& now) { static_cast<void>(now.samples(now.description().extent)); },
      [](const Snapshot& now) { static_cast<void>(now.height(650, -450)); },
      [](const Snapshot& now) { static_cast<void>(now.storage()); },
      [](const Snapshot& now) { static_cast<void>(now.tolerance_for(now.description().extent, Budget{5000, {}})); },
      [](const Snapshot& now) { static_cast<void>(verify(now)); },
  };
  const std::string whole = [&] {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }();
  for (std::size_t i = 0; i < questions.size(); ++i) {
    for (const double part : {0.0, 0.02, 0.3}) {
      EXPECT_EQ(after_cut(part, questions[i]), kSaidSo) << "question " << i << ", cut to " << part;
      std::ofstream(file, std::ios::binary) << whole;
    }
  }
}

TEST_F(ShrinkingFile, IsAFailureOfEachOfSeveralThreadsAndOpensAnewWhenItIsWhole) {
  const auto copy = folder / "copy.talus";
  std::filesystem::copy_file(file, copy);
  EXPECT_EQ(end_of([&] {
              std::optional<Database> database = Database::open(file, {.cache_bytes = 0});
              std::optional<Snapshot> now = database->snapshot();
              std::atomic<int> said = 0;
              {
                std::vector<std::jthread> threads;
                for (int i = 0; i < 4; ++i) {
                  threads.emplace_back([&] {
                    for (int round = 0; round < 1000; ++round) {
                      const int what = asked([&] { static_cast<void>(now->mesh(Metres{1})); });
                      if (what == kAnswered) continue;
                      said += what == kSaidSo ? 1 : 100;
                      return;
                    }
                  });
                }
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
                std::filesystem::resize_file(file, 20000);
              }
              if (said != 4) return 1;
              now.reset();
              database.reset();
              std::filesystem::remove(file);
              std::filesystem::copy_file(copy, file);
              return asked([&] { static_cast<void>(Database::open(file).snapshot().mesh(Metres{0})); });
            }),
            kAnswered);
}

// ---- handlers of others ------------------------------------------------------------------------------

/// Reads a map beyond its file's end, which no database has anything to do with.
void read_lost_page(const std::filesystem::path& file) {
  std::ofstream(file) << std::string(8192, 'x');
  const int handle = ::open(file.c_str(), O_RDONLY);
  const auto* map = static_cast<const volatile char*>(::mmap(nullptr, 8192, PROT_READ, MAP_SHARED, handle, 0));
  std::filesystem::resize_file(file, 0);
  static_cast<void>(map[5000]);
}

sigjmp_buf back;
void jump_back(int) { siglongjmp(back, 1); }
void jump_back_with_info(int, siginfo_t* info, void*) { siglongjmp(back, info->si_code == BUS_ADRERR ? 2 : 3); }

TEST_F(ShrinkingFile, OfOthersIsTheirsToHandle) {
  for (const bool with_info : {false, true}) {
    EXPECT_EQ(end_of([&] {
                struct sigaction theirs {};
                if (with_info) {
                  theirs.sa_sigaction = jump_back_with_info;
                  theirs.sa_flags = SA_SIGINFO;
                } else {
                  theirs.sa_handler = jump_back;
                }
                ::sigaction(SIGBUS, &theirs, nullptr);
                const Snapshot now = Database::open(file).snapshot();
                if (const int jumped = sigsetjmp(back, 1); jumped != 0) {
                  // Ours is handled as before all the same.
                  std::filesystem::resize_file(file, 0);
                  return asked([&] { static_cast<void>(now.mesh(Metres{0})); }) == kSaidSo ? 20 + jumped : 1;
                }
                read_lost_page(folder / "other");
                return 2;
              }),
              with_info ? 22 : 21);
  }
}

TEST_F(ShrinkingFile, OfOthersEndsTheProgramAsItDid) {
  EXPECT_EQ(end_of([&] {
              const Snapshot now = Database::open(file).snapshot();
              read_lost_page(folder / "other");
              return 0;
            }),
            -SIGBUS);
  EXPECT_EQ(end_of([&] {
              const Snapshot now = Database::open(file).snapshot();
              ::raise(SIGBUS);
              return 0;
            }),
            -SIGBUS);
  EXPECT_EQ(end_of([&] {
              ::signal(SIGBUS, SIG_IGN);
              const Snapshot now = Database::open(file).snapshot();
              ::raise(SIGBUS);
              return 5;
            }),
            5)
      << "who ignores a signal that is sent goes on";
}

}  // namespace
}  // namespace talus::support
