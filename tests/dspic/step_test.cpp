// puckloop step: the vectors of two independent sources (when given), interpreted and translated, and what
// the parser makes of bad lines.

#include "base/random.h"
#include "emu/dspic/core/step_vector.h"
#include "tests/translate/translation_guard.h"

#include <catch2/catch.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

using namespace puckloop::dspic;

namespace {

using Fields = std::map<std::string, std::string>;

Fields fields_of(std::istringstream& in) {
    Fields fields;
    for (std::string token; in >> token;) {
        const auto equals = token.find('=');
        if (equals != std::string::npos) fields[token.substr(0, equals)] = token.substr(equals + 1);
    }
    return fields;
}

std::vector<std::string> list_of(const std::string& text) {
    std::vector<std::string> items;
    std::istringstream in(text);
    for (std::string item; std::getline(in, item, ',');)
        items.push_back(item);
    return items;
}

/// Applies the "only what changed" part of a vector to its initial state and compares with the answer.
/// Returns what differs, or an empty string.
std::string difference(const Fields& initial, const Fields& changes, const Fields& answer) {
    Fields want = {{"aa", "0000000000"},
                   {"ab", "0000000000"},
                   {"rc", "0000"},
                   {"tp", "00"},
                   {"dc", "0000"},
                   {"ds", "000000"},
                   {"de", "000000"},
                   {"di", "0000"},
                   {"sh", "0000,0000,0000,0000,0000"},
                   {"m", ""}};
    for (const auto& [key, value] : initial)
        if (key != "m" && key != "op" && key != "p" && key != "run") want[key] = value;
    auto w = list_of(want["w"]);
    for (const auto& [key, value] : changes) {
        if (key[0] == 'w')
            w[std::stoul(key.substr(1))] = value;
        else if (key != "cyc" && key != "srm" && key != "amb")
            want[key] = value;
    }
    if (!initial.contains("sh") && !changes.contains("sh")) want.erase("sh");
    w[15].back() = "02468ace"[std::stoul(w[15].substr(3), nullptr, 16) / 2];  // bit 0 of W15 always reads 0
    std::string joined;
    for (const auto& item : w)
        joined += (joined.empty() ? "" : ",") + item;
    want["w"] = joined;
    std::string report;
    const auto mask = std::stoul(changes.at("srm"), nullptr, 16);
    for (const auto& [key, value] : want) {
        const std::string& got = answer.at(key);
        if (key == "sr" && ((std::stoul(got, nullptr, 16) ^ std::stoul(value, nullptr, 16)) & mask) == 0)
            continue;
        if (got != value) report += " " + key + "=" + got + " not " + value;
    }
    if (changes.at("cyc") != "-" && answer.at("cyc") != changes.at("cyc"))
        report += " cyc=" + answer.at("cyc") + " not " + changes.at("cyc");
    return report;
}

struct CloseFile {
    void operator()(std::FILE* file) const { ::pclose(file); }
};

}  // namespace

TEST_CASE("every shared vector passes, states and cycles") {
    const char* place = std::getenv("PUCKLOOP_VECTORS");
    if (!place) {
        WARN("skipped: PUCKLOOP_VECTORS names no file or folder of *.txt.xz");
        return;
    }
    std::vector<std::filesystem::path> files;
    if (std::filesystem::is_directory(place)) {
        for (const auto& entry : std::filesystem::directory_iterator(place))
            if (entry.path().extension() == ".xz") files.push_back(entry.path());
    } else {
        files.emplace_back(place);
    }
    REQUIRE_FALSE(files.empty());
    StepMachine interpreted(dspic30f6014a());
    const puckloop::tests::TranslationGuard guard(true);
    StepMachine translated(dspic30f6014a(), true);
    int cases = 0, failures = 0;
    for (const auto& file : files) {
        const std::string command = "xz -dcf '" + file.string() + "'";
        const std::unique_ptr<std::FILE, CloseFile> pipe(::popen(command.c_str(), "r"));
        REQUIRE(pipe);
        std::vector<char> buffer(1 << 16);
        while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe.get())) {
            const std::string line = buffer.data();
            const auto first = line.find(" I "), last = line.find(" O ");
            if (first == std::string::npos || last == std::string::npos) continue;
            ++cases;
            const std::string id = line.substr(0, line.find(' '));
            const std::string state = line.substr(first + 3, last - first - 3);
            std::istringstream initial(state), changes(line.substr(last + 3));
            const std::string answer = interpreted.answer(id + " " + state);
            std::istringstream answered(answer);
            std::string got_id, verdict;
            answered >> got_id >> verdict;
            std::string problem =
                verdict == "ok" && got_id == id
                    ? difference(fields_of(initial), fields_of(changes), fields_of(answered))
                    : answer;
            if (const std::string again = translated.answer(id + " " + state); again != answer)
                problem += " translated: " + again;
            if (problem.empty()) continue;
            if (++failures <= 20) UNSCOPED_INFO(line.substr(0, line.find(" I ")) << ":" << problem);
        }
    }
    CHECK(failures == 0);
    CHECK(cases > 0);
    WARN(cases << " vectors run");
}

