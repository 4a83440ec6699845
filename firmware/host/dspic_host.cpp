#include "firmware/host/dspic_host.h"

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/core/core.h"
#include "emu/image/image.h"
#include "firmware/host/register_objects.h"

namespace hosted {

namespace {

namespace dspic = puckloop::dspic;

// What the chip's core executes. Program addresses and words (isa.csv).
constexpr std::uint32_t kLoop = 0x37FFFF, kNext = 0x370000, kRetfie = 0x064000, kIdleWord = 0xFE4001,
                        kDisiWord = 0xFC0000, kMostDisi = 0x3FFF;
constexpr std::uint32_t kMain = 0x200;                             // the loop of the main program
constexpr std::uint32_t kIdle = 0x204, kAwake = 0x206;             // PWRSAV, and where it goes on
constexpr std::uint32_t kDisi = 0x20C;                             // DISI #n, rewritten before each use
constexpr std::uint32_t kAssembly = 0x280;                         // what assembly() runs
constexpr std::uint32_t kRoutines = 0x400, kRoutineAddresses = 6;  // entry, loop, RETFIE
constexpr std::uint32_t kVectorTable = 0x04;
constexpr std::uint32_t kConfiguration = 0xF80000;

/// The instructions among the pieces in quotes up to the first colon outside of any.
std::string instructions_of(const std::string& text) {
    std::string found;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size() && (quoted || text[i] != ':'); ++i) {
        if (text[i] == '"')
            quoted = !quoted;
        else if (quoted && text[i] == '\\' && i + 1 < text.size())
            found += text[++i] == 'n' ? '\n' : ' ';
        else if (quoted)
            found += text[i];
    }
    return found;
}

}  // namespace

DspicHost::DspicHost(const dspic::DeviceInfo& device, dspic::Pins& pins, const dspic::ChipOptions& options,
                     const std::string& image_file, std::span<const Vector> vectors)
    : chip_(device, pins, options),
      routines_(static_cast<std::size_t>(dspic::kTrapVectors + device.irq_count)) {
    for (const auto& [address, word] : puckloop::image::load_image(image_file).config)
        if (address >= kConfiguration) chip_.load_word(address, word);
    chip_.load_word(0, kLoop);
    chip_.load_word(kMain, kLoop);
    chip_.load_word(kIdle, kIdleWord);
    chip_.load_word(kAwake, kNext);
    chip_.load_word(kAwake + 2, kLoop);
    chip_.load_word(kDisi, kDisiWord);
    chip_.load_word(kDisi + 2, kLoop);
    for (const Vector& vector : vectors)
        routines_[static_cast<std::size_t>(vector.number)] = vector.routine;
    const int last = dspic::kTrapVectors + device.irq_count;
    std::vector<std::uint32_t> stops{0, kAwake};
    for (int i = 0; i < last; ++i) {
        const std::uint32_t entry = kRoutines + kRoutineAddresses * static_cast<std::uint32_t>(i);
        chip_.load_word(kVectorTable + 2 * static_cast<std::uint32_t>(i), entry);
        chip_.load_word(entry, kNext);
        chip_.load_word(entry + 2, kLoop);
        chip_.load_word(entry + 4, kRetfie);
        stops.push_back(entry);
    }
    chip_.set_skipping(false);
    chip_.power_on();
    chip_.set_stops(stops);
    chip_.inside().core.set_pc(kMain);
}

std::uint16_t DspicHost::read_word(std::uint16_t address) {
    if (address & 1) fail("address error: a word at an odd address", address, 0);
    return chip_.inside().core.read_data(address);
}
void DspicHost::write_word(std::uint16_t address, std::uint16_t value) {
    if (address & 1) fail("address error: a word at an odd address", address, value);
    chip_.inside().core.write_data(address, value);
}
std::uint8_t DspicHost::read_byte(std::uint16_t) {
    fail("the dsPIC's registers are words", 0, 0);
}
void DspicHost::write_byte(std::uint16_t, std::uint8_t) {
    fail("the dsPIC's registers are words", 0, 0);
}

void DspicHost::run_to(Cycle end) {
    chip_.run_until(chip_.clock().time_of(end));
    // An interrupt that was entered in the last cycles is at its routine, too, though not stopped there.
    const std::uint32_t pc = chip_.pc();
    if (pc == 0 || (pc >= kRoutines && (pc - kRoutines) % kRoutineAddresses == 0)) serve(pc);
}

void DspicHost::serve(std::uint32_t stop) {
    if (stop < kRoutines) fail("the chip was reset; RCON", chip_.peek("RCON"), 0);
    const std::uint32_t number = (stop - kRoutines) / kRoutineAddresses;
    void (*routine)() = routines_.at(number);
    if (routine == nullptr) fail("trap or interrupt without a routine: vector", number, 0);
    dspic::Core& core = chip_.inside().core;
    core.set_pc(stop + 2);
    call(routine);
    run_one(stop + 4);
}

/// Executes the instruction there, and the interrupts that come before it.
void DspicHost::run_one(std::uint32_t pc) {
    dspic::Core& core = chip_.inside().core;
    core.set_pc(pc);
    while (core.pc() == pc)
        run_to(cycle() + 1);
}

void DspicHost::idle() {
    touch();
    dspic::Core& core = chip_.inside().core;
    const std::uint32_t back = core.pc();
    core.set_pc(kIdle);
    while (core.pc() != kAwake || core.power_mode() != dspic::PowerMode::Run) {
        act_if_due();
        run_to(due());
    }
    core.set_pc(back);
}

void DspicHost::no_interrupts(unsigned cycles) {
    if (cycles > kMostDisi) fail("DISI counts up to 16383: a", cycles, 0);
    dspic::Core& core = chip_.inside().core;
    const std::uint32_t back = core.pc();
    core.poke_program(kDisi, kDisiWord | cycles);
    run_one(kDisi);
    core.set_pc(back);
}

void DspicHost::assembly(const std::string& text) {
    dspic::Core& core = chip_.inside().core;
    const std::uint32_t back = core.pc();
    std::uint32_t end = kAssembly;
    for (const std::uint32_t word : dspic::assemble_words(instructions_of(text), kAssembly)) {
        core.poke_program(end, word);
        end += 2;
    }
    if (end >= kRoutines) fail("assembly longer than the room for it", end, 0);
    core.poke_program(end, kLoop);
    core.set_pc(kAssembly);
    while (core.pc() != end)
        run_to(cycle() + 1);
    core.set_pc(back);
}

Cycle DspicHost::cycles(double microseconds) const {
    const auto later = time() + static_cast<puckloop::cosim::Time>(microseconds * 1e6);
    return chip_.clock().first_cycle_at(later) - cycle();
}

}  // namespace hosted
