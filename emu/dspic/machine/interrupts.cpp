#include "emu/dspic/machine/interrupts.h"

#include "emu/dspic/devices/register_bits.h"

#include <bit>
#include <cstring>
#include <utility>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kINTCON1{"INTCON1"};
constexpr RegisterBits kINTCON2{"INTCON2"};

constexpr std::uint16_t kTrapFlags30F =
    kINTCON1["MATHERR"] | kINTCON1["ADDRERR"] | kINTCON1["STKERR"] | kINTCON1["OSCFAIL"];
constexpr std::uint16_t kTrapFlags33F = kTrapFlags30F | kINTCON1["DMACERR"];

/// Bits of a register that exist on the device.
std::uint16_t implemented(const DeviceInfo& device, std::uint16_t address) {
    for (const RegisterInfo& info : device.registers)
        if (info.address == address) return info.implemented;
    return 0;
}
constexpr std::uint16_t word_of(std::uint16_t base, int irq) {
    return static_cast<std::uint16_t>(base + 2 * (irq / 16));
}
constexpr std::uint16_t bit_of(int irq) {
    return static_cast<std::uint16_t>(1u << (irq % 16));
}

/// Four registers one behind the other, the first one lowest.
inline std::uint64_t four_words(const std::uint16_t* words) {
    std::uint64_t four;
    std::memcpy(&four, words, sizeof four);
    return four;
}
constexpr int kFirstWords = 4;  // looked at together where the device has them

/// Calls `see(word, pending)` for each IFS word in which a source is flagged and enabled.
template <class See>
inline void see_pending(const std::uint16_t* flags, const std::uint16_t* enables, int words, See see) {
    int word = 0;
    if (words >= kFirstWords && (four_words(flags) & four_words(enables)) == 0) word = kFirstWords;
    for (; word < words; ++word)
        if (const auto pending = static_cast<std::uint16_t>(flags[word] & enables[word])) see(word, pending);
}

}  // namespace

InterruptController::InterruptController(const DeviceInfo& device, SfrSpace& sfr)
    : device_(device), sfr_(sfr) {
    for (const IrqName& entry : device.irqs)
        implemented_[entry.irq / 16u] |= bit_of(entry.irq);
    sfr.hook(kIntcon1, this, nullptr, &write_register);
    sfr.hook(kIntcon2, this, &read_register, &write_register);
    for (int i = 0; i < device.ifs_words; ++i) {
        sfr.hook(static_cast<std::uint16_t>(device.ifs + 2 * i), this, nullptr, &write_register);
        sfr.hook(static_cast<std::uint16_t>(device.iec + 2 * i), this, nullptr, &write_register);
    }
    for (const IrqName& entry : device.irqs)
        sfr.hook(static_cast<std::uint16_t>(device.ipc + 2 * (entry.irq / 4)), this, nullptr,
                 &write_register);
    if (device.inttreg) sfr.claim(device.inttreg);
    list_writable();
    reset();
}

void InterruptController::list_writable() {
    const auto at = [this](int address) -> std::uint16_t& {
        return writable_[static_cast<std::size_t>(address - kIntcon1) / 2];
    };
    at(kIntcon1) = implemented(device_, kIntcon1);
    at(kIntcon2) = static_cast<std::uint16_t>(implemented(device_, kIntcon2) & ~kINTCON2["DISI"]);
    for (int i = 0; i < device_.ifs_words; ++i)
        at(device_.ifs + 2 * i) = at(device_.iec + 2 * i) = implemented_[static_cast<std::size_t>(i)];
    for (const IrqName& entry : device_.irqs)
        at(device_.ipc + 2 * (entry.irq / 4)) |= static_cast<std::uint16_t>(7u << (4 * (entry.irq % 4)));
}

