// Programs of several processes as their authors would write them: what they print on computers of a run's
// network is what they print on this machine, whose kernel judges.

#include "tests/end_to_end/kit/process.h"
#include "tests/network/host_runs.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>

using namespace puckloop::tests;

namespace {

/// One process: what a computer of the network runs, with SERVER in place of the first one's name.
struct Part {
    std::string name;
    Words words;
};

Words at(const Words& words, const std::string& server) {
    Words all = words;
    std::replace(all.begin(), all.end(), std::string("SERVER"), server);
    return all;
}

/// Lines that do not depend on who of several came first.
std::string in_order(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        lines.push_back(line + '\n');
    std::sort(lines.begin(), lines.end());
    std::string all;
    for (const std::string& line : lines)
        all += line;
    return all;
}

/// Runs the parts in every placement and on this machine; each part prints the same lines.
void check_beside_host(const Workbench& bench, const std::vector<Part>& parts, const std::string& duration) {
    std::vector<std::pair<std::string, std::string>> programs;
    for (const Part& part : parts)
        programs.emplace_back(part.name, list_of(at(part.words, parts.front().name)));
    check_everywhere(bench, bench.file("parts.toml", hosts(programs, duration)));
    std::vector<std::unique_ptr<Process>> real;
    for (const Part& part : parts) {
        const std::filesystem::path own = bench.folder() / ("host_" + part.name);  // for its output
        std::filesystem::create_directory(own);
        real.push_back(std::make_unique<Process>(at(part.words, "127.0.0.1"), own));
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Ended ended = real[i]->wait(60.0);
        INFO(parts[i].name << ": " << ended.err);
        const std::string log = log_of(bench, "o0", parts[i].name);
        CHECK_FALSE(ended.timed_out);
        CHECK(in_order(log) == in_order(ended.out));
        CHECK(ended.err.empty());
    }
}

}  // namespace

TEST_CASE("an MQTT broker, devices that leave well, rudely and silently, a watcher", "[network][beside]") {
    const Workbench bench;
    check_beside_host(bench,
                      {{"broker", python_words("broker.py", {"broker"})},
                       {"polite", python_words("broker.py", {"device", "polite", "SERVER"})},
                       {"rude", python_words("broker.py", {"device", "rude", "SERVER"})},
                       {"silent", python_words("broker.py", {"device", "silent", "SERVER"})},
                       {"watcher", python_words("broker.py", {"watcher", "SERVER"})}},
                      "7 s");
}

TEST_CASE("services that are found by questions to a group", "[network][beside]") {
    const Workbench bench;
    check_beside_host(bench,
                      {{"one", python_words("discovery.py", {"service", "one"})},
                       {"two", python_words("discovery.py", {"service", "two"})},
                       {"seeker", python_words("discovery.py", {"seeker", "seeker"})}},
                      "6 s");
}

TEST_CASE("asyncio streams: back-pressure, time-outs, half-close, a server that stops", "[network][beside]") {
    const Workbench bench;
    check_beside_host(bench,
                      {{"server", python_words("streams.py", {"server"})},
                       {"client", python_words("streams.py", {"client", "SERVER"})}},
                      "9 s");
}

TEST_CASE("HTTP/1.1: connections kept, chunked bodies, 100-continue, requests at once", "[network][beside]") {
    const Workbench bench;
    check_beside_host(bench,
                      {{"server", python_words("web.py", {"server"})},
                       {"client", python_words("web.py", {"client", "SERVER"})}},
                      "9 s");
}

TEST_CASE("a chat by select(), streams of the C library and half-close", "[network][beside]") {
    const Workbench bench;
    const auto guest = [](const std::string& name, const Words& says) {
        Words words{PUCKLOOP_CHAT, "guest", name, "SERVER"};
        words.insert(words.end(), says.begin(), says.end());
        return words;
    };
    check_beside_host(bench,
                      {{"server", {PUCKLOOP_CHAT, "server"}},
                       {"ann", guest("ann", {"300 hello", "400 anybody?", "600 bye"})},
                       {"bob", guest("bob", {"400 hi ann", "900 /throw eve"})},
                       {"eve", guest("eve", {"350 ha", "1500 haha", "700 hahaha", "200 ho"})}},
                      "6 s");
    CHECK(count(log_of(bench, "o0", "ann"), "closing time\nend\n") == 1);
}

TEST_CASE("sockets with a name between programs of one board", "[network][beside]") {
    const Workbench bench;
    const auto file = bench.file("local.toml", hosts({{"alpha", python("local_talk.py")}}, "5 s"));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    Process host(python_words("local_talk.py"), bench.folder());
    const Ended real = host.wait();
    INFO(real.err);
    CHECK(real.status == 0);
    CHECK(log_of(bench, "o", "alpha") == real.out);
    // They are the host's: it is said that the run need not be the same again.
    const auto warnings = bench.report("o")["nodes"]["alpha.linux"]["warnings"].dump();
    INFO(warnings);
    CHECK(warnings.find("differ") != std::string::npos);
}
