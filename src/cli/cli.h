#pragma once
namespace candela::cli {
// Parses, runs one command, prints, and returns the exit code. The only place that knows CLI11,
// stdout and exit codes.
int run(int argc, char** argv);
}  // namespace candela::cli
