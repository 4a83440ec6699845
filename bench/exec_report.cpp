#include "bench/exec_report.h"

#include "base/json.h"
#include "emu/board/chip_json.h"

#include <fmt/format.h>

namespace puckloop::exec {

namespace {

constexpr std::size_t kShownInText = 10;

/// The double nearest to the decimal fraction: 0.1, not 0.09999999999999999.
double seconds_of(cosim::Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kSecond);
}

std::string at(std::uint32_t pc) {
    return fmt::format("0x{:04x}", pc);
}

std::string hexadecimal(const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes)
        text += fmt::format("{}{:02x}", text.empty() ? "" : " ", byte);
    return text;
}

nlohmann::ordered_json script_json(const I2cScriptReport& script) {
    nlohmann::ordered_json json = {{"lines", script.lines},
                                   {"played", script.played},
                                   {"starts", script.starts},
                                   {"addresses_refused", script.addresses_refused},
                                   {"bytes_refused", script.bytes_refused},
                                   {"bytes_written", script.bytes_written},
                                   {"bytes_read", script.bytes_read},
                                   {"stretched_s", seconds_of(script.stretched)},
                                   {"longest_stretch_s", seconds_of(script.longest_stretch)}};
    if (script.first_refused != 0) json["first_refused_line"] = script.first_refused;
    json["reads"] = nlohmann::ordered_json::array();
    for (const I2cScriptReport::Read& read : script.reads)
        json["reads"].push_back(
            {{"time_s", seconds_of(read.time)},
             {"address", read.address},
             {"register", read.register_number ? nlohmann::ordered_json(*read.register_number) : nullptr},
             {"bytes", hexadecimal(read.bytes)}});
    if (script.stuck_since)
        json["bus_stuck"] = {{"since_s", seconds_of(*script.stuck_since)}, {"line", script.stuck_line}};
    return json;
}

std::string script_text(const I2cScriptReport& script) {
    std::string text = fmt::format(
        "i2c: {} of {} lines played, {} addresses and {} bytes not acknowledged{}, SCL "
        "held for {:.6f} s, at most {:.6f} s\n",
        script.played, script.lines, script.addresses_refused, script.bytes_refused,
        script.first_refused == 0 ? std::string() : fmt::format(" (first on line {})", script.first_refused),
        seconds_of(script.stretched), seconds_of(script.longest_stretch));
    for (std::size_t i = 0; i < script.reads.size() && i < kShownInText; ++i) {
        const I2cScriptReport::Read& read = script.reads[i];
        const std::string number = read.register_number ? fmt::format("{}", *read.register_number) : "-";
        text += fmt::format("i2c read: {:.6f} s, 0x{:02x} register {}: {}\n", seconds_of(read.time),
                            read.address, number, hexadecimal(read.bytes));
    }
    if (script.reads.size() > kShownInText)
        text += fmt::format("i2c reads: {} in all\n", script.reads.size());
    if (script.stuck_since)
        text += fmt::format("i2c: bus stuck since {:.6f} s, line {} of the script: the slave holds SCL low\n",
                            seconds_of(*script.stuck_since), script.stuck_line);
    return text;
}

std::string bus_text(const nlohmann::json& bus) {
    const auto count = [&](const char* name) { return bus.at(name).get<std::uint64_t>(); };
    std::string text =
        fmt::format("i2c: {} transfers, {} bytes written, {} read, {} not acknowledged\n", count("transfers"),
                    count("bytes_written"), count("bytes_read"), count("not_acknowledged"));
    for (const auto& line : bus.at("warnings"))
        text += fmt::format("i2c: {}\n", line.get<std::string>());
    return text;
}

}  // namespace

std::vector<std::string> warnings_of(Bench& bench) {
    std::vector<std::string> warnings = bench.target().warnings();
    for (int unit = 1; unit <= 2; ++unit) {
        const UartEnd* end = bench.uart(unit).end();
        if (end == nullptr) continue;
        if (const EndLosses lost = end->losses(); lost.unread > 0)
            warnings.push_back(fmt::format("uart{}: {}", unit, text_of(lost, end->announcement())));
    }
    return warnings;
}

