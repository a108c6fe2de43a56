// The file an ingest works in: published whole, or gone.

#include "ingest/part_file.hpp"

#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_database(const fs::path& file) {
  PageWriter writer(file);
  writer.put({kHeaderTable, 0}, {});
  writer.finish();
}

std::optional<Cause> refused(const fs::path& database, bool overwrite) {
  try {
    const PartFile part(database, overwrite, PartFile::Left::refuse);
    return std::nullopt;
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find(database.filename().string()), std::string::npos) << failure.what();
    return failure.cause();
  }
}

TEST(PartFile, StandsBesideTheDatabaseWhileItIsMade) {
  const TempFolder folder;
  const PartFile part(folder / "a.talus", false, PartFile::Left::refuse);
  EXPECT_EQ(part.path(), folder / "a.talus.part");
  EXPECT_TRUE(fs::exists(part.path()));
  EXPECT_FALSE(fs::exists(folder / "a.talus"));
}

TEST(PartFile, PublishingPutsItInTheDatabasesPlace) {
  const TempFolder folder;
  {
    PartFile part(folder / "a.talus", false, PartFile::Left::refuse);
    write_text(part.path(), "whole");
    part.publish();
  }
  EXPECT_EQ(text_of(folder / "a.talus"), "whole");
  EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
}

TEST(PartFile, LeavesNothingBehindUnlessPublished) {
  const TempFolder folder;
  { const PartFile part(folder / "a.talus", false, PartFile::Left::refuse); }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PartFile, AnExistingDatabaseIsReplacedOnlyWhenAsked) {
  const TempFolder folder;
  write_database(folder / "a.talus");
  const std::string before = text_of(folder / "a.talus");
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument);
  EXPECT_EQ(text_of(folder / "a.talus"), before);
  {
    PartFile part(folder / "a.talus", true, PartFile::Left::refuse);
    EXPECT_EQ(text_of(folder / "a.talus"), before) << "until it is published";
    write_text(part.path(), "new");
    part.publish();
  }
  EXPECT_EQ(text_of(folder / "a.talus"), "new");
}

TEST(PartFile, SomebodysOtherFileIsNeverReplaced) {
  const TempFolder folder;
  write_text(folder / "dem.tif", "II*\0 a raster that is long enough to have a header");
  EXPECT_EQ(refused(folder / "dem.tif", true), Cause::invalid_argument);
  write_text(folder / "short", "x");
  EXPECT_EQ(refused(folder / "short", true), Cause::invalid_argument);
  EXPECT_EQ(text_of(folder / "short"), "x");
}

TEST(PartFile, AFolderIsNoDatabase) {
  const TempFolder folder;
  EXPECT_EQ(refused(folder.path(), true), Cause::invalid_argument);
}

TEST(PartFile, WithoutItsFolderItIsNotFound) {
  const TempFolder folder;
  EXPECT_EQ(refused(folder / "none" / "a.talus", false), Cause::not_found);
}

TEST(PartFile, OneIngestAtATime) {
  const TempFolder folder;
  const PartFile part(folder / "a.talus", false, PartFile::Left::refuse);
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument);
  EXPECT_TRUE(fs::exists(part.path())) << "the second one must not take it away";
}

void write_interrupted(const fs::path& file) {
  PageWriter writer(file);
  writer.put({kRecordTable, 3}, {});
  writer.commit(true);
}

TEST(PartFile, WhatWasLeftIsReplacedOrGoneOnWithOnlyWhenAsked) {
  const TempFolder folder;
  write_interrupted(folder / "a.talus.part");
  const std::string left = text_of(folder / "a.talus.part");
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument);
  EXPECT_EQ(text_of(folder / "a.talus.part"), left);
  {
    PartFile part(folder / "a.talus", false, PartFile::Left::resume);
    EXPECT_EQ(text_of(part.path()), left);
    part.keep();
  }
  EXPECT_EQ(text_of(folder / "a.talus.part"), left) << "kept";
  const PartFile part(folder / "a.talus", false, PartFile::Left::replace);
  EXPECT_EQ(fs::file_size(part.path()), 0u);
}

TEST(PartFile, WorkThatHadSettledNothingIsNoLoss) {
  const TempFolder folder;
  write_database(folder / "a.talus.part");
  const PartFile part(folder / "a.talus", false, PartFile::Left::refuse);
  EXPECT_EQ(fs::file_size(part.path()), 0u);
}

TEST(PartFile, CopiesTheDatabase) {
  const TempFolder folder;
  write_database(folder / "a.talus");
  PartFile part(folder / "a.talus", true, PartFile::Left::replace);
  part.copy_database();
  EXPECT_EQ(text_of(part.path()), text_of(folder / "a.talus"));
}

TEST(PartFile, SomebodysOtherFileOfThatNameIsLeftAlone) {
  const TempFolder folder;
  write_text(folder / "a.talus.part", std::string(5000, 'x'));
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument);
  EXPECT_EQ(fs::file_size(folder / "a.talus.part"), 5000u);
}

TEST(PartFile, DoesNotWriteThroughALinkSomebodyLaid) {
  const TempFolder folder;
  write_database(folder / "precious");  // even one that an ingest could have begun
  const auto bytes = fs::file_size(folder / "precious");
  fs::create_symlink(folder / "precious", folder / "a.talus.part");
  EXPECT_TRUE(refused(folder / "a.talus", false).has_value());
  EXPECT_EQ(fs::file_size(folder / "precious"), bytes);
}

}  // namespace
}  // namespace talus::support
