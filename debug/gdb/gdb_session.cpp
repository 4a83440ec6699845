#include "debug/gdb/gdb_session.h"

#include <fmt/format.h>

#include <utility>

namespace puckloop::debug {

namespace {

constexpr std::string_view kOk = "OK", kError = "E01", kFrozen = "E02";
constexpr std::size_t kMostMemory = 0x4000;  ///< bytes in one packet

std::string little_endian(std::uint64_t value, int bits) {
    std::string hex;
    for (int shift = 0; shift < bits; shift += 8)
        hex += fmt::format("{:02x}", value >> shift & 0xFF);
    return hex;
}

std::uint64_t number_of(std::span<const std::uint8_t> bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = bytes.size(); i > 0; --i)
        value = value << 8 | bytes[i - 1];
    return value;
}

std::optional<std::uint32_t> take_address(std::string_view& text) {
    const auto number = take_hex(text);
    if (!number || *number > 0xFFFFFFFF) return std::nullopt;
    return static_cast<std::uint32_t>(*number);
}

}  // namespace

Resume GdbSession::serve(const Stop& stop) {
    on_stop(stop);
    while (true)
        if (const std::optional<Resume> wanted = poll(true)) return *wanted;
}

void GdbSession::on_stop(const Stop& stop) {
    stop_ = stop;
    resume_.reset();
    if (std::exchange(awaited_, false)) send(stop_reply());
}

std::optional<Resume> GdbSession::poll(bool wait) {
    if (!socket_.connected()) {
        fmt::print(stderr, "gdb: the debugger at {} has left; the program runs on, and another may connect\n",
                   socket_.address());
        return Resume::Detach;
    }
    reader_.feed(socket_.read(wait, cancelled_));
    if (cancelled_ && cancelled_()) return Resume::Kill;
    while (const std::optional<RspEvent> event = resume_ ? std::nullopt : reader_.next()) {
        if (event->kind == RspEvent::Kind::Again) socket_.write(last_);
        if (event->kind == RspEvent::Kind::Damaged && acknowledges_) socket_.write("-");
        if (event->kind != RspEvent::Kind::Packet) continue;
        if (acknowledges_) socket_.write("+");
        const std::string reply = answer(event->data);
        if (!resume_ || *resume_ == Resume::Detach) send(reply);
        if (std::exchange(stop_acknowledging_, false)) acknowledges_ = false;
    }
    if (!resume_) return std::nullopt;
    awaited_ = *resume_ != Resume::Detach && *resume_ != Resume::Kill;
    if (!awaited_) {
        socket_.hang_up();
        acknowledges_ = true;
        reader_ = {};
    }
    return resume_;
}

bool GdbSession::wants_stop() {
    if (!socket_.connected()) {
        if (!socket_.accept_now()) return false;
        acknowledges_ = true;
        awaited_ = false;
        reader_ = {};
        return true;
    }
    reader_.feed(socket_.read(false, nullptr));
    if (!socket_.connected()) return true;
    while (const std::optional<RspEvent> event = reader_.next())
        if (event->kind == RspEvent::Kind::Interrupt) return true;
    return false;
}

void GdbSession::on_exit(int status) {
    if (std::exchange(awaited_, false)) send(fmt::format("W{:02x}", status & 0xFF));
    socket_.hang_up();
}

void GdbSession::send(std::string_view data) {
    last_ = rsp_packet(data);
    socket_.write(last_);
}

std::string GdbSession::stop_reply() const {
    constexpr int kSigInt = 2, kSigTrap = 5;
    std::string reply = fmt::format("T{:02x}", stop_.why == Stop::Why::Interrupt ? kSigInt : kSigTrap);
    if (stop_.why == Stop::Why::Begin) reply += "replaylog:begin;";
    if (stop_.why == Stop::Why::Watch) {
        const char* const kinds[] = {"watch", "rwatch", "awatch"};
        // GDB looks for the watchpoint that holds this address; a word's access may begin below it.
        const std::uint16_t place = std::max(stop_.touched, stop_.watch.start);
        reply += fmt::format("{}:{:x};", kinds[static_cast<int>(stop_.watch.kind)],
                             debuggee_.chip().address_of_data(place));
    }
    return reply;
}

