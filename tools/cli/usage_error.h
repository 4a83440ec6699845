#pragma once
// Wrong use of the command line, in one line: what is wrong, and what was perhaps meant.

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace puckloop::tools {

/// "run: unknown option --durration (perhaps --duration; see puckloop run --help)"
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace puckloop::tools
