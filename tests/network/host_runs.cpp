#include "tests/network/host_runs.h"

#include "tests/end_to_end/kit/load.h"
#include "tests/end_to_end/kit/same_run.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace puckloop::tests {

std::string list_of(const Words& words) {
    return fmt::format("[\"{}\"]", fmt::join(words, "\", \""));
}

Words python_words(const std::string& file, const Words& more) {
    Words words{std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3", "-B", "-S",
                "-E", PUCKLOOP_SOURCE "/tests/network/programs/" + file};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

std::string python(const std::string& file, const Words& more) {
    return list_of(python_words(file, more));
}

std::string hosts(const std::vector<std::pair<std::string, std::string>>& programs,
                  const std::string& duration, const std::string& network) {
    std::string text = fmt::format(
        "[run]\nduration = \"{}\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[network]\n{}\n", duration, network);
    for (const auto& [name, program] : programs)
        text += fmt::format("[[host]]\nname = \"{}\"\nprogram = {}\n", name, program);
    return text;
}

std::string log_of(const Workbench& bench, const std::string& run, const std::string& node) {
    std::ifstream in(bench.out(run) / (node + ".linux.log"));
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
        ++found;
    return found;
}

void check_everywhere(const Workbench& bench, const std::filesystem::path& file) {
    const std::vector<Words> ways{
        {"--in-process"}, {}, {"--in-process", "--threads", "2"}, {"--in-process", "--threads", "4"}};
    for (std::size_t i = 0; i <= ways.size(); ++i) {
        Words words{file.string()};
        const Words& way = ways[i % ways.size()];
        words.insert(words.end(), way.begin(), way.end());
        const Load load(i == ways.size() ? 3 : 0);
        const Ended ended = bench.run(fmt::format("o{}", i), words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        if (i > 0) check_same_run(bench, "o0", fmt::format("o{}", i));
    }
}

}  // namespace puckloop::tests
