#pragma once
// The modules of an ATmega1284P, as chip.h's class has them inside: for that class's own files only.

#include "emu/avr/chip/chip.h"
#include "emu/avr/chip/supply_reset.h"
#include "emu/avr/peripherals/adc.h"
#include "emu/avr/peripherals/eeprom.h"
#include "emu/avr/peripherals/external_interrupts.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/self_programming.h"
#include "emu/avr/peripherals/serial/spi.h"
#include "emu/avr/peripherals/serial/twi.h"
#include "emu/avr/peripherals/serial/usart.h"
#include "emu/avr/peripherals/system_control.h"
#include "emu/avr/peripherals/timing/comparator.h"
#include "emu/avr/peripherals/timing/timer.h"
#include "emu/avr/peripherals/timing/watchdog.h"
#include "emu/image/code_places.h"

#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::avr {

/// Adds `record`, unless there are as many as a report holds.
template <class Record>
void keep(std::vector<Record>& records, Record record) {
    constexpr std::size_t kMost = 1000;
    if (records.size() < kMost) records.push_back(std::move(record));
}

struct Chip::Parts {
    const DeviceInfo& device;
    ChipOptions options;
    Fuses fuses;
    cosim::ClockDomain clock;
    IoSpace io;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Surroundings around;
    WatchClock watch;
    Prescaler synchronous, asynchronous;
    SystemControl system;
    Ports ports;
    ExternalInterrupts external;
    Timer timer0, timer1, timer2, timer3;
    Usart usart0, usart1;
    Twi twi;
    Spi spi;
    Adc adc;
    Comparator comparator;
    Eeprom eeprom;
    Watchdog watchdog;
    SelfProgramming programming;
    chip::HeldInterrupts held;  ///< its slot and the supply's are the last: the others keep theirs
    SupplyReset supply;
    std::vector<std::uint16_t> stops;
    bool stopped = false;
    cosim::Time now = 0;
    ChipReport report;
    image::CodePlaces places;

    Parts(const DeviceInfo& info, Pins& pins, const ChipOptions& chosen);

    // chip_parts.cpp: how it is wired
    static IoSpace& described(IoSpace& space, const DeviceInfo& info) {
        space.describe(info.registers);
        return space;
    }

    void connect_hooks();
    void connect_reports();
    void keep_refused_spm(std::string_view why);
    void synchronise_timers();
    /// PC2 to PC5 are TCK, TMS, TDO and TDI.
    void give_pins_to_jtag();
    /// PSRSYNC, PSRASY: the prescaler starts again; with TSM it stays at 0.
    static void write_gtccr(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t);
    void reset(ResetCause cause);

    /// Sources of the ADC's trigger by ADTS2:0; the comparator (1) calls by itself.
    struct Trigger {
        unsigned number;
        InterruptFlags* flags;
        std::uint8_t mask;
    };
    std::array<Trigger, 6> triggers();
    const Trigger* trigger_of(unsigned number);
    void watch_triggers(bool plan);
    std::array<Trigger, 6> sources{};

    // chip_state.cpp
    template <class Archive>
    void state(Archive& archive);

    Usart& usart(int unit) { return unit == 0 ? usart0 : usart1; }
    /// What is handed in from outside happens now.
    void at_present() { core.set_now(std::max(core.now(), clock.first_cycle_at(now))); }
};

}  // namespace puckloop::avr
