#include "emu/dspic/chip/core_bench.h"

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/core/core.h"
#include "emu/image/image.h"

#include <chrono>

namespace puckloop::dspic {

namespace {

// One round: CRC-16 over a byte, four multiply-accumulates over RAM, a table walk with a call; about 110
// instructions of which a fifth are branches.
constexpr const char* kComputeLoop = R"(
        goto    start
        .org    0x200
start:  mov     #0x1000, w15
        mov     #0x0900, w8
        mov     #0x1900, w10
        mov     #0xFFFF, w4
        clr     w0
        clr     w1
        clr     w2
        clr     w3
        mov     w4, w5
        mov     w4, w6
        mov     w4, w7
        mov     w8, w9
        mov     w10, w11
        clr     w12
        clr     w13
        clr     w14
round:  inc     w0, w0
        xor.b   w4, w0, w1
        mov     #8, w2
crc:    lsr     w4, w4
        bra     nc, even
        mov     #0xA001, w3
        xor     w4, w3, w4
even:   dec     w2, w2
        bra     nz, crc
        mov     #0x0900, w8
        mov     #4, w2
dot:    mov     [w8], w5
        mul.uu  w5, w0, w6
        add     w12, w6, w12
        addc    w13, w7, w13
        mov     w12, [w8++]
        dec     w2, w2
        bra     nz, dot
        rcall   walk
        bra     round
walk:   lnk     #4
        mov     w0, [w14]
        mov     #0x0A00, w9
        mov     #6, w2
step:   mov     [w9], w3
        add     w3, #3, [w9++]
        cp      w3, w4
        bra     gtu, lower
        ior     w3, w0, w1
lower:  dec     w2, w2
        bra     nz, step
        mov     [w14], w1
        mov     w1, [w14+2]
        ulnk
        return
)";

class IdlePins : public Pins {
  public:
    void driven(PortLetter, std::uint16_t, std::uint16_t, Cycle) override {}
    std::uint16_t levels(PortLetter, Cycle) override { return 0xFFFF; }
    double analog(int, Cycle) override { return 0.0; }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

CoreBenchResult bench_compute_loop(double wall_s) {
    const DeviceInfo& device = dspic30f6014a();
    SfrSpace sfr;
    sfr.describe(device.registers);
    EventQueue events;
    InterruptController interrupts(device, sfr);
    Core core(device, sfr, events, interrupts);
    for (const auto& [address, word] : assemble(kComputeLoop).words)
        core.poke_program(address, word);
    core.reset(ResetCause::PowerOn);
    core.set_skip_idle(false);
    constexpr Cycle kSlice = 2'000'000;
    core.run(kSlice);  // decode and warm up
    const std::uint64_t before = core.instructions();
    const Cycle first = core.cycle();
    const auto start = Clock::now();
    CoreBenchResult result;
    do {
        core.run(core.cycle() + kSlice);
        result.wall_s = seconds_since(start);
    } while (result.wall_s < wall_s);
    result.instructions = core.instructions() - before;
    result.cycles = core.cycle() - first;
    return result;
}

CoreBenchResult bench_image(const std::string& path, double wall_s, bool skip_idle) {
    IdlePins pins;
    Chip chip(dspic30f6014a(), pins);
    chip.load(image::load_image(path));
    chip.set_skipping(skip_idle);
    chip.power_on();
    const auto start = Clock::now();
    CoreBenchResult result;
    cosim::Time until = 0;
    do {
        until += 100 * cosim::kMillisecond;
        chip.run_until(until);
        result.wall_s = seconds_since(start);
    } while (result.wall_s < wall_s);
    const ChipReport report = chip.report();
    result.instructions = report.instructions;
    result.cycles = report.cycles;
    return result;
}

}  // namespace puckloop::dspic