std::string GdbSession::answer(std::string_view packet) {
    if (packet.empty()) return {};
    const std::string_view whole = packet;
    const char command = packet.front();
    packet.remove_prefix(1);
    switch (command) {
    case '?':
        return stop_reply();
    case 'g':
        return read_registers();
    case 'G':
        return write_registers(packet);
    case 'p':
    case 'P':
        return one_register(packet, command == 'P');
    case 'm':
        return memory(packet, false, false);
    case 'M':
    case 'X':
        return memory(packet, true, command == 'X');
    case 'Z':
    case 'z':
        return point(packet, command == 'Z');
    case 's':
        return resume(Resume::Step, packet);
    case 'c':
        return resume(Resume::Continue, packet);
    case 'b':
        if (!debuggee_.reverses()) return std::string(kError);
        if (const std::string why = debuggee_.no_way_back(); !why.empty()) return "E." + why;
        if (packet == "s") return resume(Resume::ReverseStep);
        if (packet == "c") return resume(Resume::ReverseContinue);
        return {};
    case 'D':
        resume(Resume::Detach);
        return std::string(kOk);
    case 'k':
        return resume(Resume::Kill);
    case 'H':
        return std::string(kOk);
    case 'T':
        return std::string(kOk);
    case 'v':
        if (whole == "vCont?") return "vCont;c;C;s;S";
        if (whole.starts_with("vCont;c") || whole.starts_with("vCont;C")) return resume(Resume::Continue);
        if (whole.starts_with("vCont;s") || whole.starts_with("vCont;S")) return resume(Resume::Step);
        if (whole.starts_with("vKill")) {
            send(kOk);
            return resume(Resume::Kill);
        }
        return {};
    case 'q':
    case 'Q':
        return query(whole);
    default:
        return {};
    }
}

std::string GdbSession::query(std::string_view packet) {
    if (packet.starts_with("qSupported"))
        return fmt::format("PacketSize={:x};QStartNoAckMode+;qXfer:features:read+;swbreak-;hwbreak-"
                           ";ReverseStep{};ReverseContinue{};vContSupported+",
                           RspReader::kLongest, debuggee_.reverses() ? '+' : '-',
                           debuggee_.reverses() ? '+' : '-');
    if (packet == "QStartNoAckMode") {
        stop_acknowledging_ = true;
        return std::string(kOk);
    }
    if (packet.starts_with("qXfer:")) return transfer(packet);
    if (packet == "qAttached") return "1";
    if (packet == "qC") return "QC1";
    if (packet == "qfThreadInfo") return "m1";
    if (packet == "qsThreadInfo") return "l";
    if (packet.starts_with("qSymbol")) return std::string(kOk);
    constexpr std::string_view kMonitor = "qRcmd,";
    if (packet.starts_with(kMonitor)) {
        const auto bytes = from_hex(packet.substr(kMonitor.size()));
        if (!bytes) return std::string(kError);
        return to_hex(monitor(debuggee_, std::string(bytes->begin(), bytes->end())));
    }
    return {};
}

std::string GdbSession::transfer(std::string_view packet) const {
    constexpr std::string_view kFeatures = "qXfer:features:read:target.xml:";
    if (!packet.starts_with(kFeatures)) return packet.starts_with("qXfer:features:read:") ? "E00" : "";
    packet.remove_prefix(kFeatures.size());
    const auto offset = take_hex(packet);
    if (!offset || !take_char(packet, ',')) return "E00";
    const auto size = take_hex(packet);
    if (!size || !packet.empty()) return "E00";
    const std::string text = target_description(debuggee_.chip());
    if (*offset >= text.size()) return "l";
    const std::string part = text.substr(static_cast<std::size_t>(*offset), static_cast<std::size_t>(*size));
    return (*offset + part.size() < text.size() ? "m" : "l") + part;
}

std::string GdbSession::read_registers() const {
    const DebugChip& chip = debuggee_.chip();
    std::string hex;
    for (std::size_t i = 0; i < chip.registers().size(); ++i)
        hex += little_endian(chip.read_register(i), chip.registers()[i].bits);
    return hex;
}

std::string GdbSession::changed(std::function<bool(DebugChip&)> change) {
    if (!debuggee_.frozen().empty()) return std::string(kFrozen);
    return std::string(debuggee_.change(std::move(change)) ? kOk : kError);
}

std::string GdbSession::write_registers(std::string_view hex) {
    const auto bytes = from_hex(hex);
    const auto registers = debuggee_.chip().registers();
    std::size_t size = 0;
    for (const RegisterInfo& info : registers)
        size += static_cast<std::size_t>(info.bits) / 8;
    if (!bytes || bytes->size() != size) return std::string(kError);
    return changed([bytes = *bytes](DebugChip& chip) {
        std::span<const std::uint8_t> rest = bytes;
        for (std::size_t i = 0; i < chip.registers().size(); ++i) {
            const std::size_t width = static_cast<std::size_t>(chip.registers()[i].bits) / 8;
            const std::uint64_t value = number_of(rest.first(width));
            rest = rest.subspan(width);
            // What is not changed is not written: writing a register may do something.
            const int unused = 64 - chip.registers()[i].bits;
            if (chip.read_register(i) << unused == value << unused) continue;
            if (!chip.write_register(i, value)) return false;
        }
        return true;
    });
}

