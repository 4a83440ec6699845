// The tables of the dsPIC30F6014A. Memory map: DS70143 and linker script v1_21.A.

#include "emu/dspic/device.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterInfo kRegisters[] = {
#define REGISTER(name, address, reset, implemented, fields) {#name, address, reset, implemented, fields},
#include "emu/dspic/devices/dspic30f6014a_registers.inc"
#undef REGISTER
};

constexpr InterruptInfo kInterrupts[] = {
#define INTERRUPT(number, name, flag, enable, priority) {number, #name, flag, enable, priority},
#include "emu/dspic/devices/dspic30f6014a_interrupts.inc"
#undef INTERRUPT
};

constexpr DeviceInfo kDevice = {
    .name = "dsPIC30F6014A",
    .registers = kRegisters,
    .interrupts = kInterrupts,
    .program_end = 0x018000,
    .eeprom_begin = 0x7FF000,
    .eeprom_end = 0x800000,
    .config_begin = 0xF80000,
    .config_end = 0xF8000E,
    .ram_begin = 0x0800,
    .ram_end = 0x2800,
    .y_begin = 0x1800,
    .device_id = 0x02C3,
    .revision = 0x1040,
};

}  // namespace

const DeviceInfo& dspic30f6014a() {
    return kDevice;
}

}  // namespace puckloop::dspic
