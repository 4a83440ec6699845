// simavr_speed program|tam IMAGE SECONDS: how fast libsimavr executes an ATmega1284P ELF, for `puckloop bench
// --case avr`. Prints millions of clocks by processor second, or, for the TAM's firmware with a radio module
// that answers at once, simulated by processor seconds. A program of its own because libsimavr is GPL 3.

#include "benchmark/measures/processor_seconds.h"
#include "benchmark/speeds/prompt_module.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <string_view>

extern "C" {
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
}

namespace {

constexpr double kClock = 16e6, kStartUp = 4.0;

/// The module on USART 1. simavr takes bytes as fast as they are raised, its own buffer has 64.
struct Module {
    avr_t* chip = nullptr;
    avr_irq_t* input = nullptr;
    puckloop::tools::PromptModule module;
    std::deque<std::uint8_t> answers;

    explicit Module(avr_t* of) : chip(of) {
        for (const char unit : {'0', '1'}) {
            std::uint32_t flags = 0;  // no copy of what is sent on standard output
            avr_ioctl(chip, AVR_IOCTL_UART_SET_FLAGS(unit), &flags);
        }
        input = avr_io_getirq(chip, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_INPUT);
        avr_irq_register_notify(
            avr_io_getirq(chip, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_OUTPUT),
            [](avr_irq_t*, std::uint32_t value, void* self) {
                static_cast<Module*>(self)->add(
                    static_cast<Module*>(self)->module.take(static_cast<std::uint8_t>(value)));
            },
            this);
        add(puckloop::tools::PromptModule::hello());
    }
    void add(const std::vector<std::uint8_t>& bytes) {
        answers.insert(answers.end(), bytes.begin(), bytes.end());
    }
    /// A byte each 10 bits of 9600 baud.
    void run(avr_cycle_count_t until) {
        constexpr avr_cycle_count_t kByte = 16'667;
        while (chip->cycle < until) {
            const avr_cycle_count_t stop = chip->cycle + kByte;
            while (chip->cycle < stop)
                avr_run(chip);
            if (answers.empty() || chip->cycle < static_cast<avr_cycle_count_t>(0.25 * kClock)) continue;
            avr_raise_irq(input, answers.front());
            answers.pop_front();
        }
    }
};

}  // namespace

int main(int count, char** words) {
    if (count != 4) return 2;
    elf_firmware_t firmware{};
    avr_t* const chip = avr_make_mcu_by_name("atmega1284p");
    if (!chip || elf_read_firmware(words[2], &firmware) != 0) return 2;
    chip->log = LOG_NONE;
    avr_init(chip);
    firmware.frequency = static_cast<std::uint32_t>(kClock);
    avr_load_firmware(chip, &firmware);
    chip->frequency = static_cast<std::uint32_t>(kClock);
    const double slice = std::atof(words[3]);
    const bool tam = std::string_view(words[1]) == "tam";
    Module module(chip);
    const auto step = static_cast<avr_cycle_count_t>(0.02 * kClock);
    const auto run = [&](avr_cycle_count_t until) {
        if (tam) return module.run(until);
        while (chip->cycle < until)
            avr_run(chip);
    };
    run(tam ? static_cast<avr_cycle_count_t>(kStartUp * kClock) : step);
    const avr_cycle_count_t first = chip->cycle;
    const double start = puckloop::tools::processor_seconds();
    double elapsed = 0;
    while ((elapsed = puckloop::tools::processor_seconds() - start) < slice)
        run(chip->cycle + step);
    const double clocks = static_cast<double>(chip->cycle - first) / elapsed;
    std::printf("%.6f\n", tam ? clocks / kClock : clocks * 1e-6);
    return 0;
}