std::string GdbSession::one_register(std::string_view packet, bool write) {
    const auto number = take_hex(packet);
    const auto registers = debuggee_.chip().registers();
    if (!number || *number >= registers.size()) return std::string(kError);
    const auto index = static_cast<std::size_t>(*number);
    if (!write) {
        if (!packet.empty()) return std::string(kError);
        return little_endian(debuggee_.chip().read_register(index), registers[index].bits);
    }
    const auto bytes = take_char(packet, '=') ? from_hex(packet) : std::nullopt;
    if (!bytes || bytes->size() != static_cast<std::size_t>(registers[index].bits) / 8)
        return std::string(kError);
    return changed(
        [index, value = number_of(*bytes)](DebugChip& chip) { return chip.write_register(index, value); });
}

std::string GdbSession::memory(std::string_view packet, bool write, bool binary) {
    const auto address = take_address(packet);
    if (!address || !take_char(packet, ',')) return std::string(kError);
    const auto size = take_hex(packet);
    if (!size || *size > kMostMemory) return std::string(kError);
    if (!write) {
        if (!packet.empty()) return std::string(kError);
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(*size));
        if (!debuggee_.chip().read_memory(*address, bytes)) return std::string(kError);
        return to_hex(bytes);
    }
    if (!take_char(packet, ':')) return std::string(kError);
    std::optional<std::vector<std::uint8_t>> bytes;
    if (binary)
        bytes.emplace(packet.begin(), packet.end());
    else
        bytes = from_hex(packet);
    if (!bytes || bytes->size() != *size) return std::string(kError);
    if (bytes->empty()) return std::string(kOk);
    return changed([at = *address, bytes = *bytes](DebugChip& chip) { return chip.write_memory(at, bytes); });
}

std::string GdbSession::point(std::string_view packet, bool insert) {
    const auto type = take_hex(packet);
    if (!type || !take_char(packet, ',')) return std::string(kError);
    const auto address = take_address(packet);
    if (!address || !take_char(packet, ',')) return std::string(kError);
    const auto size = take_hex(packet);
    if (!size) return std::string(kError);
    constexpr std::uint64_t kSoftware = 0, kHardware = 1, kWrite = 2, kAccess = 4;
    if (*type > kAccess) return {};
    StopControl& control = debuggee_.control();
    if (*type == kSoftware || *type == kHardware) {
        if (!debuggee_.chip().is_code(*address)) return std::string(kError);
        insert ? control.add_break(*address) : control.remove_break(*address);
        return std::string(kOk);
    }
    const auto data = debuggee_.chip().data_address(*address);
    constexpr std::uint64_t kLargest = 0x1000;
    if (!data || *size == 0 || *size > kLargest) return std::string(kError);
    const Watchpoint watch{*data, static_cast<std::uint32_t>(*size), static_cast<WatchKind>(*type - kWrite)};
    insert ? control.add_watch(watch) : control.remove_watch(watch);
    return std::string(kOk);
}

std::string GdbSession::resume(Resume how, std::string_view address) {
    if (!address.empty()) {
        const auto pc = take_address(address);
        if (!pc) return std::string(kError);
        const std::string reply = changed([at = *pc](DebugChip& chip) {
            for (std::size_t i = 0; i < chip.registers().size(); ++i)
                if (chip.registers()[i].type == "code_ptr") return chip.write_register(i, at);
            return false;
        });
        if (reply != kOk) return reply;
    }
    resume_ = how;
    return {};
}

std::string target_description(const DebugChip& chip) {
    std::string xml =
        "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n<target version=\"1.0\">\n";
    if (!chip.architecture().empty()) {
        // GDB's own description of the family's registers holds.
        return xml + fmt::format("<architecture>{}</architecture>\n</target>\n", chip.architecture());
    }
    xml += fmt::format("<feature name=\"org.puckloop.{}.cpu\">\n", chip.name());
    for (const RegisterInfo& info : chip.registers())
        xml += fmt::format("<reg name=\"{}\" bitsize=\"{}\"{}/>\n", info.name, info.bits,
                           info.type.empty() ? std::string() : fmt::format(" type=\"{}\"", info.type));
    return xml + "</feature>\n</target>\n";
}

}  // namespace puckloop::debug
