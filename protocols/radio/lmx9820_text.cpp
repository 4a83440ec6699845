// Names of opcodes and error codes, and packets as lines for people.

#include "protocols/radio/lmx9820_packet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::protocols {

namespace {

struct Opcode {
    std::uint8_t code;
    std::string_view name;
    // What the data are: one letter a field. s status, b address, c class of device, p port, u octet,
    // w 16 bits, n text with its length before it, d data with 16 bits of length before it.
    std::string_view request{}, confirm = "s", indication{};
};

constexpr auto kOpcodes = std::to_array<Opcode>({
    {0x00, "GAP_INQUIRY", "uuu"},
    {0x01, "GAP_DEVICE_FOUND", "", "", "bc"},
    {0x02, "GAP_REMOTE_DEVICE_NAME", "b", "sbn"},
    {0x03, "GAP_READ_LOCAL_NAME", "", "sn"},
    {0x04, "GAP_WRITE_LOCAL_NAME", "n"},
    {0x05, "GAP_READ_LOCAL_BDA", "", "sb"},
    {0x06, "GAP_SET_SCANMODE", "uu"},
    {0x07, "SPP_SET_PORT_CONFIG"},
    {0x08, "SPP_GET_PORT_CONFIG", "p"},
    {0x09, "SPP_PORT_CONFIG_CHANGED"},
    {0x0A, "SPP_ESTABLISH_LINK", "pbp", "sp"},
    {0x0B, "SPP_LINK_ESTABLISHED", "", "", "sbpp"},
    {0x0C, "SPP_INCOMING_LINK_ESTABLISHED", "", "", "bp"},
    {0x0D, "SPP_RELEASE_LINK", "p", "sp"},
    {0x0E, "SPP_LINK_RELEASED", "", "", "up"},
    {0x0F, "SPP_SEND_DATA", "pd", "sp"},
    {0x10, "SPP_INCOMING_DATA", "", "", "pd"},
    {0x11, "SPP_TRANSPARENT_MODE", "p", "sp", "pu"},
    {0x12, "SPP_CONNECT_DEFAULT_CON", "u"},
    {0x13, "SPP_STORE_DEFAULT_CON", "upbp"},
    {0x14, "SPP_GET_LIST_DEFAULT_CON", "", "su"},
    {0x15, "SPP_DELETE_DEFAULT_CON", "u"},
    {0x16, "GAP_GET_FIXED_PIN", "", "sn"},
    {0x17, "GAP_SET_FIXED_PIN", "n"},
    {0x18, "GAP_GET_SECURITY_MODE", "", "su"},
    {0x19, "GAP_SET_SECURITY_MODE", "u"},
    {0x1A, "RESTORE_FACTORY_SETTINGS"},
    {0x1B, "GAP_REMOVE_PAIRING", "b"},
    {0x1C, "GAP_LIST_PAIRED_DEVICES", "", "su"},
    {0x1D, "FORCE_MASTER_ROLE", "u"},
    {0x1E, "SDAP_SERVICE_REQUEST"},
    {0x1F, "GET_PORTS_TO_OPEN"},
    {0x20, "READ_RSSI", "b", "su"},
    {0x21, "GAP_ENTER_SNIFF_MODE"},
    {0x22, "SET_PORTS_TO_OPEN"},
    {0x23, "CHANGE_NVS_UART_SPEED", "u"},
    {0x24, "TEST_MODE"},
    {0x25, "READY", "", "", "n"},
    {0x26, "RESET"},
    {0x27, "CHANGE_LOCAL_BDADDRESS", "b"},
    {0x28, "STORE_CLASS_OF_DEVICE", "c"},
    {0x29, "ENABLE_SDP_RECORD"},
    {0x2A, "DELETE_SDP_RECORDS"},
    {0x2B, "STORE_SPP_RECORD"},
    {0x2C, "STORE_DUN_RECORD"},
    {0x2D, "STORE_FAX_RECORD"},
    {0x2E, "STORE_OPP_RECORD"},
    {0x2F, "STORE_FTP_RECORD"},
    {0x30, "STORE_SYNC_RECORD"},
    {0x32, "SDAP_CONNECT", "b"},
    {0x33, "SDAP_DISCONNECT"},
    {0x34, "SDAP_CONNECTION_LOST"},
    {0x35, "SDAP_SERVICE_BROWSE"},
    {0x36, "SDAP_SERVICE_SEARCH"},
    {0x37, "GAP_EXIT_SNIFF_MODE"},
    {0x38, "GAP_ENTER_PARK_MODE"},
    {0x39, "GAP_EXIT_PARK_MODE"},
    {0x3A, "GAP_ENTER_HOLD_MODE"},
    {0x3B, "GAP_SET_LINK_POLICY"},
    {0x3C, "GAP_GET_LINK_POLICY"},
    {0x3D, "GAP_POWER_SAVE_MODE_CHANGED"},
    {0x3E, "SPP_PORT_STATUS_CHANGED"},
    {0x3F, "SDAP_ATTRIBUTE_REQUEST"},
    {0x40, "SPP_GET_PORT_STATUS"},
    {0x41, "SPP_PORT_SET_DTR"},
    {0x42, "SPP_PORT_SET_RTS"},
    {0x43, "SPP_PORT_BREAK"},
    {0x44, "SPP_PORT_OVERRUN_ERROR"},
    {0x45, "SPP_PORT_PARITY_ERROR"},
    {0x46, "SPP_PORT_FRAMING_ERROR"},
    {0x47, "FIRMWARE_UPGRADE"},
    {0x48, "CHANGE_UART_SETTINGS", "uuu"},
    {0x49, "READ_OPERATION_MODE", "", "su"},
    {0x4A, "WRITE_OPERATION_MODE", "u"},
    {0x4B, "RF_TEST_MODE"},
    {0x4C, "SET_DEFAULT_LINK_POLICY", "w"},
    {0x4D, "GET_DEFAULT_LINK_POLICY", "", "sw"},
    {0x4E, "SET_EVENT_FILTER", "u"},
    {0x4F, "GET_EVENT_FILTER", "", "su"},
    {0x50, "GAP_ACL_ESTABLISHED", "", "", "bu"},
    {0x51, "GAP_ACL_TERMINATED", "", "", "bu"},
    {0x52, "DISABLE_TL"},
    {0x53, "TL_ENABLED"},
    {0x55, "SET_DEFAULT_LINK_TIMEOUT", "w"},
    {0x56, "GET_DEFAULT_LINK_TIMEOUT", "", "sw"},
    {0x57, "SPP_SET_LINK_TIMEOUT", "pw", "sp"},
    {0x58, "SPP_GET_LINK_TIMEOUT", "p", "spw"},
});

constexpr auto kErrors = std::to_array<std::string_view>({
    "OK",
    "INVALID_NO_OF_PARAMETERS",
    "DURATION_OUT_OF_RANGE",
    "INVALID_MODE",
    "TIMEOUT",
    "UNKNOWN_ERROR",
    "NAME_TOO_LONG",
    "INVALID_DISCOVERABILITY_PARAMETER",
    "INVALID_CONNECTABILITY_PARAMETER",
    "INVALID_SECURITY_MODE",
    "LINKKEY_DOES_NOT_EXIST",
    "CONNECTION_FAILED",
    "TRUNCATED_ANSWER",
    "RESULT_TOO_LARGE",
    "NOT_POSSIBLE_TO_ENTER_TESTMODE",
    "ILLEGAL_TESTMODE",
    "RESET_TO_NSC_BDADDRESS",
    "UART_SPEED_OUT_OF_RANGE",
    "INVALID_PORT",
    "ILLEGAL_STATE_VALUE",
    "IDENTIFIER_OUT_OF_RANGE",
    "RECORD_ALREADY_IN_SELECTED_STATE",
    "INVALID_AUTHENTICATION_VALUE",
    "INVALID_ENCRYPTION_VALUE",
    "MAXIMUM_NO_OF_SERVICE_RECORDS_REACHED",
    "WRITING_TO_NVS",
    "INVALID_ROLE",
    "LIMIT",
    "UNEXPECTED",
    "UNABLE_TO_SEND",
    "CURRENTLY_NO_BUFFER",
    "NO_CONNECTION",
    "SPP_INVALID_PORT",
    "SPP_PORT_NOT_OPEN",
    "SPP_PORT_BUSY",
    "SPP_MULTIPLE_CONNECTIONS",
    "SPP_MULTIPLE_TRANSPARENT",
    "SPP_DEFAULT_CONNECTION_NOT_STORED",
    "SPP_AUTOMATIC_CONNECTIONS_PROGRESSING",
    "UNSPECIFIED_ERROR",
    "IDENTIFIER_NOT_IN_USE",
    "INVALID_SUPPORTED_FAXCLASS_VALUE",
    "TOO_MANY_SUPPORTED_FORMATS",
    "TOO_MANY_DATASTORES",
    "ATTEMPT_FAILED",
    "ILLEGAL_LINK_POLICY",
    "PINCODE_TOO_LONG",
    "PARITY_BIT_OUT_OF_RANGE",
    "STOP_BITS_OUT_OF_RANGE",
});

const Opcode* find(std::uint8_t opcode) {
    const auto found = std::find_if(kOpcodes.begin(), kOpcodes.end(),
                                    [&](const Opcode& entry) { return entry.code == opcode; });
    return found == kOpcodes.end() ? nullptr : &*found;
}

std::string_view type_name(std::uint8_t type) {
    if (type == kLmxRequest) return "REQ";
    if (type == kLmxConfirm) return "CFM";
    return type == kLmxIndication ? "IND" : "RES";
}

std::string quoted(std::span<const std::uint8_t> text) {
    std::string result = "\"";
    for (const std::uint8_t c : text) {
        if (c >= 0x20 && c < 0x7f && c != '"' && c != '\\')
            result += static_cast<char>(c);
        else
            result += fmt::format("\\x{:02x}", c);
    }
    return result + '"';
}

std::string hex(std::span<const std::uint8_t> octets) {
    std::string result;
    for (const std::uint8_t octet : octets)
        result += fmt::format("{}{:02x}", result.empty() ? "" : " ", octet);
    return result;
}

/// Octets of the field at the front of `data`; 0 where it is cut short.
std::size_t size_of(char field, std::span<const std::uint8_t> data) {
    std::size_t size = 1;
    if (field == 'b') size = 6;
    if (field == 'c') size = 3;
    if (field == 'w') size = 2;
    if (field == 'n') size = data.empty() ? 1 : 1 + std::size_t{data[0]};
    if (field == 'd') size = data.size() < 2 ? 2 : 2 + (data[0] | std::size_t{data[1]} << 8);
    return size <= data.size() ? size : 0;
}

std::string field_text(char field, std::span<const std::uint8_t> data) {
    if (field == 's') return lmx_error_name(data[0]);
    if (field == 'b') return lmx_address_text(data);
    if (field == 'c') return fmt::format("class={:02X}{:02X}{:02X}", data[2], data[1], data[0]);
    if (field == 'p') return fmt::format("port={}", data[0]);
    if (field == 'w') return fmt::format("{}", data[0] | data[1] << 8);
    if (field == 'n') return quoted(data.subspan(1));
    if (field == 'd') return quoted(data.subspan(2));
    return fmt::format("{}", data[0]);
}

}  // namespace

std::string lmx_opcode_name(std::uint8_t opcode) {
    const Opcode* entry = find(opcode);
    return entry != nullptr ? std::string(entry->name) : fmt::format("0x{:02x}", opcode);
}

std::string lmx_error_name(std::uint8_t error) {
    return error < kErrors.size() ? std::string(kErrors[error]) : fmt::format("0x{:02x}", error);
}

std::string to_text(const LmxPacket& packet) {
    std::string text = fmt::format("{} {}", type_name(packet.type), lmx_opcode_name(packet.opcode));
    const Opcode* entry = find(packet.opcode);
    std::string_view fields;
    if (entry != nullptr && packet.type == kLmxRequest) fields = entry->request;
    if (entry != nullptr && packet.type == kLmxConfirm) fields = entry->confirm;
    if (entry != nullptr && packet.type == kLmxIndication) fields = entry->indication;
    std::span<const std::uint8_t> rest = packet.data;
    for (const char field : fields) {
        const std::size_t size = size_of(field, rest);
        if (size == 0) break;
        text += ' ' + field_text(field, rest.first(size));
        rest = rest.subspan(size);
    }
    if (!rest.empty()) text += " data=" + hex(rest);
    return text;
}

}  // namespace puckloop::protocols