void InterruptController::reset() {
    sfr_.raw(kIntcon1) = 0;
    sfr_.raw(kIntcon2) = 0;
    for (int i = 0; i < device_.ifs_words; ++i) {
        sfr_.raw(static_cast<std::uint16_t>(device_.ifs + 2 * i)) = 0;
        sfr_.raw(static_cast<std::uint16_t>(device_.iec + 2 * i)) = 0;
    }
    for (const IrqName& entry : device_.irqs)
        sfr_.raw(static_cast<std::uint16_t>(device_.ipc + 2 * (entry.irq / 4))) = 0;
    constexpr unsigned kResetPriority = 4;
    for (const IrqName& entry : device_.irqs)
        sfr_.raw(static_cast<std::uint16_t>(device_.ipc + 2 * (entry.irq / 4))) |=
            static_cast<std::uint16_t>(kResetPriority << (4 * (entry.irq % 4)));
    if (device_.inttreg) sfr_.raw(device_.inttreg) = 0;
    line_.first = {};
    for (int i = 0; i < device_.ifs_words; ++i)
        wake_hearing(i);
}

void InterruptController::set_tap(void* owner, void (*served)(void* owner, int irq, Cycle now),
                                  const std::array<std::uint64_t, 2>& irqs) {
    tap_owner_ = owner;
    tap_ = served;
    tapped_ = irqs;
    for (int i = 0; i < device_.ifs_words; ++i)
        wake_hearing(i);
}

void InterruptController::set_gate(void* owner, bool (*passes)(void* owner, int irq, Cycle now),
                                   const std::array<std::uint64_t, 2>& irqs) {
    gate_owner_ = owner;
    gate_ = passes;
    gated_ = irqs;
}

void InterruptController::rest(int irq, void* owner, void (*wake)(void* owner, Cycle passed)) {
    resters_[static_cast<std::size_t>(irq)] = {owner, wake};
    line_.resting[static_cast<std::size_t>(irq) / 16] |= bit_of(irq);
}

void InterruptController::set_resting(bool on) {
    rests_ = on;
    for (int i = 0; i < device_.ifs_words; ++i)
        wake_hearing(i);
}

void InterruptController::wake(int irq) {
    line_.resting[static_cast<std::size_t>(irq) / 16] &= static_cast<std::uint16_t>(~bit_of(irq));
    const Rester& rester = resters_[static_cast<std::size_t>(irq)];
    rester.wake(rester.owner, now_ ? *now_ : 0);
}

void InterruptController::wake_hearing(int word) {
    const auto index = static_cast<std::size_t>(word);
    if (line_.resting[index] == 0) return;
    const unsigned deaf = ifs()[index] & ~iec()[index] & ~(tapped_[index / 4] >> (index % 4 * 16));
    for (unsigned woken = line_.resting[index] & (rests_ ? ~deaf : ~0u); woken != 0; woken &= woken - 1)
        wake(16 * word + std::countr_zero(woken));
}

void InterruptController::raise(int irq, Cycle now) {
    request(irq, now);
    if (gated(irq)) [[unlikely]] {
        if (flag(irq) || !gate_(gate_owner_, irq, now)) return;
    }
    set_flag(irq, now);
}

void InterruptController::set_flag(int irq, Cycle now) {
    std::uint16_t& flags = sfr_.raw(word_of(device_.ifs, irq));
    if (flags & bit_of(irq)) return;
    flags |= bit_of(irq);
    if (!enabled(irq)) return;
    // Whoever is first in line stays so unless this one ranks higher.
    const int level = priority(irq);
    const int vector = kTrapVectors + irq;
    if (level > line_.first.level || (level == line_.first.level && level > 0 && vector < line_.first.vector))
        line_.first = {level, vector};
    if (changed_) changed_(listener_, now);
}

void InterruptController::clear(int irq) {
    sfr_.raw(word_of(device_.ifs, irq)) &= static_cast<std::uint16_t>(~bit_of(irq));
    if (enabled(irq)) find_first(now_ ? *now_ : 0);
    wake_hearing(irq / 16);
}

void InterruptController::raise_trap(Trap trap, Cycle now) {
    sfr_.raw(kIntcon1) |= trap_flag(trap);
    find_first(now);
}

