#include "emu/avr/core/step_vector.h"

#include "emu/avr/core/core.h"
#include "emu/avr/isa/isa.h"
#include "emu/chip/vector_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

namespace puckloop::avr {

namespace {

using chip::Cell;
using chip::Malformed;
using chip::parse_number;
using chip::put_hex;

/// One line, read but not yet checked against the device.
struct Case {
    CoreState state;
    std::uint64_t run = 1;
    std::vector<std::uint16_t> words;
    std::vector<Cell> data;
    std::vector<Cell> program;
    bool has_r = false, has_pc = false;
};

/// GPIOR0..2: the I/O registers that are mere storage, so that vectors can use IN, OUT, SBI and their like.
constexpr std::array<std::uint16_t, 3> kGeneralPurposeIo = {0x3E, 0x4A, 0x4B};
constexpr std::uint64_t kLongestRun = 4096;
constexpr int kMostSteps = 2'000'000;

void parse_key(Case& c, std::string_view key, std::string_view value) {
    CoreState& st = c.state;
    if (key == "r") {
        const auto numbers = chip::parse_numbers(key, value, st.r.size(), 0xFF);
        std::transform(numbers.begin(), numbers.end(), st.r.begin(),
                       [](std::uint16_t number) { return static_cast<std::uint8_t>(number); });
        c.has_r = true;
    } else if (key == "sr") {
        st.sreg = static_cast<std::uint8_t>(parse_number(key, value, 0xFF));
    } else if (key == "sp") {
        st.sp = static_cast<std::uint16_t>(parse_number(key, value, 0xFFFF));
    } else if (key == "rz") {
        st.rampz = static_cast<std::uint8_t>(parse_number(key, value, 1));
    } else if (key == "pc") {
        const std::uint64_t bytes = parse_number(key, value, kProgramBytes - 1);
        if (bytes & 1) throw Malformed{fmt::format("pc: odd address {:x}", bytes)};
        st.pc = static_cast<std::uint16_t>(bytes / 2);
        c.has_pc = true;
    } else if (key == "op") {
        for (const auto piece : chip::split(value, ','))
            c.words.push_back(static_cast<std::uint16_t>(parse_number(key, piece, 0xFFFF)));
    } else if (key == "m") {
        c.data = chip::parse_cells(key, value, 0xFF, false);
    } else if (key == "p") {
        c.program = chip::parse_cells(key, value, 0xFFFF);
    } else if (key == "run") {
        c.run = parse_number(key, value, kLongestRun, 10);
        if (c.run == 0) throw Malformed{"run: expected 1 or more"};
    } else {
        throw Malformed{fmt::format("unknown key '{}'", key)};
    }
}

Case parse_case(std::string_view text) {
    Case c;
    chip::for_each_key(text,
                       [&c](std::string_view key, std::string_view value) { parse_key(c, key, value); });
    if (!c.has_r) throw Malformed{"r is missing"};
    if (!c.has_pc) throw Malformed{"pc is missing"};
    if (c.words.empty()) throw Malformed{"op is missing"};
    return c;
}

}  // namespace

struct StepMachine::Parts {
    const DeviceInfo& device;
    IoSpace io;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    std::vector<std::uint32_t> dirty;  ///< program words that the last case wrote
    std::optional<std::string> refused;

    explicit Parts(const DeviceInfo& info)
        : device(info), core(info, described(io, info), events, interrupts) {
        io.on_first_touch = [this](std::string_view name, std::uint16_t address, bool write) {
            refused = fmt::format("{} {}: a peripheral's register", write ? "writes" : "reads",
                                  name.empty() ? fmt::format("0x{:02x}", address) : std::string(name));
        };
        core.set_skip_idle(false);
        core.observer().on_warning = [this](std::string_view text, std::uint16_t) { refused = text; };
    }
    static IoSpace& described(IoSpace& space, const DeviceInfo& info) {
        space.describe(info.registers);
        return space;
    }

    std::uint8_t& byte_at(std::uint32_t address) {
        if (std::find(kGeneralPurposeIo.begin(), kGeneralPurposeIo.end(), address) != kGeneralPurposeIo.end())
            return io.raw(static_cast<std::uint16_t>(address));
        if (address < device.ram_start || address >= device.ram_end())
            throw Malformed{fmt::format("m: no RAM at {:04x}", address)};
        return core.ram()[address - device.ram_start];
    }
    void place(std::uint32_t word_address, std::uint16_t word) {
        core.set_program(word_address, word);
        dirty.push_back(word_address);
    }

