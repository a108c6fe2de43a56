#include <gdal_priv.h>
#include <CLI/CLI.hpp>           // refused
#include <boost/optional.hpp>    // refused
#include "query/database.hpp"    // refused
#include "talus/talus.hpp"       // refused
#include "talus/ingest.hpp"
