#include "emu/rab_board/rab_json.h"

#include "base/json.h"
#include "emu/board/chip_json.h"

namespace puckloop::rab {

namespace {

double seconds(cosim::Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kSecond);
}

}  // namespace

nlohmann::ordered_json activity_json(const Board& board, const RabLog& log) {
    const I2cCounters& i2c = log.i2c().counters();
    nlohmann::ordered_json json;
    json["emission"] = {{"frames", log.frames().frames()},
                        {"irregular", log.frames().irregular()},
                        {"carrier_hz", board.signal(kCarrier)},
                        {"power", board.signal(kPower)},
                        {"power_changes", board.potentiometer().bytes()}};
    json["i2c"] = {{"transfers", i2c.transfers},
                   {"bytes_written", i2c.bytes_written},
                   {"bytes_read", i2c.bytes_read},
                   {"not_acknowledged", i2c.not_acknowledged},
                   {"stretched_s", seconds(i2c.stretched)},
                   {"longest_stretch_s", seconds(i2c.longest_stretch)},
                   {"long_stretches", i2c.long_stretches},
                   {"sends", i2c.sends},
                   {"messages_read", i2c.messages},
                   {"empty_polls", i2c.empty_polls},
                   {"bad_payload_sizes", i2c.bad_sizes},
                   {"read_only_writes", i2c.read_only_writes},
                   {"unknown_writes", i2c.unknown_writes},
                   {"unknown_reads", i2c.unknown_reads}};
    return json;
}

nlohmann::ordered_json rab_json(const dspic::Chip& chip, const Board& board, const RabLog& log) {
    nlohmann::ordered_json json = board::chip_json(chip);
    json["kind"] = "range-and-bearing board, dsPIC33FJ256GP710";
    json.update(activity_json(board, log));
    json["uart1"] = board::uart_json(chip.uart_counters(1));
    json["uart2"] = board::uart_json(chip.uart_counters(2));
    return json;
}

}  // namespace puckloop::rab
