#pragma once
// A subcommand of the command line: each lives in a file of its own and is listed once in main.cpp.

namespace CLI {
class App;
}

namespace puckloop::tools {

/// Declares its options on `app` and sets a callback that returns through `status` (0 success, 1 a run or
/// check failed). Wrong use and bad input are thrown as InputError and become status 2 in main().
using DeclareCommand = void (*)(CLI::App& app, int& status);

}  // namespace puckloop::tools
