#include "emu/i2c_devices/lsm330.h"

#include "emu/i2c_devices/signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::i2c_devices {

namespace {

using cosim::I2cAnswer;
using cosim::Time;

// Registers of both dies; where their names differ, the accelerometer's first.
constexpr std::uint8_t kWhoAmI = 0x0F;
constexpr std::uint8_t kRate = 0x20;      // CTRL_REG5_A, CTRL_REG1_G
constexpr std::uint8_t kScaleG = 0x23;    // CTRL_REG4_G
constexpr std::uint8_t kScaleA = 0x24;    // CTRL_REG6_A
constexpr std::uint8_t kAddressA = 0x25;  // CTRL_REG7_A
constexpr std::uint8_t kTemperature = 0x26, kStatus = 0x27;
constexpr std::uint8_t kOutput = 0x28, kOutputEnd = 0x2E;  // x, y, z, low byte first
constexpr std::uint8_t kFifoControl = 0x2E, kFifoSource = 0x2F;

// Bits.
constexpr std::uint8_t kAddInc = 0x10;                                        // of CTRL_REG7_A
constexpr std::uint8_t kBduA = 0x08;                                          // of CTRL_REG5_A
constexpr std::uint8_t kPowerG = 0x08;                                        // of CTRL_REG1_G
constexpr std::uint8_t kBduG = 0x80, kBleG = 0x40;                            // of CTRL_REG4_G
constexpr std::uint8_t kFirst = 0x80;                                         // of a sub-address: count up
constexpr std::uint8_t kAllNew = 0x08, kAnyOverrun = 0x80, kAxesMask = 0x07;  // of the status
constexpr unsigned kOverrunShift = 4;
constexpr std::uint8_t kFifoEmpty = 0x20;

struct Default {
    Lsm330::Die die;
    std::uint8_t number, value;
    std::string_view name;
    bool works;  ///< what is written there has its effect here
};
constexpr auto kA = Lsm330::Die::Accelerometer, kG = Lsm330::Die::Gyroscope;
/// The registers that can be written, with what they hold after power-on.
constexpr auto kWritable = std::to_array<Default>({
    {kA, 0x10, 0x00, "OFF_X_A", false},         {kA, 0x11, 0x00, "OFF_Y_A", false},
    {kA, 0x12, 0x00, "OFF_Z_A", false},         {kA, 0x13, 0x00, "CS_X_A", false},
    {kA, 0x14, 0x00, "CS_Y_A", false},          {kA, 0x15, 0x00, "CS_Z_A", false},
    {kA, 0x16, 0x01, "LC_L_A", false},          {kA, 0x17, 0x00, "LC_H_A", false},
    {kA, 0x20, 0x07, "CTRL_REG5_A", true},      {kA, 0x21, 0x00, "CTRL_REG2_A", false},
    {kA, 0x22, 0x00, "CTRL_REG3_A", false},     {kA, 0x23, 0x00, "CTRL_REG4_A", false},
    {kA, 0x24, 0x00, "CTRL_REG6_A", true},      {kA, 0x25, 0x10, "CTRL_REG7_A", true},
    {kA, 0x2E, 0x00, "FIFO_CTRL_REG_A", false}, {kG, 0x20, 0x07, "CTRL_REG1_G", true},
    {kG, 0x21, 0x00, "CTRL_REG2_G", true},      {kG, 0x22, 0x00, "CTRL_REG3_G", false},
    {kG, 0x23, 0x00, "CTRL_REG4_G", true},      {kG, 0x24, 0x00, "CTRL_REG5_G", false},
    {kG, 0x25, 0x00, "REFERENCE_G", false},     {kG, 0x2E, 0x00, "FIFO_CTRL_REG_G", false},
    {kG, 0x30, 0x00, "INT1_CFG_G", false},      {kG, 0x32, 0x00, "INT1_THS_XH_G", false},
    {kG, 0x33, 0x00, "INT1_THS_XL_G", false},   {kG, 0x34, 0x00, "INT1_THS_YH_G", false},
    {kG, 0x35, 0x00, "INT1_THS_YL_G", false},   {kG, 0x36, 0x00, "INT1_THS_ZH_G", false},
    {kG, 0x37, 0x00, "INT1_THS_ZL_G", false},   {kG, 0x38, 0x00, "INT1_DURATION_G", false},
});

// The accelerometer's by the bits ODR3..0 of CTRL_REG5_A: samples a second; 0 sleeps.
constexpr std::array<double, 16> kRatesA{0, 3.125, 6.25, 12.5, 25, 50, 100, 400, 800, 1600};
// By FSCALE2..0 of CTRL_REG6_A: g a digit.
constexpr double kTwoG = 2.0 / 32768;
constexpr std::array<double, 8> kDigitsA{kTwoG,      2 * kTwoG, 3 * kTwoG, 4 * kTwoG,
                                         12 * kTwoG, kTwoG,     kTwoG,     kTwoG};
// By BW2..1 of CTRL_REG6_A: Hz of the anti-aliasing filter.
constexpr std::array<double, 4> kBandwidthsA{800, 200, 400, 50};
constexpr double kNoiseA = 150e-6;  // g for a root hertz
// The gyroscope's by DR1..0 of CTRL_REG1_G, and the cut-offs by BW1..0.
constexpr std::array<double, 4> kRatesG{95, 190, 380, 760};
constexpr double kCutOffsG[4][4] = {
    {12.5, 25, 25, 25}, {12.5, 25, 50, 70}, {20, 25, 50, 100}, {30, 35, 50, 100}};
// By FS1..0 of CTRL_REG4_G: degrees a second for a digit.
constexpr std::array<double, 4> kDigitsG{8.75e-3, 17.5e-3, 70e-3, 70e-3};
constexpr double kNoiseG = 0.03;  // degrees a second for a root hertz
constexpr std::uint8_t kRoomTemperature = 25;

}  // namespace

