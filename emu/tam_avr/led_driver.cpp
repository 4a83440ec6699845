#include "emu/tam_avr/led_driver.h"

namespace puckloop::tam {

namespace {

// Registers.
constexpr int kMode1 = 0x00, kPwm0 = 0x02, kGroupPwm = 0x12, kGroupFrequency = 0x13, kLedOut0 = 0x14,
              kSubAddress1 = 0x18, kAllCall = 0x1B, kIref = 0x1C, kErrorFlag1 = 0x1D, kErrorFlag2 = 0x1E;
// MODE1.
constexpr std::uint8_t kSleep = 1u << 4, kAllCallOn = 1u << 0, kMode1AtReset = kSleep | kAllCallOn;
// The control byte.
constexpr unsigned kNumberMask = 0x1F, kIncrementShift = 5;
enum Increment : unsigned { kAll = 4, kBrightness = 5, kGlobal = 6, kBrightnessAndGlobal = 7 };
constexpr double kSteps = 256.0;

}  // namespace

void LedDriver::reset() {
    registers_.fill(0);
    registers_[kMode1] = kMode1AtReset;
    registers_[kGroupPwm] = 0xFF;
    registers_[kSubAddress1] = 0xD2;
    registers_[kSubAddress1 + 1] = 0xD4;
    registers_[kSubAddress1 + 2] = 0xD8;
    registers_[kAllCall] = kAllCallAddress << 1;
    registers_[kIref] = 0xFF;
    duties_.fill(0.0);
    control_ = 0;
    control_next_ = reset_ = false;
    reset_step_ = 0;
}

bool LedDriver::start(std::uint8_t address_byte) {
    const std::uint8_t address = address_byte >> 1;
    const bool reads = address_byte & 1u;
    const bool all_call = registers_[kMode1] & kAllCallOn && address == registers_[kAllCall] >> 1;
    reset_ = address == kSoftwareResetAddress && !reads;
    reset_step_ = 0;
    control_next_ = !reads;
    return address == kAddress || all_call || reset_;
}

bool LedDriver::write(std::uint8_t byte) {
    if (reset_) {
        constexpr std::array<std::uint8_t, 2> kResetBytes{0xA5, 0x5A};
        if (reset_step_ >= kResetBytes.size() || byte != kResetBytes[reset_step_]) return reset_ = false;
        ++reset_step_;
        return true;
    }
    if (control_next_) {
        control_next_ = false;
        control_ = byte;
        return true;
    }
    const unsigned number = control_ & kNumberMask;
    if (number >= kRegisters || number == kErrorFlag1 || number == kErrorFlag2) return false;
    registers_[number] = byte;
    ++writes_;
    advance_register();
    return true;
}

std::uint8_t LedDriver::read() {
    const unsigned number = control_ & kNumberMask;
    const std::uint8_t byte = number < kRegisters ? registers_[number] : std::uint8_t{0};
    advance_register();
    return byte;
}

void LedDriver::advance_register() {
    unsigned first = 0, last = 0;
    switch (control_ >> kIncrementShift) {
    case kAll:
        last = kRegisters - 1;
        break;
    case kBrightness:
        first = kPwm0;
        last = kGroupPwm - 1;
        break;
    case kGlobal:
        first = kGroupPwm;
        last = kGroupFrequency;
        break;
    case kBrightnessAndGlobal:
        first = kPwm0;
        last = kGroupFrequency;
        break;
    default:
        return;
    }
    const unsigned number = control_ & kNumberMask;
    const unsigned next = number >= last ? first : number + 1;
    control_ = static_cast<std::uint8_t>((control_ & ~kNumberMask) | next);
}

double LedDriver::duty_of(int led) const {
    if (registers_[kMode1] & kSleep) return 0.0;
    constexpr int kLedsOfRegister = 4;
    const unsigned drive = registers_[static_cast<std::size_t>(kLedOut0 + led / kLedsOfRegister)] >>
                               2 * (led % kLedsOfRegister) &
                           3u;
    const double own = registers_[static_cast<std::size_t>(kPwm0 + led)] / kSteps;
    switch (drive) {
    case 0:
        return 0.0;
    case 1:
        return 1.0;
    case 2:
        return own;
    default:
        return own * registers_[kGroupPwm] / kSteps;
    }
}

std::uint16_t LedDriver::stop() {
    if (reset_ && reset_step_ == 2) {
        const std::array<double, kLeds> before = duties_;
        reset();
        duties_ = before;
    }
    unsigned changed = 0;
    for (int led = 0; led < kLeds; ++led) {
        double& duty = duties_[static_cast<std::size_t>(led)];
        const double now = duty_of(led);
        if (duty != now) changed |= 1u << led;
        duty = now;
    }
    return static_cast<std::uint16_t>(changed);
}

}  // namespace puckloop::tam
