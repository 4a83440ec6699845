// Packets of GDB's remote serial protocol, and the numbers in them.

#include "debug/gdb/rsp_packet.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    const std::string_view text = text_of(input);
    debug::RspReader reader;
    reader.feed({text.data(), text.size()});
    while (const auto event = reader.next()) {
        require(event->data.size() <= debug::RspReader::kLongest, "packets no longer than the reader takes");
        std::string_view rest = event->data;
        debug::take_hex(rest);
        debug::take_char(rest, ',');
        debug::from_hex(rest);
    }
}
