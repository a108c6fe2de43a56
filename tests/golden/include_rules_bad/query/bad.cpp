#include <cpl_conv.h>          // refused
#include <lmdb.h>              // refused
#include "ingest/cut.hpp"      // refused
#include "talus/ingest.hpp"    // refused
#include "app/arguments.hpp"   // refused
#include "storage/transaction.hpp"
#include "engine/selection.hpp"
#include "talus/database.hpp"
