#include "benchmark/speeds/prompt_module.h"

#include "protocols/radio/xbee_message.h"

#include <string>
#include <variant>

namespace puckloop::tools {

using namespace protocols;

namespace {

std::vector<std::uint8_t> bytes_of(const XBeeMessage& message) {
    return encode_xbee(encode(message), XBeeApiMode::Escaped);
}

}  // namespace

std::vector<std::uint8_t> PromptModule::hello() {
    return bytes_of(XBeeModemStatus{});
}

std::vector<std::uint8_t> PromptModule::take(std::uint8_t byte) {
    const auto reading = reader_.take(byte);
    if (!reading || !reading->ok()) return {};
    const XBeeMessage message = decode_xbee(reading->data);
    if (const auto* data = std::get_if<XBeeTx>(&message)) return bytes_of(XBeeTxStatus{.id = data->id});
    const auto* command = std::get_if<XBeeAt>(&message);
    if (!command) return {};
    XBeeAtResponse response{.command = command->command, .value = {}};
    const std::string name(command->command.begin(), command->command.end());
    constexpr std::uint8_t kFound = 0x40;  // what the original firmware wants (TAM fact sheet, section 6)
    if (name == "DN") {
        response.status = kFound;
        response.value = {0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x8A, 0x31, 0x07};
    } else if (name == "NI") {
        response.value = {'T', 'A', 'M', '0', '1'};
    } else if (name != "NT") {
        response.value = {0, 0, 0, 1};
    }
    return bytes_of(response);
}

}  // namespace puckloop::tools
