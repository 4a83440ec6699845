// IRcom's words as decoded from the recorded light, against those that the medium itself saw.

#include "trace_kit.h"

#include "base/json.h"
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>
#include <set>
#include <sstream>

using namespace puckloop::tests;

TEST_CASE("decode finds the IRcom words that the medium saw, at their times") {
    const std::string out = scratch("ircom");
    const Called run = puckloop::tests::puckloop(fmt::format(
        "run {}/scenarios/ircom.toml --in-process --duration 1.3 --record --out {}", PUCKLOOP_SOURCE, out));
    INFO(run.out);
    REQUIRE(run.status == 0);
    std::set<std::string> seen, found;
    std::ifstream in(out + "/ircom.csv");
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
        std::istringstream fields(line);
        std::string begin, end, sender, word, fault;
        for (std::string* field : {&begin, &end, &sender, &word, &fault})
            std::getline(fields, *field, ',');
        seen.insert(fmt::format("{} {} {:02X}", begin, sender, std::stoi(word, nullptr, 16)));
    }
    const Called decoded =
        puckloop::tests::puckloop(fmt::format("trace decode {}/record.csv --protocol ircom --json", out));
    REQUIRE(decoded.status == 0);
    for (const std::string& text : lines_of(decoded.out)) {
        const auto frame = nlohmann::json::parse(text);
        CHECK(frame.at("errors").empty());
        const std::string from = frame.at("from");
        found.insert(fmt::format("{:.9f} {} {:02X}", frame.at("begin_s").get<double>(),
                                 from.substr(0, from.find('.')), frame.at("word").get<int>()));
    }
    CHECK(seen.size() >= 8);
    // The same words; half a nanosecond is rounded up here and down there.
    REQUIRE(found.size() == seen.size());
    for (auto a = found.begin(), b = seen.begin(); a != found.end(); ++a, ++b) {
        CHECK(std::stod(*a) == Approx(std::stod(*b)).margin(1.5e-9).epsilon(0));
        CHECK(a->substr(a->find(' ')) == b->substr(b->find(' ')));
    }
}
