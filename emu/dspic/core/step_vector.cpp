#include "emu/dspic/core/step_vector.h"

#include "emu/chip/vector_text.h"
#include "emu/dspic/core/core.h"
#include "emu/dspic/machine/isa.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace puckloop::dspic {

namespace {

using chip::Cell;
using chip::for_each_key;
using chip::Malformed;
using chip::parse_cells;
using chip::parse_number;
using chip::parse_numbers;
using chip::put_hex;
using chip::split;

std::int64_t sign_extend_40(std::uint64_t value) {
    return static_cast<std::int64_t>(value << 24) >> 24;
}

/// One line, read but not yet checked against the device.
struct Case {
    CoreState state;
    std::uint64_t disicnt = 0;
    std::uint64_t run = 1;
    std::vector<std::uint32_t> words;
    std::vector<Cell> data;
    std::vector<Cell> program;
    bool has_w = false, has_pc = false;
};

constexpr std::uint64_t kLongestRun = 4096;

void parse_key(Case& c, std::string_view key, std::string_view value) {
    CoreState& st = c.state;
    const auto word = [&](std::uint64_t highest) {
        return static_cast<std::uint16_t>(parse_number(key, value, highest));
    };
    const auto address = [&] {
        const auto a = static_cast<std::uint32_t>(parse_number(key, value, 0x7FFFFF));
        if (a & 1) throw Malformed{fmt::format("{}: odd address {:x}", key, a)};
        return a;
    };
    constexpr std::uint64_t k40 = (std::uint64_t{1} << 40) - 1;
    if (key == "w") {
        const auto words = parse_numbers(key, value, 16);
        std::copy(words.begin(), words.end(), st.w.begin());
        c.has_w = true;
    } else if (key == "sr") {
        st.sr = word(0xFFFF);
    } else if (key == "cc") {
        st.corcon = word(0xFFFF) & 0x1FFF;
    } else if (key == "aa" || key == "ab") {
        st.acc[key == "ab"] = sign_extend_40(parse_number(key, value, k40));
    } else if (key == "rc") {
        st.rcount = word(0x3FFF);
    } else if (key == "pc") {
        st.pc = address();
        c.has_pc = true;
    } else if (key == "tp") {
        st.tblpag = word(0xFF);
    } else if (key == "ps") {
        st.psvpag = word(0xFF);
    } else if (key == "dc") {
        st.loop.dcount = word(0x3FFF);
    } else if (key == "ds") {
        st.loop.dostart = address();
    } else if (key == "de") {
        st.loop.doend = address();
    } else if (key == "di") {
        c.disicnt = word(0x3FFF);
    } else if (key == "sh") {
        const auto words = parse_numbers(key, value, 5);
        std::copy_n(words.begin(), 4, st.shadow_w.begin());
        st.shadow_sr = words[4];
    } else if (key == "run") {
        c.run = parse_number(key, value, kLongestRun, 10);
        if (c.run == 0) throw Malformed{"run: expected 1 or more"};
    } else if (key == "op") {
        c.words.clear();
        for (const auto piece : split(value, ','))
            c.words.push_back(static_cast<std::uint32_t>(parse_number(key, piece, 0xFFFFFF)));
    } else if (key == "m") {
        c.data = parse_cells(key, value, 0xFFFF);
    } else if (key == "p") {
        c.program = parse_cells(key, value, 0xFFFFFF);
    } else {
        throw Malformed{fmt::format("unknown key '{}'", key)};
    }
}

Case parse_case(std::string_view text) {
    Case c;
    for_each_key(text, [&c](std::string_view key, std::string_view value) { parse_key(c, key, value); });
    if (!c.has_w) throw Malformed{"w is missing"};
    if (!c.has_pc) throw Malformed{"pc is missing"};
    if (c.words.empty()) throw Malformed{"op is missing"};
    return c;
}

}  // namespace

struct StepMachine::Parts {
    const DeviceInfo& device;
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    std::vector<std::uint32_t> dirty;  ///< program addresses that the last case wrote
    std::optional<std::string> interrupted;
    bool twice;

    Parts(const DeviceInfo& info, bool run_twice)
        : device(info),
          interrupts(info, described(sfr, info)),
          core(info, sfr, events, interrupts),
          twice(run_twice) {
        core.set_skip_idle(false);
        core.observer().on_reset = [this](ResetCause cause, std::uint32_t, Cycle) {
            interrupted = fmt::format("resets the part ({})", to_string(cause));
        };
        core.observer().on_trap = [this](Trap trap, std::uint32_t, Cycle) {
            interrupted = fmt::format("enters the {} trap", device.vector_name(static_cast<int>(trap)));
        };
    }
    static SfrSpace& described(SfrSpace& space, const DeviceInfo& info) {
        space.describe(info.registers);
        return space;
    }

    void place(std::string_view key, std::uint32_t address, std::uint32_t word) {
        if (!core.poke_program(address, word))
            throw Malformed{fmt::format("{}: no program memory at {:06x}", key, address)};
        dirty.push_back(address);
    }
    void place_program(const Case& c);
    void set_up(const Case& c);
    void execute(const Case& c);
    std::string print(const Case& c, Cycle cycles) const;
};

