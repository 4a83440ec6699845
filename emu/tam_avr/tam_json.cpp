#include "emu/tam_avr/tam_json.h"

#include "base/json.h"
#include "emu/avr/chip/crash_text.h"
#include "emu/board/place_json.h"

#include <fmt/format.h>

namespace puckloop::tam {

namespace {

std::string hexadecimal(std::uint32_t address) {
    return fmt::format("0x{:04x}", address);
}

nlohmann::ordered_json uart_json(const chip::UartCounters& counters) {
    return {{"sent", counters.sent},
            {"received", counters.received},
            {"framing_errors", counters.framing_errors},
            {"overruns", counters.overruns}};
}

}  // namespace

nlohmann::ordered_json tam_json(const Board& board, const TamLog& log,
                                const std::vector<std::string>& warnings, cosim::Time start) {
    using Json = nlohmann::ordered_json;
    const avr::Chip& chip = board.chip();
    const avr::ChipReport report = chip.report();
    Json json;
    json["cycles"] = report.cycles;
    json["instructions"] = report.instructions;
    json["resets"] = Json::array();
    for (const avr::ResetRecord& reset : report.resets)
        json["resets"].push_back(
            board::with_place({{"time_s", cosim::to_seconds(chip.clock().time_of(reset.cycle) + start)},
                               {"cause", std::string(avr::to_string(reset.cause))},
                               {"pc", hexadecimal(reset.pc)}},
                              chip.places(), reset.pc));
    json["unmodelled"] = Json::array();
    std::vector<std::string> lines = warnings;
    if (const auto crash = avr::crash_text(chip, report)) lines.push_back(*crash);
    if (const auto hang = chip.hang()) lines.push_back(*hang);
    if (const auto refused = avr::refused_text(report)) lines.push_back(*refused);
    for (const avr::ChipWarning& warning : report.warnings)
        lines.push_back(fmt::format("{} ({})", warning.text, avr::place_text(chip, warning.pc)));
    for (const avr::UnmodelledTouch& touch : report.unmodelled) {
        json["unmodelled"].push_back({{"name", touch.name},
                                      {"address", hexadecimal(touch.address)},
                                      {"pc", hexadecimal(touch.pc)},
                                      {"access", touch.write ? "write" : "read"}});
        lines.push_back(fmt::format("{} {}, which is not modelled, at {}", touch.write ? "wrote" : "read",
                                    touch.name.empty() ? hexadecimal(touch.address) : touch.name,
                                    avr::place_text(chip, touch.pc)));
    }
    json["warnings"] = lines;
    json["kind"] = "TAM board, ATmega1284P";
    const avr::Fuses& fuses = chip.fuses();
    json["fuses"] = {{"low", fmt::format("0x{:02X}", fuses.low)},
                     {"high", fmt::format("0x{:02X}", fuses.high)},
                     {"extended", fmt::format("0x{:02X}", fuses.extended)},
                     {"lock", fmt::format("0x{:02X}", fuses.lock)}};
    json["powered"] = board.powered();
    if (!board.powered()) json["switched_off_s"] = cosim::to_seconds(log.switched_off());
    json["battery_v"] = board.signal(kBattery);
    json["interruptions"] = {{"front", log.interruptions()[0]}, {"back", log.interruptions()[1]}};
    json["emitter_edges"] = log.emitter_edges();
    json["led_registers_written"] = board.leds().registers_written();
    json["console"] = uart_json(chip.uart_counters(kConsoleUnit));
    json["xbee"] = uart_json(chip.uart_counters(kXBeeUnit));
    return json;
}

}  // namespace puckloop::tam
