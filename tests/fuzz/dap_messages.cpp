// Messages of the Debug Adapter Protocol, in one piece and byte by byte.

#include "base/error.h"
#include "bench/debugger/dap_channel.h"
#include "tests/fuzz/target.h"

#include <string>
#include <vector>

namespace {

/// All whole messages, and whether what followed cannot be read.
std::vector<std::string> read_all(std::string_view text, std::size_t piece) {
    puckloop::exec::debugger::DapReader reader;
    std::vector<std::string> found;
    try {
        for (std::size_t at = 0; at < text.size(); at += piece) {
            reader.add(text.substr(at, piece));
            while (const auto content = reader.next())
                found.push_back(*content);
        }
    } catch (const puckloop::InputError&) {
        found.emplace_back("no DAP");
    }
    return found;
}

}  // namespace

void puckloop::fuzz::run_input(Input input) {
    const std::string_view text = text_of(input);
    if (text.empty()) return;
    const auto whole = read_all(text, text.size()), pieces = read_all(text, 1);
    // A header is refused as soon as it is too long, which byte by byte may be before its end has come.
    if (pieces.empty() || pieces.back() != "no DAP" || text.size() < 4096)
        require(whole == pieces, "the same messages however the bytes arrive");
}
