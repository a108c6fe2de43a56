#pragma once
// Standard input, output and error as the program finds them.

namespace talus::app {

/// Where one of the three is closed, something unreadable and unwritable takes its place, so that no file that is
/// opened later becomes standard output by accident. Writing beyond a limit on file sizes, or to a pipe that nobody
/// reads, is from now on a failure of that write and no longer a signal.
void secure_standard_files();

}  // namespace talus::app
