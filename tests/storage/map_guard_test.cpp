// A file that becomes shorter while it is read. Each test asks in a process of its own, which a signal may end.

#include "storage/map_guard.hpp"

#include <atomic>
#include <chrono>
#include <csetjmp>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "talus/ingest.hpp"
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
      std::filesystem::resize_file(
          file, static_cast<std::uintmax_t>(part * static_cast<double>(std::filesystem::file_size(file))));
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
      [](const Snapshot& now) {
        static_cast<void>(now.ask({.region = now.description().extent, .budget = Budget{5000, {}}}).quadtree.tolerance);
      },
      [](const Snapshot& now) {
        if (verify(now).is_damaged()) throw Failure(Cause::corrupt, "a.talus: verify reports it");
      },
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

/// In a program that has opened no database yet: the next tests start it, and say how it handles SIGBUS and with which
/// file.
TEST(HandlerBefore, DISABLED_IsAsked) {
  const std::string how = std::getenv("TALUS_TEST_HANDLER");
  const std::filesystem::path file = std::getenv("TALUS_TEST_FILE");
  struct sigaction theirs {};
  if (how == "plain") theirs.sa_handler = jump_back;
  if (how == "with info") theirs.sa_sigaction = jump_back_with_info, theirs.sa_flags = SA_SIGINFO;
  if (how.starts_with("ignored")) theirs.sa_handler = SIG_IGN;
  ::sigaction(SIGBUS, &theirs, nullptr);
  const Snapshot now = Database::open(file).snapshot();
  if (const int jumped = sigsetjmp(back, 1); jumped != 0) {
    // What is the database's is handled all the same.
    std::filesystem::resize_file(file, 0);
    _exit(asked([&] { static_cast<void>(now.mesh(Metres{0})); }) == kSaidSo ? 20 + jumped : 1);
  }
  if (how.ends_with("sent")) {
    ::raise(SIGBUS);
  } else {
    read_lost_page(file.string() + ".other");
  }
  _exit(5);
}

int end_with_handler(const std::string& how, const std::filesystem::path& file) {
  return end_of([&] {
    ::setenv("TALUS_TEST_HANDLER", how.c_str(), 1);
    ::setenv("TALUS_TEST_FILE", file.c_str(), 1);
    ::execl("/proc/self/exe", "test", "--gtest_also_run_disabled_tests", "--gtest_filter=HandlerBefore.*",
            "--gtest_brief=1", static_cast<char*>(nullptr));
    return 1;
  });
}

TEST_F(ShrinkingFile, OfOthersIsTheirsToHandle) {
  const auto copy = folder / "a.talus.copy";  // its name has the other's in it
  for (const auto& [how, end] : {std::pair{"plain", 21}, std::pair{"with info", 22}}) {
    std::filesystem::copy_file(file, copy, std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(end_with_handler(how, copy), end) << how;
  }
}

TEST_F(ShrinkingFile, OfOthersEndsTheProgramAsItDid) {
  EXPECT_EQ(end_with_handler("default", file), -SIGBUS);
  EXPECT_EQ(end_with_handler("default, sent", file), -SIGBUS);
  EXPECT_EQ(end_with_handler("ignored", file), -SIGBUS);
  EXPECT_EQ(end_with_handler("ignored, sent", file), 5) << "who ignores a signal that is sent goes on";
}

}  // namespace
}  // namespace talus::support
