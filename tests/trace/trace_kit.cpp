#include "trace_kit.h"

#include "cosim/trace/trace_csv.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

#include <sys/wait.h>

namespace puckloop::tests {

using namespace cosim;

Called shell(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    Called called;
    std::array<char, 4096> buffer{};
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
        called.out.append(buffer.data(), got);
    called.status = WEXITSTATUS(pclose(pipe));
    return called;
}

Called puckloop(const std::string& arguments) {
    return shell(fmt::format("{} {} 2>&1", PUCKLOOP_PROGRAM, arguments));
}

bool installed(const std::string& program) {
    if (shell("command -v " + program).status == 0) return true;
    WARN(program << " is not installed: what it reads is not compared (Debian: apt-get install " << program
                 << ")");
    return false;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

std::string scratch(const std::string& name) {
    const auto path = scratch_path("puckloop_trace");
    std::filesystem::create_directories(path);
    return (path / name).string();
}

std::string write_trace(const std::string& name, const std::vector<TraceRow>& rows) {
    const std::string path = scratch(name);
    std::ofstream out(path);
    out << kTraceColumns << '\n';
    for (const TraceRow& row : rows)
        out << to_csv(row) << '\n';
    return path;
}

std::vector<TraceRow> rows_of(const std::string& file) {
    std::ifstream in(file);
    std::vector<TraceRow> rows;
    REQUIRE(read_trace(in, file, [&](const TraceRow& row) { rows.push_back(row); }));
    return rows;
}

TraceRow uart_row(const std::string& link, const std::string& from, const UartFrame& frame, FaultKind fault) {
    return {protocols::stop_bit_start(frame), link, from, "", fault, frame};
}

void I2cScript::row(const std::string& from, I2cPhase phase) {
    rows_.push_back({now_, "toy.i2c.master", from, "", FaultKind::None, phase});
    if (from == "toy.i2c") return;
    rows_.insert(rows_.end(), late_.begin(), late_.end());
    late_.clear();
}

void I2cScript::answer(I2cPhaseKind kind, std::uint8_t byte, bool acknowledged, Time stretch) {
    now_ = start_ + 9 * period_ + stretch;
    late_.push_back({now_, "toy.i2c.master", "toy.i2c", "", FaultKind::None,
                     I2cPhase{kind, byte, acknowledged, start_, period_, stretch}});
}

void I2cScript::start(std::uint8_t byte, bool acknowledged, Time stretch) {
    start_ = now_;
    row("master", {I2cPhaseKind::Start, byte, 0, now_, period_, 0});
    answer(I2cPhaseKind::Acknowledge, byte, acknowledged, stretch);
}

void I2cScript::write(std::uint8_t byte, bool acknowledged, Time stretch) {
    start_ = now_;
    row("master", {I2cPhaseKind::Write, byte, 0, now_, period_, 0});
    answer(I2cPhaseKind::Acknowledge, byte, acknowledged, stretch);
}

void I2cScript::read(std::uint8_t byte, bool acknowledged, Time stretch) {
    start_ = now_;
    row("master", {I2cPhaseKind::Read, 0, acknowledged, now_, period_, 0});
    answer(I2cPhaseKind::Data, byte, acknowledged, stretch);
}

void I2cScript::stop() {
    row("master", {I2cPhaseKind::Stop, 0, 0, now_, period_, 0});
    now_ += period_;
}

std::vector<std::string> i2c_words(const std::vector<TraceRow>& rows, const std::string& link) {
    std::vector<std::string> words;
    std::vector<I2cPhase> requests;
    for (const TraceRow& row : rows) {
        const auto* phase = std::get_if<I2cPhase>(&row.payload);
        if (row.link != link || phase == nullptr) continue;
        bool stop = false;
        if (phase->kind <= I2cPhaseKind::Stop) {
            requests.push_back(*phase);
            stop = phase->kind == I2cPhaseKind::Stop && requests.size() == 1;
        } else {
            REQUIRE(!requests.empty());
            const I2cPhase asked = requests.front();
            requests.erase(requests.begin());
            const bool to_start = asked.kind == I2cPhaseKind::Start;
            if (to_start) words.push_back("S");
            words.push_back(fmt::format("{}{:02X}",
                                        asked.kind == I2cPhaseKind::Read ? 'R'
                                        : to_start                       ? 'a'
                                                                         : 'W',
                                        to_start ? phase->byte >> 1 : phase->byte));
            words.push_back((phase->kind == I2cPhaseKind::Data ? asked.ack : phase->ack) ? "A" : "N");
            stop = !requests.empty() && requests.front().kind == I2cPhaseKind::Stop;
        }
        if (stop) {
            words.push_back("P");
            requests.erase(requests.begin());
        }
    }
    return words;
}

}  // namespace puckloop::tests
