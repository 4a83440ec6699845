// The tables of the dsPIC30F6014A. Memory map: DS70143 and linker script v1_21.A.

#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_tables.h"

namespace puckloop::dspic {

namespace {

constexpr StatusBits kStatusBits[] = {
#define DRIVEN(registers, bits) {registers, bits, true},
#define MISSING(registers, bits) {registers, bits, false},
#include "emu/dspic/devices/dspic30f6014a_status_bits.inc"
#undef DRIVEN
#undef MISSING
};

constexpr IrqName kInterrupts[] = {
#define INTERRUPT(number, name, flag, enable, priority) {number, #name, flag, enable, priority},
#include "emu/dspic/devices/dspic30f6014a_interrupts.inc"
#undef INTERRUPT
};

constexpr DeviceInfo kDevice = {
    .name = "dspic30f6014a",
    .clocks_per_cycle = 4,
    .flash_end = 0x018000,
    .vectors_start = 0x000004,
    .vectors_end = 0x000100,
    .ivt = 0x000004,
    .aivt = 0x000084,
    .row_words = 32,
    .erase_words = 32,
    .eeprom_start = 0x7FF000,
    .eeprom_words = 2048,
    .config_start = 0xF80000,
    .config_words = 7,
    .unit_id_start = 0x8005C0,
    .unit_id_words = 32,
    .devid = 0x02C3,
    .devrev = 0x1040,
    .ram_start = 0x0800,
    .ram_end = 0x2800,
    .y_start = 0x1800,
    .registers = kRegisters30F6014A,
    .status_bits = kStatusBits,
    .ifs = sfr::IFS0,
    .iec = sfr::IEC0,
    .ipc = sfr::IPC0,
    .inttreg = sfr::INTTREG,
    .ifs_words = 3,
    .irq_count = 54,
    .irqs = kInterrupts,
};

}  // namespace

const DeviceInfo& dspic30f6014a() {
    return kDevice;
}

}  // namespace puckloop::dspic
