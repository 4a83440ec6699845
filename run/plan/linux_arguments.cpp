#include "run/plan/linux_arguments.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace puckloop::tools {

namespace {

constexpr auto kRunOptions = std::to_array<std::string_view>(
    {"--firmware",    "--linux",     "--in-process",   "--realtime",   "--duration",
     "--seed",        "--model",     "--out",          "--json",       "--stall",
     "--threads",     "--paced",     "--events",       "--strict",     "--list-parameters",
     "--log-level",   "--log-file",  "--verbose",      "--save-state", "--at",
     "--from-state",  "--no-cache",  "--no-translate", "--fault",      "--trace-format",
     "--record",      "--live",      "--gdb",          "--save-at",    "--save",
     "--from",        "--stats",     "--set",          "--floor",      "--floor-scale",
     "--linux-start", "--control",   "--mission",      "--junit",      "--tap",
     "--view",        "--view-port", "--shell",        "--join"});

bool is_run_option(std::string_view word) {
    return std::any_of(kRunOptions.begin(), kRunOptions.end(), [&](std::string_view option) {
        return word == option || (word.starts_with(option) && word[option.size()] == '=');
    });
}

}  // namespace

std::vector<std::string> pack_linux_arguments(const std::vector<std::string>& words) {
    std::vector<std::string> packed;
    for (std::size_t i = 0; i < words.size(); ++i) {
        packed.push_back(words[i]);
        if (words[i] != "--linux" || i + 1 == words.size()) continue;
        packed.back() = "--linux=" + words[++i];
        bool verbatim = false;
        while (i + 1 < words.size() && (verbatim || !is_run_option(words[i + 1]))) {
            ++i;
            if (!verbatim && words[i] == "--")
                verbatim = true;
            else
                packed.push_back("--linux-arg=" + words[i]);
        }
    }
    return packed;
}

}  // namespace puckloop::tools