Lsm330::Lsm330(Die die, std::uint64_t seed, const std::string& name)
    : die_(die),
      noise_(seed, name + (die == Die::Gyroscope ? "/lsm330_gyroscope" : "/lsm330_accelerometer")) {
    if (!gyroscope()) felt_[2] = 1.0;
    set_defaults();
}

std::string_view Lsm330::name() const {
    return gyroscope() ? "lsm330_gyroscope" : "lsm330_accelerometer";
}

bool Lsm330::listens_to(std::uint8_t address) const {
    return address == (gyroscope() ? kGyroscopeAddress : kAccelerometerAddress);
}

void Lsm330::set_defaults() {
    registers_ = {};
    for (const Default& writable : kWritable)
        if (writable.die == die_) registers_[writable.number] = writable.value;
    constexpr std::uint8_t kAccelerometerIs = 0x40, kGyroscopeIs = 0xD4;
    registers_[kWhoAmI] = gyroscope() ? kGyroscopeIs : kAccelerometerIs;
    registers_[kFifoSource] = kFifoEmpty;
    if (gyroscope()) registers_[kTemperature] = kRoomTemperature;
    output_ = {};
    held_ = 0;
    period_ = 0;
}

void Lsm330::reset(const Emit&) {
    set_defaults();
    register_ = 0;
    number_next_ = increments_ = false;
}

bool Lsm330::increments(std::uint8_t sub_address) const {
    return gyroscope() ? (sub_address & kFirst) != 0 : (registers_[kAddressA] & kAddInc) != 0;
}

I2cAnswer Lsm330::start(bool read, Time) {
    number_next_ = !read;
    return {.acknowledge = true};
}

I2cAnswer Lsm330::write(std::uint8_t byte, Time now) {
    if (number_next_) {
        number_next_ = false;
        register_ = byte % kRegisters;
        increments_ = increments(byte);
        return {.acknowledge = true};
    }
    pass(now);
    write_register(register_, byte, now);
    if (increments_) register_ = (register_ + 1) % kRegisters;
    return {.acknowledge = true};
}

I2cAnswer Lsm330::read(Time now) {
    pass(now);
    const std::uint8_t byte = read_register(register_);
    ++reads_;
    if (increments_) register_ = (register_ + 1) % kRegisters;
    return {.acknowledge = true, .byte = byte};
}

void Lsm330::write_register(std::uint8_t number, std::uint8_t value, Time now) {
    for (const Default& writable : kWritable)
        if (writable.die == die_ && writable.number == number) registers_[number] = value;
    if (number == kRate) set_rate(now);
}