std::string json_report(Bench& bench, const image::Image& image, const ExecOutcome& outcome) {
    using Json = nlohmann::ordered_json;
    Json json;
    json["stopped"] = outcome.stopped;
    json["success"] = outcome.success;
    if (!outcome.failure.empty()) json["failure"] = outcome.failure;
    json["pc"] = at(outcome.pc);
    if (!outcome.symbol.empty()) json["symbol"] = outcome.symbol;
    if (!outcome.line.empty()) json["line"] = outcome.line;
    json["image"] = {
        {"file", image.file}, {"format", image::name_of(image.format)}, {"sha256", image.sha256}};
    json.update(Json::parse(bench.target().chip_json()));
    json["warnings"] = warnings_of(bench);
    json["simulated_s"] = seconds_of(bench.now());
    json["wall_s"] = outcome.wall_s;
    if (bench.fallen_behind() > 0) json["fallen_behind_s"] = seconds_of(bench.fallen_behind());
    for (int unit = 1; unit <= 2; ++unit) {
        Json uart = board::uart_json(bench.target().uart_counters(unit));
        uart["offered_by_bench"] = bench.uart(unit).bytes_to_chip();
        uart["framing_errors_at_bench"] = bench.uart(unit).framing_errors_seen();
        if (const UartEnd* end = bench.uart(unit).end(); end != nullptr && end->live()) {
            uart["unconnected"] = end->losses().unconnected;
            uart["unread"] = end->losses().unread;
        }
        json[fmt::format("uart{}", unit)] = std::move(uart);
    }
    if (bench.master() != nullptr) json["i2c_script"] = script_json(bench.master()->report());
    if (const std::string board = bench.target().report(); !board.empty()) json["board"] = Json::parse(board);
    if (const std::string bus = bench.target().i2c_devices_report(); !bus.empty())
        json["i2c_bus"] = Json::parse(bus);
    if (!outcome.stats_json.empty()) json["stats"] = Json::parse(outcome.stats_json);
    // Symbols of a damaged image may hold any byte: what is not UTF-8 is replaced.
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string text_report(Bench& bench, const ExecOutcome& outcome) {
    const double simulated = seconds_of(bench.now());
    std::string text =
        fmt::format("stopped: {} at pc {}{}{}\n", outcome.stopped, at(outcome.pc),
                    outcome.symbol.empty() ? std::string() : fmt::format(" ({})", outcome.symbol),
                    outcome.line.empty() ? std::string() : fmt::format(" {}", outcome.line));
    text += fmt::format("time: {:.6f} s simulated in {:.3f} s ({:.1f} x real time)\n", simulated,
                        outcome.wall_s, outcome.wall_s > 0 ? simulated / outcome.wall_s : 0.0);
    if (bench.fallen_behind() > 0)
        text += fmt::format("time: fell behind the wall clock by {:.3f} s in all\n",
                            seconds_of(bench.fallen_behind()));
    text += bench.target().chip_text();
    const std::vector<std::string> warnings = warnings_of(bench);
    for (std::size_t i = 0; i < warnings.size() && i < kShownInText; ++i)
        text += fmt::format("warning: {}\n", warnings[i]);
    if (warnings.size() > kShownInText)
        text += fmt::format("warning: and {} more (--json has them all)\n", warnings.size() - kShownInText);
    if (!outcome.failure.empty()) text += fmt::format("failed: {}\n", outcome.failure);
    if (bench.master() != nullptr) text += script_text(bench.master()->report());
    if (const std::string bus = bench.target().i2c_devices_report(); !bus.empty())
        text += bus_text(nlohmann::json::parse(bus));
    for (int unit = 1; unit <= 2; ++unit) {
        const dspic::UartCounters counters = bench.target().uart_counters(unit);
        if (counters.sent + counters.received == 0) continue;
        text += fmt::format("uart{}: {} sent, {} received, {} framing errors, {} overruns\n", unit,
                            counters.sent, counters.received, counters.framing_errors, counters.overruns);
    }
    return text + outcome.stats_text;
}

namespace {
const char* direction_of(const cosim::SignalInfo& info) {
    return info.direction == cosim::SignalDirection::Input ? "input" : "output";
}
}  // namespace

std::string signals_text(std::span<const cosim::SignalInfo> signals) {
    std::string text;
    for (const cosim::SignalInfo& info : signals)
        text += fmt::format("{:<14} {:<6} {:<8} {} to {}, initially {}: {}\n", info.name, direction_of(info),
                            info.unit, info.min, info.max, info.initial, info.description);
    return text;
}

std::string signals_json(std::span<const cosim::SignalInfo> signals) {
    auto json = nlohmann::ordered_json::array();
    for (const cosim::SignalInfo& info : signals)
        json.push_back({{"name", info.name},
                        {"direction", direction_of(info)},
                        {"unit", info.unit},
                        {"min", info.min},
                        {"max", info.max},
                        {"initial", info.initial},
                        {"description", info.description}});
    return json.dump() + "\n";
}

}  // namespace puckloop::exec
