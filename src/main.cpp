#include "cli/cli.h"

int main(int argc, char** argv) { return candela::cli::run(argc, argv); }
