#include "emu/avr/peripherals/self_programming.h"

#include "emu/avr/peripherals/shared_registers.h"

#include <algorithm>

namespace puckloop::avr {

namespace {
constexpr int kSpmVector = 27;
constexpr std::uint16_t kSpmcsr = 0x57;
constexpr std::uint8_t kSpmie = bit(7), kRwwsb = bit(6), kSigrd = bit(5), kRwwsre = bit(4), kBlbset = bit(3),
                       kPgwrt = bit(2), kPgers = bit(1), kSpmen = bit(0);
constexpr std::uint8_t kCommand = kSigrd | kRwwsre | kBlbset | kPgwrt | kPgers | kSpmen;
constexpr std::uint8_t kBlb01 = bit(2), kBlb02 = bit(3), kBlb11 = bit(4), kBlb12 = bit(5);  // lock bits
constexpr std::uint8_t kReadLocks = kBlb02 | kBlb12;
constexpr Cycle kSpmenArmed = 4;
constexpr double kPageSeconds = 3.7e-3;
constexpr std::uint32_t kNoReadWhileWriteWords = 4096;  ///< at the end of the flash
}  // namespace

SelfProgramming::SelfProgramming(const Surroundings& around, Core& core, const cosim::ClockDomain& clock,
                                 Fuses& fuses, const SystemControl& system)
    : around_(around),
      core_(core),
      clock_(clock),
      fuses_(fuses),
      system_(system),
      buffer_(core.device().page_words, kErasedWord),
      slot_(around.events.add(this, &due)) {
    around_.io.hook(kSpmcsr, this, &read_control, &write_control);
    around_.interrupts.connect(kSpmVector, this, nullptr);
}

void SelfProgramming::reset() {
    std::fill(buffer_.begin(), buffer_.end(), kErasedWord);
    armed_until_ = 0;
    busy_ = false;
    around_.events.cancel(slot_);
}

void SelfProgramming::rate_changes(bool changed) {
    const Cycle due = around_.events.due(slot_);
    if (due == kNoCycle) return;
    if (changed)
        around_.events.schedule(slot_, clock_.first_cycle_at(kept_));
    else
        kept_ = clock_.time_of(due);
}

bool SelfProgramming::in_rww(std::uint32_t word) const {
    return word < core_.device().flash_words - kNoReadWhileWriteWords;
}

// Boot lock bits, 0 = programmed: BLB01 and BLB11 keep SPM from writing a section, BLB02 and BLB12 keep LPM
// in the other one from reading it (data sheet, tables 25-2 and 25-3).
bool SelfProgramming::writable(std::uint32_t word) const {
    return fuses_.lock & (word < system_.boot_start() ? kBlb01 : kBlb11);
}
bool SelfProgramming::readable(std::uint32_t word) const {
    const bool boot = word >= system_.boot_start();
    if (boot == (core_.pc() >= system_.boot_start())) return true;
    return fuses_.lock & (boot ? kBlb12 : kBlb02);
}

bool SelfProgramming::interrupts_locked() const {
    const bool boot = core_.pc() >= system_.boot_start();
    const bool vectors_in_boot = system_.vector_base() != 0;
    return boot != vectors_in_boot && !(fuses_.lock & (boot ? kBlb12 : kBlb02));
}

// SPM_READY requests while no operation is under way.
void SelfProgramming::update_request() {
    around_.interrupts.request(kSpmVector, (control() & kSpmie) && !busy_ && around_.now >= armed_until_);
}

// The command bits read back until the SPM, four clocks at most, or until the operation is over.
std::uint8_t SelfProgramming::read_control(void* owner, std::uint16_t) {
    const auto& self = *static_cast<SelfProgramming*>(owner);
    std::uint8_t value = self.control();
    if (!self.busy_ && self.around_.now >= self.armed_until_) value &= static_cast<std::uint8_t>(~kCommand);
    return value;
}

void SelfProgramming::write_control(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<SelfProgramming*>(owner);
    if (self.busy_) {
        self.control() = merged(self.control(), value, kSpmie);
    } else {
        self.control() = static_cast<std::uint8_t>((self.control() & kRwwsb) | (value & (kCommand | kSpmie)));
        if (value & kSpmen) self.armed_until_ = self.around_.now + 1 + kSpmenArmed;
    }
    self.update_request();
}

void SelfProgramming::begin(std::uint32_t word) {
    busy_ = true;
    const Cycle end = around_.now + static_cast<Cycle>(kPageSeconds * clock_.hertz());
    around_.events.schedule(slot_, end);
    if (in_rww(word))
        control() |= kRwwsb;
    else
        core_.stall_until(end);
}

// Only the boot section's SPM does anything.
std::string_view SelfProgramming::spm(std::uint32_t address, std::uint16_t word) {
    const bool armed = around_.now < armed_until_;
    armed_until_ = 0;
    if (core_.pc() < system_.boot_start()) return "it is outside the boot section";
    if (busy_) return "the last page is still being written";
    if (!armed) return "SPMCSR<SPMEN> was not set within the four cycles before";
    const std::uint32_t place = address / 2 % core_.device().flash_words;
    const auto size = static_cast<std::uint32_t>(buffer_.size());
    const std::uint32_t page = place - place % size;
    const std::uint8_t command = control() & (kCommand & static_cast<std::uint8_t>(~kSpmen));
    switch (command) {
    case 0:  // a word of the buffer can be written once
        buffer_[place % size] &= word;
        break;
    case kPgers:
        if (!writable(page)) break;
        for (std::uint32_t i = 0; i < size; ++i)
            core_.set_program(page + i, kErasedWord);
        begin(page);
        break;
    case kPgwrt:
        if (!writable(page)) break;
        for (std::uint32_t i = 0; i < size; ++i)
            core_.set_program(page + i, core_.program(page + i) & buffer_[i]);
        std::fill(buffer_.begin(), buffer_.end(), kErasedWord);
        begin(page);
        break;
    case kRwwsre:
        control() &= static_cast<std::uint8_t>(~kRwwsb);
        std::fill(buffer_.begin(), buffer_.end(), kErasedWord);
        break;
    case kBlbset:
        fuses_.lock &= static_cast<std::uint8_t>(word | 0xC3);  // BLB bits only, and only downward
        break;
    default:
        break;
    }
    update_request();
    return {};
}

void SelfProgramming::due(void* owner, Cycle) {
    auto& self = *static_cast<SelfProgramming*>(owner);
    self.busy_ = false;
    self.control() &= static_cast<std::uint8_t>(~kCommand);
    self.update_request();
}

bool SelfProgramming::load(std::uint32_t address, std::uint8_t& value) const {
    if (around_.now < armed_until_ + 1 && (control() & kSpmen)) {
        const std::uint8_t fuses[] = {fuses_.low, fuses_.lock, fuses_.extended, fuses_.high};
        const auto& signature = core_.device().signature;
        if ((control() & kBlbset) && address < 4) {
            value = fuses[address];
            return true;
        }
        if ((control() & kSigrd) && address < 6) {
            value = address % 2 ? around_.io.raw(kOsccal) : signature[address / 2];
            return true;
        }
    }
    const std::uint32_t word = address / 2 % core_.device().flash_words;
    const bool busy = (control() & kRwwsb) && in_rww(word);
    if (!busy && (fuses_.lock & kReadLocks) == kReadLocks) return false;
    if (!busy && readable(word)) return false;
    value = 0xFF;
    return true;
}

}  // namespace puckloop::avr
