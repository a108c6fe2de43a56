// The file an ingest works in: published whole, or gone.

#include "ingest/job/part_file.hpp"

#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "engine/page/manifest.hpp"
#include "storage/page_store.hpp"
#include "talus/failure.hpp"
#include "tests/support/older_database.hpp"
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

TEST(PartFile, ADatabaseOfAnOlderVersionIsReplacedWhenAsked) {
  const TempFolder folder;
  write_older_database(folder / "a.talus");
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument);
  EXPECT_EQ(refused(folder / "a.talus", true), std::nullopt);
}

TEST(PartFile, SomebodysOtherFileIsNeverReplaced) {
  const TempFolder folder;
  write_older_database(folder / "data.mdb", "pictures");
  EXPECT_EQ(refused(folder / "data.mdb", true), Cause::invalid_argument);
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
  const std::string plan = "talus format 3\n";
  writer.put({kHeaderTable, kPlanPosition}, std::as_bytes(std::span(plan)));
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

TEST(PartFile, TheNextWriterHasAFileOfItsOwn) {
  const TempFolder folder;
  write_database(folder / "a.talus");
  std::optional<PartFile> first(std::in_place, folder / "a.talus", true, PartFile::Left::refuse);
  first->copy_database();
  first->publish();
  const std::string published = text_of(folder / "a.talus");
  {
    const PartFile second(folder / "a.talus", true, PartFile::Left::replace);  // the published file is still locked
    EXPECT_TRUE(fs::exists(second.path()));
    first.reset();
    EXPECT_EQ(refused(folder / "a.talus", true), Cause::invalid_argument) << "the second is at work";
  }
  EXPECT_EQ(text_of(folder / "a.talus"), published) << "nobody has emptied it";
}

TEST(PartFile, DoesNotReplaceADatabaseThatAnotherProgramHasPutThere) {
  const TempFolder folder;
  write_database(folder / "a.talus");
  write_database(folder / "b.talus");
  PartFile part(folder / "a.talus", true, PartFile::Left::replace);
  part.copy_database();
  fs::rename(folder / "b.talus", folder / "a.talus");
  EXPECT_THROW(part.publish(), Failure);
  PartFile fresh(folder / "c.talus", false, PartFile::Left::refuse);
  write_text(folder / "c.talus", "somebody's");
  EXPECT_THROW(fresh.publish(), Failure);
  EXPECT_EQ(text_of(folder / "c.talus"), "somebody's");
}

TEST(PartFile, AnUpdateLeavesNothingToGoOnWith) {
  const TempFolder folder;
  write_database(folder / "a.talus");
  const auto leave = [&] {
    PageWriter writer(folder / "a.talus.part");
    const std::string plan = "update of a.talus with b.tif\n";
    writer.put({kHeaderTable, kPlanPosition}, std::as_bytes(std::span(plan)));
    writer.put({kRecordTable, 3}, {});
    writer.commit(true);
  };
  leave();
  EXPECT_THROW(PartFile(folder / "a.talus", true, PartFile::Left::resume), Failure);
  EXPECT_TRUE(fs::exists(folder / "a.talus.part"));
  {
    const PartFile part(folder / "a.talus", true, PartFile::Left::refuse);
    EXPECT_EQ(fs::file_size(part.path()), 0u) << "the database holds all that it held";
  }
  leave();
  fs::remove(folder / "a.talus");
  EXPECT_EQ(refused(folder / "a.talus", false), Cause::invalid_argument) << "the copy may be the last one";
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
