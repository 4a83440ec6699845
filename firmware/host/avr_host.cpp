#include "firmware/host/avr_host.h"

#include "emu/avr/core/core.h"
#include "emu/image/avr_image.h"
#include "firmware/host/register_objects.h"

namespace hosted {

namespace {

namespace avr = puckloop::avr;

// What the chip's core executes. Word addresses and words (AVR Instruction Set Manual).
constexpr std::uint16_t kJmp = 0x940C, kLoop = 0xCFFF, kNext = 0xC000, kReti = 0x9518, kSleep = 0x9588,
                        kWdr = 0x95A8;
constexpr std::uint16_t kMain = 0x100, kIdle = 0x102, kAwake = 0x103, kFeed = 0x106;
constexpr std::uint16_t kRoutines = 0x200, kRoutineWords = 3;  // entry, loop, RETI
constexpr int kVectors = 35;

}  // namespace

AvrHost::AvrHost(puckloop::tam::Board& board, std::span<const Vector> vectors)
    : board_(board), routines_(kVectors) {
    std::vector<std::uint16_t> words(kRoutines + kVectors * kRoutineWords, kLoop);
    std::vector<std::uint32_t> stops{0, 2u * kAwake};
    for (std::uint16_t i = 0; i < kVectors; ++i) {
        const auto entry = static_cast<std::uint16_t>(kRoutines + i * kRoutineWords);
        words[2u * i] = kJmp;
        words[2u * i + 1u] = i == 0 ? kMain : entry;
        words[entry] = kNext;
        words[entry + 2u] = kReti;
        if (i != 0) stops.push_back(2u * entry);
    }
    words[kIdle] = kSleep;
    words[kAwake] = kNext;
    words[kFeed] = kWdr;
    puckloop::image::ByteSegment flash;
    for (const std::uint16_t word : words) {
        flash.bytes.push_back(static_cast<std::uint8_t>(word));
        flash.bytes.push_back(static_cast<std::uint8_t>(word >> 8));
    }
    puckloop::image::AvrImage image;
    image.flash.push_back(std::move(flash));
    board_.load(image);
    board_.chip().set_skipping(false);
    auto inside = board_.chip().inside();
    avr::CoreState state = inside.core.state();
    state.pc = kMain;
    state.sp = static_cast<std::uint16_t>(inside.device.ram_start + inside.device.ram_bytes - 1);
    inside.core.set_state(state);
    for (const Vector& vector : vectors)
        routines_[static_cast<std::size_t>(vector.number)] = vector.routine;
    board_.chip().set_stops(stops);
}

std::uint8_t AvrHost::read_byte(std::uint16_t address) {
    return board_.chip().inside().core.read_data(address);
}
void AvrHost::write_byte(std::uint16_t address, std::uint8_t value) {
    board_.chip().inside().core.write_data(address, value);
}
/// Sixteen bits go through the peripheral's own latch: the low byte is read first, the high one written
/// first.
std::uint16_t AvrHost::read_word(std::uint16_t address) {
    const std::uint8_t low = read_byte(address);
    return static_cast<std::uint16_t>(low | read_byte(static_cast<std::uint16_t>(address + 1)) << 8);
}
void AvrHost::write_word(std::uint16_t address, std::uint16_t value) {
    write_byte(static_cast<std::uint16_t>(address + 1), static_cast<std::uint8_t>(value >> 8));
    write_byte(address, static_cast<std::uint8_t>(value));
}

void AvrHost::run_to(Cycle end) {
    board_.run_until(board_.chip().clock().time_of(end));
    // Switched off by the firmware, or without a battery.
    if (!board_.powered() || board_.supply() == 0.0) throw InputEnds{};
    // An interrupt that was entered in the last cycles is at its routine, too, though not stopped there.
    std::uint32_t pc = board_.chip().pc() / 2;
    while (pc != 0 && pc < 2u * kVectors) {  // the jump to it is still to come
        board_.run_until(board_.chip().clock().time_of(cycle() + 1));
        pc = board_.chip().pc() / 2;
    }
    if (pc == 0 || (pc >= kRoutines && (pc - kRoutines) % kRoutineWords == 0)) serve(pc);
}

void AvrHost::serve(std::uint32_t stop) {
    if (stop < kRoutines) fail("the chip was reset; MCUSR", board_.chip().peek("MCUSR"), 0);
    const std::uint32_t number = (stop - kRoutines) / kRoutineWords;
    void (*routine)() = routines_.at(number);
    if (routine == nullptr) fail("interrupt without a routine: vector", number, 0);
    set_pc(static_cast<std::uint16_t>(stop + 1));
    call(routine);
    run_one(static_cast<std::uint16_t>(stop + 2));
}

void AvrHost::set_pc(std::uint16_t word) {
    avr::Core& core = board_.chip().inside().core;
    avr::CoreState state = core.state();
    state.pc = word;
    core.set_state(state);
}

/// Executes the instruction there, and the interrupts that come before it.
void AvrHost::run_one(std::uint16_t word) {
    set_pc(word);
    while (board_.chip().pc() == 2u * word)
        run_to(cycle() + 1);
}

void AvrHost::idle() {
    touch();
    const auto back = static_cast<std::uint16_t>(board_.chip().pc() / 2);
    set_pc(kIdle);
    while (board_.chip().pc() != 2u * kAwake || board_.chip().sleeping()) {
        act_if_due();
        run_to(due());
    }
    set_pc(back);
}

void AvrHost::feed_watchdog() {
    touch();
    const auto back = static_cast<std::uint16_t>(board_.chip().pc() / 2);
    run_one(kFeed);
    set_pc(back);
}

Cycle AvrHost::cycles(double microseconds) const {
    const auto later = time() + static_cast<puckloop::cosim::Time>(microseconds * 1e6);
    return board_.chip().clock().first_cycle_at(later) - cycle();
}

}  // namespace hosted
