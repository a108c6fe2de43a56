#include <cpl_conv.h>          // refused
#include <lmdb.h>              // refused
#include "ingest/cut.hpp"      // refused
#include "talus/ingest.hpp"    // refused
#include "app/arguments.hpp"   // refused
#include "storage/transaction.hpp"
#include "engine/selection.hpp"
#include "talus/database.hpp"
const char* const kSentence = "ask for a coarser --tolerance";  // refused
const char* const kOther = "a -- dash and x--y are none";
// A comment may say --tolerance.
