// The ATmega1284P. Source: data sheet 8272.

#include "emu/avr/devices/device.h"

namespace puckloop::avr {

namespace {

constexpr RegisterInfo kRegisters[] = {
#define REGISTER(name, address, reset, implemented, fields) {#name, address, reset, implemented, fields},
#include "emu/avr/devices/atmega1284p_registers.inc"
#undef REGISTER
};

constexpr VectorInfo kVectors[] = {
#define VECTOR(number, name) {number, #name},
#include "emu/avr/devices/atmega1284p_vectors.inc"
#undef VECTOR
};

constexpr DeviceInfo make() {
    DeviceInfo info;
    info.name = "atmega1284p";
    info.signature = {0x1E, 0x97, 0x05};
    info.gcc_architecture = 51;
    info.flash_words = 0x10000;
    info.page_words = 128;
    info.ram_start = 0x0100;
    info.ram_bytes = 0x4000;
    info.eeprom_bytes = 0x1000;
    info.registers = kRegisters;
    info.vectors = kVectors;
    return info;
}

constexpr DeviceInfo kDevice = make();

}  // namespace

const DeviceInfo& atmega1284p() {
    return kDevice;
}

}  // namespace puckloop::avr
