// The tables of the dsPIC33FJ256GP710. Memory map: DS70286 and its linker script. DEVID and DEVREV are not
// known to us and read 0.

#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/dspic33fj256gp710_sfr.h"
#include "emu/dspic/devices/register_tables.h"

namespace puckloop::dspic {

namespace {

constexpr StatusBits kStatusBits[] = {
#define DRIVEN(registers, bits) {registers, bits, true},
#define MISSING(registers, bits) {registers, bits, false},
#include "emu/dspic/devices/dspic33fj256gp710_status_bits.inc"
#undef DRIVEN
#undef MISSING
};

constexpr IrqName kInterrupts[] = {
#define INTERRUPT(number, name, flag, enable, priority) {number, #name, flag, enable, priority},
#include "emu/dspic/devices/dspic33fj256gp710_interrupts.inc"
#undef INTERRUPT
};

constexpr DeviceInfo kDevice = {
    .name = "dspic33fj256gp710",
    .family_33f = true,
    .clocks_per_cycle = 2,
    .flash_end = 0x02AC00,
    .vectors_start = 0x000004,
    .vectors_end = 0x000200,
    .ivt = 0x000004,
    .aivt = 0x000104,
    .row_words = 64,
    .erase_words = 512,
    .config_start = 0xF80000,
    .config_words = 12,
    .devid = 0x00FF,  // flash programming tools' tables
    .devrev = 0x3040,
    .ram_start = 0x0800,
    .ram_end = 0x8000,
    .y_start = 0x4800,
    .registers = kRegisters33FJ256GP710,
    .status_bits = kStatusBits,
    .ifs = sfr33::IFS0,
    .iec = sfr33::IEC0,
    .ipc = sfr33::IPC0,
    .inttreg = sfr33::INTTREG,
    .ifs_words = 5,
    .irq_count = 118,
    .irqs = kInterrupts,
};

}  // namespace

const DeviceInfo& dspic33fj256gp710() {
    return kDevice;
}

}  // namespace puckloop::dspic