    void set_up(const Case& c);
    void execute(const Case& c);
    std::string print(const Case& c, Cycle cycles);
};

void StepMachine::Parts::set_up(const Case& c) {
    for (const std::uint32_t address : dirty)
        core.set_program(address, kErasedWord);
    dirty.clear();
    refused.reset();
    const auto ram = core.ram();
    std::fill(ram.begin(), ram.end(), std::uint8_t{0});
    for (const std::uint16_t address : kGeneralPurposeIo)
        io.raw(address) = 0;
    for (const Cell& cell : c.program) {
        if (cell.address >= device.flash_bytes())
            throw Malformed{fmt::format("p: no program memory at {:06x}", cell.address)};
        place(cell.address / 2, static_cast<std::uint16_t>(cell.word));
    }
    for (std::uint32_t i = 0; i < c.words.size(); ++i)
        place((c.state.pc + i) % device.flash_words, c.words[i]);
    for (const Cell& cell : c.data)
        byte_at(cell.address) = static_cast<std::uint8_t>(cell.word);
    CoreState state = c.state;
    state.cycle = core.cycle();
    core.set_state(state);
}

void StepMachine::Parts::execute(const Case& c) {
    if (c.run == 1) return core.step();
    for (int i = 0; i < kMostSteps && !refused; ++i) {
        if (static_cast<std::uint16_t>(core.pc() - c.state.pc) >= c.run) return;
        core.step();
    }
    if (!refused) refused = fmt::format("PC does not leave the {} words", c.run);
}

std::string StepMachine::Parts::print(const Case& c, Cycle cycles) {
    const CoreState st = core.state();
    std::string out = " ok r=";
    for (std::size_t i = 0; i < st.r.size(); ++i) {
        if (i) out += ',';
        put_hex(out, st.r[i], 2);
    }
    const auto field = [&out](std::string_view key, std::uint64_t value, int digits) {
        out += ' ';
        out += key;
        out += '=';
        put_hex(out, value, digits);
    };
    field("sr", st.sreg, 2);
    field("sp", st.sp, 4);
    field("rz", st.rampz, 2);
    field("pc", 2u * st.pc, 6);
    out += " m=";
    std::map<std::uint32_t, std::uint8_t> before;  // where it was not zero
    for (const Cell& cell : c.data)
        before[cell.address] = static_cast<std::uint8_t>(cell.word);
    auto put_changed = [&, first = true](std::uint32_t address, std::uint8_t now) mutable {
        const auto old = before.find(address);
        if (now == (old == before.end() ? 0 : old->second)) return;
        if (!std::exchange(first, false)) out += ',';
        put_hex(out, address, 4);
        out += ':';
        put_hex(out, now, 2);
    };
    for (const std::uint16_t address : kGeneralPurposeIo)
        put_changed(address, io.raw(address));
    const auto ram = core.ram();
    for (std::uint32_t i = 0; i < ram.size(); ++i)
        put_changed(device.ram_start + i, ram[i]);
    return out + fmt::format(" cyc={}", cycles);
}

StepMachine::StepMachine(const DeviceInfo& device) : parts_(std::make_unique<Parts>(device)) {}
StepMachine::~StepMachine() = default;

std::string StepMachine::answer(std::string_view text) {
    const chip::Line line = chip::split_line(text);
    try {
        if (!line.has_rest) throw Malformed{"no state after the id"};
        const Case c = parse_case(line.rest);
        parts_->set_up(c);
        if (!find_form(c.words[0]))
            return line.id + fmt::format(" unsupported {:04x} is no instruction of this part", c.words[0]);
        const Cycle start = parts_->core.cycle();
        parts_->execute(c);
        if (parts_->refused) return line.id + " unsupported " + *parts_->refused;
        return line.id + parts_->print(c, parts_->core.cycle() - start);
    } catch (const Malformed& problem) {
        return line.id + " error " + problem.what;
    }
}

}  // namespace puckloop::avr