namespace {
const std::string kState =
    "w=0001,0002,0003,0004,0005,0006,0007,0008,1000,1002,1800,1802,000c,000d,000e,1200 pc=001000";
}

TEST_CASE("an answer names the whole state") {
    StepMachine machine(dspic30f6014a());
    CHECK(machine.answer("7 " + kState + " op=400001") ==  // ADD W0,W1,W0
          "7 ok w=0003,0002,0003,0004,0005,0006,0007,0008,1000,1002,1800,1802,000c,000d,000e,1200 sr=0000 "
          "cc=0000 "
          "aa=0000000000 ab=0000000000 rc=0000 pc=001002 tp=00 ps=00 dc=0000 ds=000000 de=000000 di=0000 "
          "sh=0000,0000,0000,0000,0000 m= cyc=1");
}

TEST_CASE("a case leaves nothing behind for the next") {
    StepMachine machine(dspic30f6014a());
    const std::string line = "a " + kState + " op=781f80 m=1200:1234 sr=010f";
    const std::string first = machine.answer(line);
    CHECK(machine.answer("b " + kState + " op=fc0005 cc=0020").find("di=0005") != std::string::npos);
    CHECK(machine.answer("c " + kState + " op=080003,000001,000000,000000 run=4").find(" ok ") !=
          std::string::npos);
    CHECK(machine.answer(line) == first);
    // Sleep, RESET, a trap, a register written.
    const std::string read = "r " + kState + " op=801000";  // MOV 0x200,W0
    const std::string zero = machine.answer(read);
    for (const char* words : {"fe4000", "fe4001", "fe0000", "7f0000", "881000"}) {
        machine.answer("x " + kState + " op=" + words);
        INFO(words);
        CHECK(machine.answer(line) == first);
        CHECK(machine.answer(read) == zero);
    }
}

TEST_CASE("malformed lines answer with what is wrong") {
    StepMachine machine(dspic30f6014a());
    const auto says = [&](const std::string& line, const std::string& text) {
        INFO(line);
        CHECK(machine.answer(line).find(text) != std::string::npos);
    };
    says("1", "1 error no state");
    says("1 " + kState, "1 error op is missing");
    says("1 op=000000 pc=1000", "error w is missing");
    says("1 " + kState + " op=400001 zz=1", "error unknown key 'zz'");
    says("1 " + kState + " op=400001 sr=10000", "error sr: 10000 is more than ffff");
    says("1 " + kState + " op=40000g", "error op: '40000g' is not a hex number");
    says("1 " + kState + " op=400001 m=1001:0000", "error m: odd address");
    says("1 " + kState + " op=400001 m=7000:0000", "error m: no RAM at 7000");
    says("1 " + kState + " op=400001 op=400001", "error op given twice");
    says("1 w=1,2 pc=0 op=0", "error w: 2 values, expected 16");
    says("1 " + kState + " op=3f0000", "unsupported 3f0000 is no instruction");
    says("1 " + kState + " op=fe0000", "unsupported resets the part");
    says("1 " + kState + " op=37ffff run=1", " ok ");
    says("1 " + kState + " op=37ffff run=2", "unsupported PC does not leave");
    CHECK(machine.answer("2 " + kState + " op=000000").find("2 ok") == 0);
}

TEST_CASE("random damage never throws and always answers") {
    StepMachine machine(dspic30f6014a());
    puckloop::RandomStream random(20, "step fuzz");
    const std::string good =
        "5 " + kState + " sr=0103 cc=00f3 aa=ff80000000 op=400001,080001 run=2 m=1000:1234 p=2000:123456";
    const std::string alphabet = "0123456789abcdefgw=:,. -+ropmu\t\x01\xff";
    for (int round = 0; round < 5000; ++round) {
        std::string line = good;
        const auto edits = 1 + random.below(4);
        for (std::uint64_t i = 0; i < edits && !line.empty(); ++i) {
            const auto at = random.below(line.size());
            switch (random.below(4)) {
            case 0:
                line[at] = alphabet[random.below(alphabet.size())];
                break;
            case 1:
                line.erase(at, 1 + random.below(6));
                break;
            case 2:
                line.insert(at, 1, alphabet[random.below(alphabet.size())]);
                break;
            default:
                line.resize(at);
            }
        }
        const std::string answer = machine.answer(line);
        REQUIRE((answer.find(" ok ") != std::string::npos || answer.find(" error ") != std::string::npos ||
                 answer.find(" unsupported ") != std::string::npos));
        REQUIRE(answer.find('\n') == std::string::npos);
    }
}