void StepMachine::Parts::place_program(const Case& c) {
    for (const std::uint32_t address : dirty)
        core.poke_program(address, kErasedWord);
    dirty.clear();
    const auto count = static_cast<std::uint32_t>(c.words.size());
    if (c.state.pc + 2 * count > device.flash_end)
        throw Malformed{fmt::format("pc: {:06x} is outside the flash of {}", c.state.pc, device.name)};
    for (const Cell& cell : c.program)
        place("p", cell.address, cell.word);
    for (std::uint32_t i = 0; i < count; ++i)
        place("op", c.state.pc + 2 * i, c.words[i]);
}

void StepMachine::Parts::set_up(const Case& c) {
    interrupted.reset();
    sfr.reset_values();
    interrupts.reset();
    const auto ram = core.ram();
    std::fill(ram.begin(), ram.end(), std::uint16_t{0});
    for (const Cell& cell : c.data) {
        if (cell.address < device.ram_start || cell.address >= device.ram_end)
            throw Malformed{fmt::format("m: no RAM at {:04x}", cell.address)};
        ram[(cell.address - device.ram_start) / 2] = static_cast<std::uint16_t>(cell.word);
    }
    CoreState state = c.state;
    state.cycle = core.cycle();
    state.disi_end = state.cycle + c.disicnt;
    state.loop_shadow = {};
    core.set_state(state);
}

void StepMachine::Parts::execute(const Case& c) {
    if (c.run == 1) return core.step();
    const std::uint32_t end = c.state.pc + 2 * static_cast<std::uint32_t>(c.run);
    constexpr int kMostSteps = 2'000'000;
    for (int i = 0; i < kMostSteps && !interrupted; ++i) {
        const std::uint32_t pc = core.pc();
        if (pc < c.state.pc || pc >= end) return;
        core.step();
    }
    if (!interrupted) interrupted = fmt::format("PC does not leave the {} words", c.run);
}

std::string StepMachine::Parts::print(const Case& c, Cycle cycles) const {
    const CoreState st = core.state();
    std::string out = " ok w=";
    for (std::size_t i = 0; i < 16; ++i) {
        if (i) out += ',';
        put_hex(out, i == 15 ? st.w[i] & 0xFFFEu : st.w[i], 4);  // bit 0 of W15 always reads 0
    }
    const auto field = [&out](std::string_view key, std::uint64_t value, int digits) {
        out += ' ';
        out += key;
        out += '=';
        put_hex(out, value, digits);
    };
    field("sr", st.sr, 4);
    field("cc", st.corcon & ~corcon::EDT, 4);
    field("aa", static_cast<std::uint64_t>(st.acc[0]), 10);
    field("ab", static_cast<std::uint64_t>(st.acc[1]), 10);
    field("rc", st.rcount, 4);
    field("pc", st.pc, 6);
    field("tp", st.tblpag, 2);
    field("ps", st.psvpag, 2);
    field("dc", st.loop.dcount, 4);
    field("ds", st.loop.dostart, 6);
    field("de", st.loop.doend, 6);
    field("di", st.disi_end > st.cycle ? st.disi_end - st.cycle : 0, 4);
    out += " sh=";
    for (const std::uint16_t w : st.shadow_w) {
        put_hex(out, w, 4);
        out += ',';
    }
    put_hex(out, st.shadow_sr, 4);

    // RAM before the case: zero but for the given words.
    std::vector<Cell> before = c.data;
    std::stable_sort(before.begin(), before.end(),
                     [](const Cell& a, const Cell& b) { return a.address < b.address; });
    out += " m=";
    const auto ram = const_cast<Core&>(core).ram();
    std::size_t next = 0;
    bool first = true;
    for (std::size_t i = 0; i < ram.size(); ++i) {
        const auto address = static_cast<std::uint32_t>(device.ram_start + 2 * i);
        std::uint32_t old = 0;
        for (; next < before.size() && before[next].address <= address; ++next)
            if (before[next].address == address) old = before[next].word;
        if (ram[i] == old) continue;
        if (!first) out += ',';
        first = false;
        put_hex(out, address, 4);
        out += ':';
        put_hex(out, ram[i], 4);
    }
    out += fmt::format(" cyc={}", cycles);
    return out;
}

StepMachine::StepMachine(const DeviceInfo& device, bool twice)
    : parts_(std::make_unique<Parts>(device, twice)) {}
StepMachine::~StepMachine() = default;

std::string StepMachine::answer(std::string_view line) {
    const chip::Line parts = chip::split_line(line);
    const std::string& id = parts.id;
    try {
        if (!parts.has_rest) throw Malformed{"no state after the id"};
        const Case c = parse_case(parts.rest);
        parts_->place_program(c);
        parts_->set_up(c);
        if (!find_form(c.words[0]))
            return id + fmt::format(" unsupported {:06x} is no instruction", c.words[0]);
        if (parts_->twice) {
            parts_->execute(c);
            parts_->set_up(c);
        }
        const Cycle start = parts_->core.cycle();
        parts_->execute(c);
        if (parts_->interrupted) return id + " unsupported " + *parts_->interrupted;
        return id + parts_->print(c, parts_->core.cycle() - start);
    } catch (const Malformed& problem) {
        return id + " error " + problem.what;
    }
}

}  // namespace puckloop::dspic