/// Sampling begins anew with each write that wakes it or sets another rate.
void Lsm330::set_rate(Time now) {
    constexpr unsigned kRateShiftA = 4, kRateShiftG = 6;
    const std::uint8_t value = registers_[kRate];
    double hertz = gyroscope() ? kRatesG[value >> kRateShiftG] : kRatesA[value >> kRateShiftA];
    if (gyroscope() && !(value & kPowerG)) hertz = 0.0;
    const Time period = hertz > 0.0 ? cosim::from_seconds(1.0 / hertz) : 0;
    if (period == period_) return;
    period_ = period;
    next_ = now + period;
}

double Lsm330::digit() const {
    constexpr unsigned kShiftA = 3, kShiftG = 4;
    return gyroscope() ? kDigitsG[registers_[kScaleG] >> kShiftG & 3u]
                       : kDigitsA[registers_[kScaleA] >> kShiftA & 7u];
}

double Lsm330::noise_rms() const {
    constexpr unsigned kShiftA = 6, kRateShiftG = 6, kShiftG = 4;
    if (!gyroscope()) return kNoiseA * std::sqrt(kBandwidthsA[registers_[kScaleA] >> kShiftA]);
    return kNoiseG *
           std::sqrt(kCutOffsG[registers_[kRate] >> kRateShiftG][registers_[kRate] >> kShiftG & 3u]);
}

/// Takes the samples that were due at or before `now`: what was felt has not changed since the last call.
void Lsm330::pass(Time now) {
    if (period_ == 0 || now < next_) return;
    const Time behind = (now - next_) / period_;
    if (behind > 0) {
        take();  // whoever did not read one that came before these has lost it
        samples_ += static_cast<std::uint64_t>(behind) - 1;
    }
    take();
    next_ += (behind + 1) * period_;
}

void Lsm330::take() {
    ++samples_;
    std::uint8_t& status = registers_[kStatus];
    const bool block = gyroscope() ? registers_[kScaleG] & kBduG : registers_[kRate] & kBduA;
    const double rms = noise_rms();
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const double value = felt_[axis] + rms * noise_.normal();
        if (!(registers_[kRate] >> axis & 1u)) continue;
        const unsigned fresh = 1u << axis;
        if (status & fresh) status |= static_cast<std::uint8_t>(fresh << kOverrunShift | kAnyOverrun);
        status |= static_cast<std::uint8_t>(fresh);
        if (block && (held_ & fresh)) continue;
        constexpr double kLeast = -32768, kMost = 32767;
        output_[axis] = static_cast<std::int16_t>(std::lround(std::clamp(value / digit(), kLeast, kMost)));
    }
    if ((status & kAxesMask) == kAxesMask) status |= kAllNew;
}

std::uint8_t Lsm330::read_register(std::uint8_t number) {
    if (number < kOutput || number >= kOutputEnd) return registers_[number];
    const std::size_t axis = (number - kOutput) / 2u;
    const bool second = (number - kOutput) % 2u != 0;
    const bool high = second != (gyroscope() && (registers_[kScaleG] & kBleG));
    const auto value = static_cast<std::uint16_t>(output_[axis]);
    constexpr unsigned kByteBits = 8;
    if (second)
        axis_read(axis);
    else
        held_ |= static_cast<std::uint8_t>(1u << axis);
    return static_cast<std::uint8_t>(high ? value >> kByteBits : value);
}

/// Its second byte was read: it is no longer new.
void Lsm330::axis_read(std::size_t axis) {
    std::uint8_t& status = registers_[kStatus];
    const unsigned both = 1u << axis | 1u << (axis + kOverrunShift);
    status &= static_cast<std::uint8_t>(~(both | kAllNew));
    if (!(status & kAxesMask << kOverrunShift)) status &= static_cast<std::uint8_t>(~kAnyOverrun);
    held_ &= static_cast<std::uint8_t>(~(1u << axis));
}

void Lsm330::signal_at(std::uint16_t id, double value, Time now) {
    const std::uint16_t first = gyroscope() ? kTurnRate : kAcceleration;
    if (id < first || id >= first + kAxes) return;
    pass(now);
    felt_[id - first] = value;
}

std::string Lsm330::report() const {
    std::string idle;
    for (const Default& writable : kWritable)
        if (writable.die == die_ && !writable.works && registers_[writable.number] != writable.value)
            idle += fmt::format(R"({}"{}")", idle.empty() ? "" : ",", writable.name);
    return fmt::format(R"({{"registers_read":{},"samples":{},"last":[{},{},{}],"without_effect":[{}]}})",
                       reads_, samples_, output_[0], output_[1], output_[2], idle);
}

}  // namespace puckloop::i2c_devices