bool InterruptController::falling_edge(int external) const {
    return sfr_.raw(kIntcon2) >> external & 1;
}
bool InterruptController::nesting_disabled() const {
    return sfr_.raw(kIntcon1) & kINTCON1["NSTDIS"];
}
bool InterruptController::alternate_table() const {
    return sfr_.raw(kIntcon2) & kINTCON2["ALTIVT"];
}

bool InterruptController::any_enabled_flag() const {
    bool waiting = line_.first.level > 7;
    see_pending(ifs(), iec(), device_.ifs_words, [&](int, std::uint16_t) { waiting = true; });
    return waiting;
}

bool InterruptController::waits_alone() const {
    if (line_.first.level < 1 || line_.first.level > 7) return false;
    const int irq = line_.first.vector - kTrapVectors;
    bool alone = true;
    see_pending(ifs(), iec(), device_.ifs_words, [&](int word, unsigned pending) {
        alone = alone && word == irq / 16 && pending == bit_of(irq);
    });
    return alone;
}

void InterruptController::serve_alone() {
    const int irq = line_.first.vector - kTrapVectors;
    sfr_.raw(word_of(device_.ifs, irq)) &= static_cast<std::uint16_t>(~bit_of(irq));
    line_.first = {};
    wake_hearing(irq / 16);
}

void InterruptController::set_listener(void* owner, void (*changed)(void*, Cycle)) {
    listener_ = owner;
    changed_ = changed;
}

void InterruptController::acknowledge(const Request& taken, int cpu_level_before) {
    (void)cpu_level_before;
    if (!device_.inttreg) return;
    // ILR<11:8> is the new CPU level, VECNUM<6:0> counts from INT0 as the part's register page does.
    const int number = taken.vector >= kTrapVectors ? taken.vector - kTrapVectors : 0;
    sfr_.raw(device_.inttreg) = static_cast<std::uint16_t>(taken.level << 8 | number);
}

/// Traps by their levels, which fall with the vector number; user sources by priority, then by number.
void InterruptController::find_first(Cycle now) {
    Request best;
    const std::uint16_t traps = sfr_.raw(kIntcon1) & (device_.family_33f ? kTrapFlags33F : kTrapFlags30F);
    if (traps) {
        auto trap = Trap::OscillatorFail;
        while (!(traps & trap_flag(trap)))
            trap = static_cast<Trap>(static_cast<int>(trap) + 1);
        best = {trap_level(trap), static_cast<int>(trap)};
    } else {
        see_pending(ifs(), iec(), device_.ifs_words, [&](int word, unsigned pending) {
            for (; pending; pending &= pending - 1) {
                const int irq = 16 * word + std::countr_zero(pending);
                const int level = priority(irq);
                if (level > best.level) best = {level, kTrapVectors + irq};
            }
        });
    }
    line_.first = best;
    if (changed_) changed_(listener_, now);
}

void InterruptController::registers_loaded() {
    const auto listener = std::exchange(changed_, nullptr);
    find_first(0);
    changed_ = listener;
}

std::uint16_t InterruptController::read_register(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<const InterruptController*>(owner);
    std::uint16_t value = self.sfr_.raw(address);
    if (self.disi_end_ && *self.disi_end_ > *self.now_) value |= kINTCON2["DISI"];
    return value;
}

void InterruptController::write_register(void* owner, std::uint16_t address, std::uint16_t value,
                                         std::uint16_t mask) {
    auto& self = *static_cast<InterruptController*>(owner);
    const auto bits = static_cast<std::uint16_t>(self.writable_[(address - kIntcon1) / 2u] & mask);
    std::uint16_t& stored = self.sfr_.raw(address);
    stored = static_cast<std::uint16_t>((stored & ~bits) | (value & bits));
    self.find_first(self.now_ ? *self.now_ : 0);
    const DeviceInfo& d = self.device_;
    if (address >= d.ifs && address < d.ifs + 2 * d.ifs_words) self.wake_hearing((address - d.ifs) / 2);
    if (address >= d.iec && address < d.iec + 2 * d.ifs_words) self.wake_hearing((address - d.iec) / 2);
}

}  // namespace puckloop::dspic
